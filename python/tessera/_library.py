"""The C interface of Tessera (codec/tessera.h) for ctypes: structures, functions, errors.

ctypes.CDLL releases the interpreter lock during each call and takes it for each callback.
"""
from __future__ import annotations

import contextlib
import ctypes as c
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Any, Callable, Iterator, Optional

API_VERSION = 2
BAD_ARGUMENT, IO, INVALID_FILE, RUNTIME, UNSUPPORTED, CANCELLED = range(1, 7)
CALLBACK_FAILED = 1000  # what our callbacks return after an exception

Extent = c.c_uint32 * 4
Bounds = c.POINTER(c.c_uint32)
ProgressFunction = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_char_p, c.c_double, c.c_double)
CancelledFunction = c.CFUNCTYPE(c.c_int, c.c_void_p)
ReadTexelsFunction = c.CFUNCTYPE(c.c_int, c.c_void_p, Bounds, Bounds, c.c_void_p, c.c_size_t)
WriteFunction = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_void_p, c.c_size_t)
ReadFunction = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_uint64, c.c_void_p, c.c_size_t)
CloseFunction = c.CFUNCTYPE(None, c.c_void_p)


class Texture(c.Structure):
    _fields_ = [("size", Extent), ("type", c.c_int32), ("channels", c.c_uint32)]


class Sized(c.Structure):
    """A structure that begins with struct_size; the library fills it with its defaults."""

    c_name = ""  # its name in tessera.h

    def __init__(self, **members: Any) -> None:
        super().__init__()
        init = getattr(library, f"{self.c_name}_init_sized")
        init.argtypes, init.restype = (c.c_void_p, c.c_size_t), None
        init(c.byref(self), c.sizeof(self))
        for member, value in members.items():
            setattr(self, member, value)


class Description(Sized):
    c_name = "tessera_description"
    _fields_ = [("struct_size", c.c_size_t), ("proxy", c.c_int32), ("surface_map", c.c_int32),
                ("angular_map", c.c_int32), ("transfer", c.c_int32), ("primaries", c.c_int32),
                ("alpha", c.c_int32), ("sphere_centre", c.c_float * 3),
                ("sphere_radius", c.c_float), ("viewing_radius", c.c_float * 2)]


class KeyValue(c.Structure):
    _fields_ = [("key", c.c_char_p), ("value", c.c_char_p)]


class TexelSource(Sized):
    c_name = "tessera_texel_source"
    _fields_ = [("struct_size", c.c_size_t), ("texture", Texture), ("texels", c.c_void_p),
                ("texel_bytes", c.c_size_t), ("read", ReadTexelsFunction), ("user", c.c_void_p),
                ("one_at_a_time", c.c_int32), ("slow", c.c_int32), ("strides", c.c_int64 * 5)]


class EncodeOptions(Sized):
    c_name = "tessera_encode_options"
    _fields_ = [("struct_size", c.c_size_t), ("rate_value", c.c_double), ("rate_kind", c.c_int32),
                ("effort", c.c_int32), ("threads", c.c_uint32), ("tile", Extent),
                ("verify", c.c_int32), ("strict", c.c_int32), ("layers", c.c_int32),
                ("memory_bytes", c.c_uint64), ("mask", c.POINTER(TexelSource)),
                ("description", c.POINTER(Description)), ("metadata", c.POINTER(KeyValue)),
                ("metadata_count", c.c_size_t), ("progress", ProgressFunction),
                ("cancelled", CancelledFunction), ("user", c.c_void_p), ("journal", c.c_int32),
                ("lossless_fallback", c.c_int32), ("source_facts", c.POINTER(KeyValue)),
                ("source_fact_count", c.c_size_t), ("mesh", c.c_void_p),
                ("mesh_bytes", c.c_size_t), ("reuse", c.c_void_p)]


class EncodeReport(Sized):
    c_name = "tessera_encode_report"
    _fields_ = [("struct_size", c.c_size_t), ("file_bytes", c.c_uint64),
                ("raw_bytes", c.c_uint64), ("bits_per_texel", c.c_double), ("psnr", c.c_double),
                ("max_error", c.c_double), ("seconds", c.c_double),
                ("texels_that_matter", c.c_uint64), ("nan_count", c.c_uint64),
                ("infinity_count", c.c_uint64), ("passes", c.c_uint32),
                ("target_met", c.c_int32), ("note", c.c_char * 256), ("kept_tiles", c.c_uint64)]


class OpenOptions(Sized):
    c_name = "tessera_open_options"
    _fields_ = [("struct_size", c.c_size_t), ("allow_partial", c.c_int32),
                ("allow_damaged", c.c_int32)]


class ByteRange(c.Structure):
    _fields_ = [("offset", c.c_uint64), ("out", c.c_void_p), ("bytes", c.c_size_t)]


ReadManyFunction = c.CFUNCTYPE(c.c_int, c.c_void_p, c.POINTER(ByteRange), c.c_size_t)


class ByteSource(Sized):
    c_name = "tessera_byte_source"
    _fields_ = [("struct_size", c.c_size_t), ("size", c.c_uint64), ("user", c.c_void_p),
                ("read", ReadFunction), ("read_many", ReadManyFunction),
                ("close", CloseFunction), ("name", c.c_char_p),
                ("one_at_a_time", c.c_int32), ("slow", c.c_int32)]


class Level(Sized):
    c_name = "tessera_level"
    _fields_ = [("struct_size", c.c_size_t), ("size", Extent), ("spatial_lod", c.c_uint32),
                ("angular_lod", c.c_uint32), ("largest_tile", Extent), ("tile_count", Extent)]


