"""Encoding arrays."""
from __future__ import annotations

import ctypes as c
import dataclasses
import os
from typing import Any, BinaryIO, Callable, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _description, _library as lib
from ._description import Description

Progress = Callable[[str, float, float], object]
RATES = ("quality", "psnr", "bits_per_texel", "bytes", "max_error")  # as tessera_rate


@dataclasses.dataclass(frozen=True)
class EncodeReport:
    """The result of encoding."""

    file_bytes: int
    raw_bytes: int  #: uncompressed size of the texels
    bits_per_texel: float  #: 8 * file_bytes / texels
    psnr: float  #: dB over all samples that matter (float16: of 16-bit codes); 999: lossless
    max_error: float  #: largest error of a sample that matters: 8-bit steps, or float16 ulps
    seconds: float  #: elapsed time
    texels_that_matter: int
    nan_count: int  #: replaced by 0
    infinity_count: int  #: replaced by +-65504
    passes: int  #: number of passes over the whole texture
    target_met: bool  #: False: the requested rate cannot be reached, see note
    note: str  #: why not, or why the file is lossless


def encode(array: Any, path: Union[str, "os.PathLike[str]", BinaryIO], *,
           quality: Optional[float] = None, psnr: Optional[float] = None,
           bits_per_texel: Optional[float] = None, bytes: Optional[int] = None,
           max_error: Optional[float] = None, lossless: bool = False, effort: int = 3,
           threads: int = 0, tile: Optional[Sequence[int]] = None, mask: Any = None,
           layers: bool = False, description: Optional[Description] = None, mesh: Any = b"",
           metadata: Optional[Mapping[str, str]] = None,
           progress: Optional[Progress] = None) -> EncodeReport:
    """Encodes a texture to a .tess file.

    array          texels of shape (u, v, s, t) for one channel, or (u, v, s, t, channels) for
                   1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha; uint8 or float16, of any strides
                   and byte order. The library reads an array where it is, tile by tile, fastest in
                   its own order, v, u, t, s, channels. Other objects with shape, ndim, dtype
                   and slices, such as zarr and HDF5 arrays and tessera.Texture, are read tile by
                   tile and several times; anything else goes through numpy.asarray.
    path           the file, which is created or replaced once it is complete, or a binary file
                   object with `write`, which receives the file after everything has been encoded

    At most one of (the default is quality=75):
    quality        1 to 100
    psnr           dB over all samples, up to 120; not below it
    bits_per_texel all channels together; not above it
    bytes          of the file; not above it
    max_error      largest error of a sample, in 8-bit steps or float16 ulps; 0: lossless
    lossless       True: no error

    effort         0 fastest to 4 smallest
    threads        0: all cores. The bytes of the file do not depend on it.
    tile           largest tile in texels along u, v, s, t; None: the encoder chooses
    mask           texels that matter: bool or uint8, four axes, each as long as the texture's or 1.
                   Where it is 0, any value will do.
    layers         True: coarse levels first, so that any beginning of the file shows it all
    description    what coordinates and samples mean
    mesh           a Draco mesh, for the proxy "mesh" only
    metadata       entries to store
    progress       called as progress(stage, done, total) in this thread; what it raises stops the
                   encoder and continues from here

    Errors: ValueError (an argument outside its range), OSError, MemoryError, and what the array or
    `progress` raise. After an error no file has been written or replaced.
    """
    rates = {"quality": quality, "psnr": psnr, "bits_per_texel": bits_per_texel, "bytes": bytes,
             "max_error": max_error}
    call = _Encoding(array, mask, effort=effort, threads=threads, layers=layers)
    call.set_rate(rates, lossless)
    call.set_rest(tile, description, mesh, metadata, progress)
    if hasattr(path, "write"):
        return call.to_function(path.write)
    name = os.fsencode(path)
    if b"\0" in name:
        raise ValueError("the path contains a NUL")
    return call.run(lib.encode_to_path, name)


def encode_bytes(array: Any, **options: Any) -> bytes:
    """Encodes a texture and returns the bytes of the .tess file. Options are those of `encode`."""
    pieces = bytearray()

    class Memory:
        @staticmethod
        def write(piece: Any) -> None:
            pieces.extend(piece)

    encode(array, Memory, **options)
    return bytes(pieces)


