"""Opening .tess files and decoding parts of them."""
from __future__ import annotations

import contextlib
import ctypes as c
import os
import threading
from typing import Any, BinaryIO, Dict, Iterator, Optional, Sequence, Tuple, Union

import numpy as np

from . import _description, _library as lib
from ._array import TexelArray
from ._description import Description
from ._sources import CallbackSource, FileObject, WebFile

Source = Union[str, "os.PathLike[str]", bytes, bytearray, memoryview, BinaryIO]


class _Handle:
    """A tessera_decoder. It is closed once nobody uses it, whatever thread asks for that."""

    def __init__(self, source: Source, options: lib.OpenOptions, timeout: float) -> None:
        self._lock, self._users, self._is_closed = threading.Lock(), 0, False
        self._decoder: Any = c.c_void_p()
        self._callbacks: Optional[CallbackSource] = None
        self._keep: Any = None  # what the decoder refers to
        out, given = c.byref(self._decoder), c.byref(options)
        if isinstance(source, (bytes, bytearray, memoryview)):
            self.name = "<bytes>"
            self._keep = np.frombuffer(source, np.uint8)
            self.check(lib.open_memory(self._keep.ctypes.data, self._keep.nbytes, given, out))
        elif isinstance(source, (str, os.PathLike)) and not _is_url(source):
            self.name = os.fspath(source)
            os.stat(source)  # raises FileNotFoundError and the like, with the name
            self.check(lib.open_path(os.fsencode(source), given, out))
        else:
            file = WebFile(source, timeout) if isinstance(source, str) else FileObject(source)
            self.name = file.name
            self._callbacks = CallbackSource(file)
            self.check(lib.open_source(c.byref(self._callbacks.c_source), given, out))

    def raise_for(self, error: int) -> None:
        """Raises the exception of the file object or the connection that led to this error."""
        if self._callbacks is not None:
            self._callbacks.raise_for(error)

    def check(self, error: int) -> None:
        self.raise_for(error)
        lib.check(error)

    @contextlib.contextmanager
    def use(self) -> Iterator[Any]:
        with self._lock:
            if self._is_closed:
                raise ValueError(f"{self.name}: the texture is closed")
            self._users += 1
        try:
            yield self._decoder
        finally:
            with self._lock:
                self._users -= 1
            self._close_if_unused()

    def close(self) -> None:
        with self._lock:
            self._is_closed = True
        self._close_if_unused()

    def _close_if_unused(self) -> None:
        with self._lock:
            if not self._is_closed or self._users > 0:
                return
            decoder, self._decoder = self._decoder, c.c_void_p()
        lib.close(decoder)
        self._keep = self._callbacks = None

    @property
    def is_closed(self) -> bool:
        return self._is_closed

    def __del__(self) -> None:
        if hasattr(self, "_decoder"):
            self.close()


def _is_url(source: Any) -> bool:
    if not isinstance(source, str) or "://" not in source:
        return False
    scheme = source.partition("://")[0].lower()
    if scheme in ("http", "https"):
        return True
    raise ValueError(f"{source}: URLs begin with http:// or https://; open others with fsspec and "
                     "pass the file object")


class Level(TexelArray):
    """A level of a texture: level 0 is the texture itself, the others are coarser copies of it.

    spatial_lod, angular_lod: a texel covers 2**spatial_lod texels of level 0 along u and v, and
    2**angular_lod along s and t.
    """

    def __init__(self, handle: _Handle, number: int, texture: lib.Texture) -> None:
        found = lib.Level()
        with handle.use() as decoder:
            lib.check(lib.get_level(decoder, number, c.byref(found)))
        # Level 0 of a file with aligned views has the size of a larger grid, which no box can name.
        size = texture.size if number == 0 else found.size
        dtype = np.dtype(np.uint8) if texture.type == 0 else np.dtype("<f2")
        super().__init__(size, texture.channels, dtype, found.largest_tile)
        self.number: int = number
        self.spatial_lod: int = found.spatial_lod
        self.angular_lod: int = found.angular_lod
        self._handle = handle

    def __repr__(self) -> str:
        return f"<tessera.Level {self.number} {self.shape} {self.dtype}>"

    def _decode(self, begin: Sequence[int], end: Sequence[int], raw: np.ndarray,
                threads: int) -> None:
        callbacks = lib.Callbacks()
        options = lib.DecodeOptions(level=self.number, threads=threads,
                                    progress=callbacks.progress(None))
        with self._handle.use() as decoder, callbacks.interruptible():
            error = lib.decode_box(decoder, lib.Extent(*begin), lib.Extent(*end), raw.ctypes.data,
                                   raw.nbytes, c.byref(options))
        self._handle.raise_for(error)
        callbacks.check(error)