class DecodeOptions(Sized):
    c_name = "tessera_decode_options"
    _fields_ = [("struct_size", c.c_size_t), ("level", c.c_uint32), ("threads", c.c_uint32),
                ("integrity", c.c_int32), ("reserved", c.c_int32), ("progress", ProgressFunction),
                ("cancelled", CancelledFunction), ("user", c.c_void_p)]


def _load() -> c.CDLL:
    names = {"win32": "tessera.dll", "darwin": "libtessera.dylib"}
    path = os.environ.get("TESSERA_LIBRARY") or str(
        Path(__file__).with_name(names.get(sys.platform, "libtessera.so")))
    try:
        loaded = c.CDLL(path)
        version = loaded.tessera_api_version()
    except (OSError, AttributeError) as error:
        raise ImportError(f"Tessera's library cannot be loaded: {error}; the variable "
                          "TESSERA_LIBRARY can name another one") from None
    if version != API_VERSION:
        raise ImportError(f"{path} has version {version} of the C interface; this package needs "
                          f"version {API_VERSION}")
    return loaded


library = _load()


def _function(name: str, result: Any, *types: Any) -> Any:
    function = getattr(library, "tessera_" + name)
    function.argtypes, function.restype = types, result
    return function


_P, _POptions = c.c_void_p, c.c_void_p  # any structure, by reference
version = _function("version", c.c_char_p)
format_version = _function("format_version", None, Bounds, Bounds)
last_error = _function("last_error", c.c_char_p)
free = _function("free", None, _P)
open_path = _function("open_path", c.c_int, c.c_char_p, _POptions, c.POINTER(_P))
open_memory = _function("open_memory", c.c_int, _P, c.c_size_t, _POptions, c.POINTER(_P))
open_source = _function("open_source", c.c_int, _P, _POptions, c.POINTER(_P))
close = _function("close", None, _P)
get_texture = _function("get_texture", c.c_int, _P, _P)
get_description = _function("get_description", c.c_int, _P, _P)
get_mesh = _function("get_mesh", c.c_int, _P, c.POINTER(_P), c.POINTER(c.c_size_t))
level_count = _function("level_count", c.c_uint32, _P)
get_level = _function("get_level", c.c_int, _P, c.c_uint32, _P)
metadata_count = _function("metadata_count", c.c_size_t, _P)
metadata_at = _function("metadata_at", c.c_int, _P, c.c_size_t, c.POINTER(c.c_char_p),
                        c.POINTER(_P), c.POINTER(c.c_size_t))
decode_box = _function("decode_box", c.c_int, _P, Extent, Extent, _P, c.c_size_t, _POptions)
encode_to_path = _function("encode_to_path", c.c_int, _P, c.c_char_p, _POptions, _P)
encode_to_memory = _function("encode_to_memory", c.c_int, _P, c.POINTER(_P),
                             c.POINTER(c.c_size_t), _POptions, _P)
encode_to_function = _function("encode_to_function", c.c_int, _P, WriteFunction, _P, _POptions, _P)


def check(error: int) -> None:
    """Raises the exception for an error of the library that the last call returned."""
    if error == 0:
        return
    text = last_error().decode("utf-8", "replace")
    if error in (IO, CALLBACK_FAILED):
        raise OSError(text)
    if error == RUNTIME:
        raise MemoryError(text) if "out of memory" in text else RuntimeError(text)
    if error == CANCELLED:
        raise KeyboardInterrupt(text)
    raise ValueError(text)


def c_string(text: str, what: str) -> bytes:
    """Encodes a string for C, which would cut it off at a NUL."""
    if not isinstance(text, str):
        raise TypeError(f"{what} is a str, not {type(text).__name__}")
    if "\0" in text:
        raise ValueError(f"{what} contains a NUL: {text!r}")
    return text.encode()


class Callbacks:
    """Keeps what callbacks raise during one call of the library, and lets Ctrl-C stop the call.

    Exceptions cannot pass through C. A guarded callback keeps its exception, returns a code that
    makes the library stop, and `check` raises the exception once the library has returned.
    """

    def __init__(self) -> None:
        self._raised: Optional[BaseException] = None
        self._interrupted = False

    def guard(self, function: Callable[..., None]) -> Callable[..., int]:
        def guarded(*arguments: Any) -> int:
            try:
                function(*arguments)
            except BaseException as error:  # of any kind: it continues in check()
                if self._raised is None:
                    self._raised = error
            return CALLBACK_FAILED if self._raised is not None or self._interrupted else 0

        return guarded

    def progress(self, function: Optional[Callable[[str, float, float], object]]) -> Any:
        def step(user: Any, stage: bytes, done: float, total: float) -> None:
            if function is not None:
                function(stage.decode(), done, total)

        return ProgressFunction(self.guard(step))

    @contextlib.contextmanager
    def interruptible(self) -> Iterator[None]:
        """Makes Ctrl-C a request to stop. Otherwise Python would raise KeyboardInterrupt at the
        very beginning of a callback, where nothing can catch it."""
        if threading.current_thread() is not threading.main_thread() or \
                signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            yield
            return

        def remember(*_: Any) -> None:
            self._interrupted = True

        signal.signal(signal.SIGINT, remember)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def check(self, error: int) -> None:
        if self._raised is not None:
            raised, self._raised = self._raised, None
            raise raised
        if self._interrupted:
            raise KeyboardInterrupt
        check(error)