class _Encoding:
    """The arguments of one call of the library, which must stay alive until it returns."""

    def __init__(self, array: Any, mask: Any, **members: int) -> None:
        self._callbacks = lib.Callbacks()
        source = _array_like(array)
        if source.ndim not in (4, 5):
            raise ValueError("the array has the axes u, v, s, t and perhaps channels; this one has "
                             f"the shape {tuple(source.shape)}")
        self._texels = self._source(source)
        self._options = lib.EncodeOptions()
        for name, value in members.items():
            setattr(self._options, name, _c_int(value, name))
        if mask is not None:
            given = _array_like(mask)
            if given.dtype == np.bool_:
                given = np.asarray(given).view(np.uint8)
            if given.dtype != np.uint8 or given.ndim != 4:
                raise ValueError("the mask has four axes, u, v, s, t, and the type bool or uint8; "
                                 f"this one has the shape {given.shape} and the type {given.dtype}")
            self._mask = self._source(given)
            self._options.mask = c.pointer(self._mask)

    def _source(self, array: Any) -> lib.TexelSource:
        dtype = np.dtype(array.dtype)
        if dtype not in (np.uint8, np.float16, np.dtype(">f2")):
            raise ValueError(f"texels are uint8 or float16, not {dtype}")
        u, v, s, t, *channels = array.shape
        for side in array.shape:
            if not 0 < side <= 1 << 20:
                raise ValueError(f"an axis of the array has {side} elements, outside 1 to 2**20")
        source = lib.TexelSource(texture=lib.Texture(
            lib.Extent(u, v, s, t), int(dtype != np.uint8), channels[0] if channels else 1))
        if isinstance(array, np.ndarray) and dtype.isnative:
            source.texels, source.texel_bytes, source.kept = array.ctypes.data, array.nbytes, array
            if _library_order(array).flags.c_contiguous:
                return source
            source.strides = (c.c_int64 * 5)(*(array.strides + (dtype.itemsize,))[:5])
            if any(source.strides):  # else all texels are one, and the library would see no strides
                return source
            source.texels = None
        source.read = lib.ReadTexelsFunction(self._callbacks.guard(_reader(array, dtype)))
        source.one_at_a_time = not isinstance(array, np.ndarray)
        return source

    def set_rate(self, rates: Mapping[str, Optional[float]], lossless: bool) -> None:
        given = [name for name, value in rates.items() if value is not None]
        names = given + ["lossless"] * bool(lossless)
        if len(names) > 1:
            raise ValueError(f"{' and '.join(names)} exclude each other")
        if lossless:
            given, rates = ["max_error"], {"max_error": 0}
        for name in given:
            self._options.rate_kind = RATES.index(name)
            self._options.rate_value = float(rates[name])

    def set_rest(self, tile: Optional[Sequence[int]], description: Optional[Description], mesh: Any,
                 metadata: Optional[Mapping[str, str]], progress: Optional[Progress]) -> None:
        options = self._options
        if tile is not None:
            if len(tile) != 4:
                raise ValueError(f"tile has four numbers, u, v, s, t, not {len(tile)}")
            options.tile = lib.Extent(*(_c_int(side, "tile") for side in tile))
        if description is not None:
            options.description = c.pointer(_description.to_c(description))
        if len(mesh) > 0:
            self._mesh = np.frombuffer(mesh, np.uint8)
            options.mesh, options.mesh_bytes = self._mesh.ctypes.data, self._mesh.nbytes
        entries = [lib.KeyValue(lib.c_string(key, "a key of the metadata"),
                                lib.c_string(value, f"the metadata {key!r}"))
                   for key, value in (metadata or {}).items()]
        self._entries = (lib.KeyValue * len(entries))(*entries)
        options.metadata, options.metadata_count = self._entries, len(entries)
        options.progress = self._callbacks.progress(progress)

    def to_function(self, write: Callable[[Any], object]) -> EncodeReport:
        def write_all(user: Any, data: int, count: int) -> None:
            piece = memoryview(c.string_at(data, count))
            while len(piece) > 0:
                written = write(piece)
                piece = piece[written if isinstance(written, int) else len(piece):]

        return self.run(lib.encode_to_function,
                        lib.WriteFunction(self._callbacks.guard(write_all)), None)

    def run(self, function: Any, *arguments: Any) -> EncodeReport:
        report = lib.EncodeReport()
        with self._callbacks.interruptible():
            error = function(c.byref(self._texels), *arguments, c.byref(self._options),
                             c.byref(report))
        self._callbacks.check(error)
        values = {field.name: getattr(report, field.name)
                  for field in dataclasses.fields(EncodeReport)}
        return EncodeReport(**{**values, "target_met": bool(report.target_met),
                               "note": report.note.decode("utf-8", "replace")})


def _c_int(value: Any, what: str) -> int:
    """An integer that C's int can hold; ctypes would cut off others."""
    number = int(value)
    if number != value or not 0 <= number < 1 << 31:
        raise ValueError(f"{what} is {value!r}, not an integer from 0 on")
    return number


def _array_like(array: Any) -> Any:
    """The array itself if it can be read by slices, otherwise a numpy array."""
    try:
        np.dtype(array.dtype), len(array.shape), array.ndim, array.__getitem__
        return array
    except (AttributeError, TypeError):
        return np.asarray(array)


def _library_order(texels: np.ndarray) -> np.ndarray:
    texels = texels if texels.ndim == 5 else texels[..., None]
    return texels.transpose(1, 0, 3, 2, 4)


def _reader(array: Any, dtype: np.dtype) -> Callable[..., None]:
    def read(user: Any, begin: Any, end: Any, out: int, count: int) -> None:
        box = tuple(slice(begin[i], end[i]) for i in range(4))
        texels = np.asarray(array[box])
        shape = tuple(k.stop - k.start for k in box) + tuple(array.shape[4:])
        if texels.shape != shape:
            raise ValueError(f"the array gave the shape {texels.shape} for a box of {shape}")
        raw = _library_order(texels)
        to = np.frombuffer((c.c_uint8 * count).from_address(out), dtype.newbyteorder("="))
        to = to.reshape(raw.shape)
        for channel in range(raw.shape[4]):  # one by one, which is three times as fast
            np.copyto(to[..., channel], raw[..., channel], casting="equiv")

    return read