class Texture(Level):
    """An open .tess file: an array of texels with metadata. `tessera.open` makes it.

    Several threads may use it at once. It can be closed with `close` or by `with`; decoding that is
    under way then still finishes. A texture that was opened by its path or URL can be pickled.
    """

    def __init__(self, source: Source, *, allow_partial: bool = False, allow_damaged: bool = False,
                 timeout: float = 30) -> None:
        options = lib.OpenOptions(allow_partial=allow_partial, allow_damaged=allow_damaged)
        handle = _Handle(source, options, timeout)
        self._arguments = (source, allow_partial, allow_damaged, timeout)
        texture = lib.Texture()
        with handle.use() as decoder:
            lib.check(lib.get_texture(decoder, c.byref(texture)))
            count = lib.level_count(decoder)
        super().__init__(handle, 0, texture)
        self.levels: Tuple[Level, ...] = tuple(Level(handle, i, texture) for i in range(count))
        """All levels of the file, each an array that can be sliced; the first is the texture."""

    def __repr__(self) -> str:
        state = "closed " if self._handle.is_closed else ""
        return f"<tessera.Texture {state}{self._handle.name!r} {self.shape} {self.dtype}>"

    @property
    def metadata(self) -> Dict[str, str]:
        """The metadata of the file, such as "Title", in a new dictionary."""
        key, value, count, found = c.c_char_p(), c.c_void_p(), c.c_size_t(), {}
        with self._handle.use() as decoder:
            for i in range(lib.metadata_count(decoder)):
                lib.check(lib.metadata_at(decoder, i, c.byref(key), c.byref(value),
                                          c.byref(count)))
                text = c.string_at(value, count.value)
                found[key.value.decode("utf-8", "replace")] = text.decode("utf-8", "replace")
        return found

    @property
    def description(self) -> Description:
        """What the coordinates and samples mean."""
        found = lib.Description()
        with self._handle.use() as decoder:
            lib.check(lib.get_description(decoder, c.byref(found)))
        return _description.from_c(found)

    @property
    def mesh(self) -> bytes:
        """The Draco mesh of a texture with the proxy "mesh", otherwise empty."""
        mesh, count = c.c_void_p(), c.c_size_t()
        with self._handle.use() as decoder:
            lib.check(lib.get_mesh(decoder, c.byref(mesh), c.byref(count)))
            return c.string_at(mesh, count.value) if mesh else b""

    def views(self, s: Any = slice(None), t: Any = slice(None)) -> np.ndarray:
        """Decodes views as pictures: an array of shape (t, s, v, u[, channels]).

        `s` and `t` are indices or slices; an index removes its axis, so that `views(4, 3)` is one
        picture of shape (v, u[, channels]), whose rows are along v. By default all views are
        decoded.
        """
        picture = self[:, :, s, t]
        tail = (picture.ndim - 1,) if self.channels > 1 else ()
        grid = picture.ndim - 2 - len(tail)  # the number of axes of s and t that are left
        return picture.transpose(*reversed(range(2, 2 + grid)), 1, 0, *tail)

    def close(self) -> None:
        """Closes the file; what has been decoded stays. Later use raises ValueError."""
        self._handle.close()

    def __enter__(self) -> "Texture":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __reduce__(self) -> Any:
        source, *rest = self._arguments
        if not isinstance(source, (str, os.PathLike)):
            raise TypeError("a texture can be pickled only if it was opened by its path or URL")
        return _reopen, (source, *rest)


def _reopen(source: Source, allow_partial: bool, allow_damaged: bool, timeout: float) -> Texture:
    return Texture(source, allow_partial=allow_partial, allow_damaged=allow_damaged,
                   timeout=timeout)


def open(source: Source, *, allow_partial: bool = False, allow_damaged: bool = False,
         timeout: float = 30) -> Texture:
    """Opens a .tess file and reads its head.

    source         a path; an http:// or https:// URL, of which only the parts are read that slices
                   need; bytes, which must not change; or a binary file object that can seek
    allow_partial  accept a truncated file: missing tiles are shown from coarser levels or as
                   background
    allow_damaged  show damaged tiles in the same way
    timeout        seconds to wait for a web server

    Errors: OSError (the file cannot be read; FileNotFoundError and the like for paths), ValueError
    (not a valid .tess file, or of another version of the format), and what a file object raises.
    """
    return Texture(source, allow_partial=allow_partial, allow_damaged=allow_damaged,
                   timeout=timeout)
