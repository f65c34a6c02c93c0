"""The codec "tessera" for numcodecs, and so for zarr 2: each chunk becomes a .tess file.

numcodecs finds it by its entry point, so that reading needs no import:

    import zarr
    from tessera.numcodecs import Tessera

    z = zarr.open("field.zarr", "w", shape=(512, 512, 16, 16, 3), chunks=(128, 128, 16, 16, 3),
                  dtype="u1", compressor=Tessera(psnr=40), order="C")
"""
from __future__ import annotations

from typing import Any, Optional, Sequence, Tuple

import numpy as np
from numcodecs.abc import Codec
from numcodecs.compat import ensure_contiguous_ndarray, ensure_ndarray, ndarray_copy

from ._encode import encode_bytes
from ._texture import open as open_texture

LIBRARY_AXES = "uvstc"


class Tessera(Codec):
    """Compresses chunks of uint8 or float16 with four or five axes in C order.

    psnr, quality, bits_per_texel, max_error
              the rate of each chunk, as `tessera.encode` takes it; without any: lossless
    effort    0 fastest to 4 smallest
    threads   per chunk; 0: all cores. The default is 1, because Dask works on many chunks at once.
    axes      the meaning of the array's axes: a permutation of "uvst" or "uvstc". "tsvuc" is an
              array of pictures, [row of cameras, column, y, x, channel]; None: "uvst" or "uvstc"
    shape, dtype
              of a chunk, if it is given to the codec as flat bytes; None: those of the array

    Errors: ValueError (a chunk that cannot be a texture, a buffer of another length, an array in
    Fortran order, bytes that are not a .tess file), MemoryError.
    """

    codec_id = "tessera"

    def __init__(self, psnr: Optional[float] = None, quality: Optional[float] = None,
                 bits_per_texel: Optional[float] = None, max_error: Optional[float] = None,
                 effort: int = 2, threads: int = 1, axes: Optional[str] = None,
                 shape: Optional[Sequence[int]] = None, dtype: Optional[str] = None) -> None:
        if axes is not None and (sorted(axes) not in (sorted("uvst"), sorted("uvstc"))):
            raise ValueError(f'axes is {axes!r}, not a permutation of "uvst" or "uvstc"')
        self.psnr, self.quality, self.bits_per_texel = psnr, quality, bits_per_texel
        self.max_error, self.effort, self.threads, self.axes = max_error, effort, threads, axes
        self.shape = None if shape is None else [int(side) for side in shape]
        self.dtype = None if dtype is None else np.dtype(dtype).str

    def _axes_of(self, ndim: int) -> Tuple[int, ...]:
        """The axis of the chunk for each of u, v, s, t and the channels."""
        axes = self.axes or LIBRARY_AXES[:ndim]
        if ndim not in (4, 5) or len(axes) != ndim:
            raise ValueError(f"a chunk with {ndim} axes is not a texture of the axes "
                             f"{self.axes or 'uvst or uvstc'}")
        return tuple(axes.index(axis) for axis in LIBRARY_AXES[:ndim])

    def _chunk(self, buf: Any) -> np.ndarray:
        chunk = ensure_ndarray(buf)
        if self.shape is None:
            if not chunk.flags.c_contiguous:
                raise ValueError('chunks must be in C order; create the array with order="C"')
            return chunk
        flat = ensure_contiguous_ndarray(buf)
        dtype = np.dtype(self.dtype if self.dtype is not None else chunk.dtype)
        wanted = dtype.itemsize * int(np.prod(self.shape, dtype=object))
        if flat.nbytes != wanted:
            raise ValueError(f"the buffer has {flat.nbytes} bytes; a chunk of {self.shape} and "
                             f"{dtype} has {wanted}")
        return flat.view(dtype).reshape(self.shape)

    def encode(self, buf: Any) -> bytes:
        chunk = self._chunk(buf)
        rates = {"psnr": self.psnr, "quality": self.quality, "max_error": self.max_error,
                 "bits_per_texel": self.bits_per_texel}
        return encode_bytes(chunk.transpose(self._axes_of(chunk.ndim)), effort=self.effort,
                            threads=self.threads, lossless=all(v is None for v in rates.values()),
                            **rates)

    def decode(self, buf: Any, out: Any = None) -> np.ndarray:
        with open_texture(memoryview(ensure_contiguous_ndarray(buf))) as texture:
            texels = texture.box((0, 0, 0, 0), texture.size, threads=self.threads)
        if texels.ndim == 4 and self._has_channel_axis():
            texels = texels[..., None]
        chunk = np.ascontiguousarray(texels.transpose(np.argsort(self._axes_of(texels.ndim))))
        room = chunk.nbytes if out is None else ensure_contiguous_ndarray(out).nbytes
        if room != chunk.nbytes:
            raise ValueError(f"the buffer for the chunk has {room} bytes; the chunk has "
                             f"{chunk.nbytes}")
        return ndarray_copy(chunk, out)

    def _has_channel_axis(self) -> bool:
        return len(self.axes or self.shape or ()) == 5
