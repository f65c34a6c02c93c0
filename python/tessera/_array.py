"""Arrays whose texels are decoded when they are sliced."""
from __future__ import annotations

import operator
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

AXES = "uvst"
# A slice with steps whose box has more bytes than this, and than twice those asked for, is decoded
# in parts.
BOX_BYTES = 1 << 26


class TexelArray:
    """An array of shape (u, v, s, t) for one channel, or (u, v, s, t, channels) for more.

    Slices give numpy arrays and follow numpy's rules: integers, steps, negative numbers and `...`
    work, an integer outside its axis is an IndexError, and the ends of a slice are cut to the axis.
    Only the tiles that a slice touches are read and decoded. `box` cuts nothing: it refuses a box
    that does not lie inside.
    """

    def __init__(self, size: Sequence[int], channels: int, dtype: np.dtype,
                 tile: Sequence[int]) -> None:
        self.size: Tuple[int, ...] = tuple(size)  #: texels along u, v, s, t
        self.channels: int = channels  #: 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha
        self.dtype: np.dtype = dtype  #: uint8 or float16
        tail = (channels,) if channels > 1 else ()
        self.shape: Tuple[int, ...] = self.size + tail
        #: the largest tile, which zarr and Dask call a chunk
        self.chunks: Tuple[int, ...] = tuple(map(min, tile, self.size)) + tail
        self.ndim: int = len(self.shape)

    @property
    def nbytes(self) -> int:
        """Bytes of all texels once they are decoded."""
        count = self.dtype.itemsize * self.channels
        for side in self.size:
            count *= side
        return count

    def __len__(self) -> int:
        return self.shape[0]

    def _decode(self, begin: Sequence[int], end: Sequence[int], raw: np.ndarray,
                threads: int) -> None:
        """Fills raw, of shape (v, u, t, s, channels), with the texels of a box."""
        raise NotImplementedError

    def box(self, begin: Sequence[int], end: Sequence[int], *, threads: int = 0) -> np.ndarray:
        """Decodes the texels begin[i] <= coordinate < end[i] for i = u, v, s, t.

        Returns an array of shape (end - begin) and the channels, if there are several. `threads`: 0
        for all cores. Errors: ValueError (the box is empty or not inside), OSError.
        """
        begin, end = [operator.index(i) for i in begin], [operator.index(i) for i in end]
        if len(begin) != 4 or len(end) != 4:
            raise ValueError("a box begins and ends with four numbers each: u, v, s, t")
        for axis, low, high, side in zip(AXES, begin, end, self.size):
            if not 0 <= low < high <= side:
                raise ValueError(f"the box from {low} to {high} along {axis} is empty or not "
                                 f"inside 0 to {side}")
        return self._without_channel(self._texels(begin, end, threads))

    def _without_channel(self, texels: np.ndarray) -> np.ndarray:
        return texels if self.channels > 1 else texels[..., 0]

    def _texels(self, begin: Sequence[int], end: Sequence[int], threads: int) -> np.ndarray:
        """A box with all five axes, as a view of memory in the library's order v, u, t, s."""
        u, v, s, t = (high - low for low, high in zip(begin, end))
        raw = np.empty((v, u, t, s, self.channels), self.dtype)
        self._decode(begin, end, raw, threads)
        return raw.transpose(1, 0, 3, 2, 4)

    def __getitem__(self, key: Any) -> np.ndarray:
        ranges, numpy_key = self._parse(key)
        if any(len(r) == 0 for r in ranges):
            texels = np.empty([len(r) for r in ranges] + [self.channels], self.dtype)
        else:
            texels = self._strided(ranges)
        return self._without_channel(texels)[numpy_key]

    def _parse(self, key: Any) -> Tuple[List[range], Tuple[Any, ...]]:
        """The coordinates along u, v, s, t, and the key for the array of those texels."""
        keys = list(key) if isinstance(key, tuple) else [key]
        dots = [i for i, k in enumerate(keys) if k is Ellipsis]
        if len(dots) > 1:
            raise IndexError("an index can only have one '...'")
        if len(keys) - len(dots) > self.ndim:
            raise IndexError(f"{len(keys) - len(dots)} indices for an array of {self.ndim} axes")
        at = dots[0] if dots else len(keys)
        keys[at:at + len(dots)] = [slice(None)] * (self.ndim - len(keys) + len(dots))

        ranges, rest = [], []
        for axis, (k, side) in enumerate(zip(keys, self.shape)):
            if isinstance(k, slice):
                found, kept = range(*k.indices(side)), slice(None)
            else:
                try:
                    i = operator.index(k) if not isinstance(k, (bool, np.bool_)) else None
                except TypeError:
                    i = None
                if i is None:
                    raise IndexError(f"an index is an integer, a slice or '...', not {k!r}")
                if not -side <= i < side:
                    raise IndexError(f"index {i} is outside axis {axis} of {side}")
                found, kept = range(i % side, i % side + 1), 0
            if axis < 4:
                ranges.append(found)
                rest.append(kept)
            else:
                rest.append(k)
        return ranges, tuple(rest)

    def _strided(self, ranges: Sequence[range]) -> np.ndarray:
        """The texels at u, v, s, t of `ranges`, none of them empty, in their order."""
        rising = [r if r.step > 0 else r[::-1] for r in ranges]
        begin, end = [r[0] for r in rising], [r[-1] + 1 for r in rising]
        if all(r.step == 1 or len(r) == 1 for r in rising):
            texels = self._texels(begin, end, 0)
        else:
            u, v, s, t = (len(r) for r in rising)
            raw = np.empty((v, u, t, s, self.channels), self.dtype)
            texels = raw.transpose(1, 0, 3, 2, 4)
            self._fill(rising, texels)
        return texels[tuple(slice(None, None, -1 if r.step < 0 else 1) for r in ranges)]

    def _fill(self, ranges: Sequence[range], out: np.ndarray) -> None:
        begin, end = [r[0] for r in ranges], [r[-1] + 1 for r in ranges]
        box_bytes = self.dtype.itemsize * self.channels
        for low, high in zip(begin, end):
            box_bytes *= high - low
        axis = self._axis_to_split(ranges) if box_bytes > max(BOX_BYTES, 2 * out.nbytes) else None
        if axis is None:
            texels = self._texels(begin, end, 0)
            out[...] = texels[tuple(slice(None, None, r.step) for r in ranges)]
            return
        # Split between tiles, so that no tile is decoded twice.
        half = self._split(ranges[axis], axis)
        for part in (slice(None, half), slice(half, None)):
            parts = list(ranges)
            parts[axis] = ranges[axis][part]
            self._fill(parts, out[(slice(None),) * axis + (part,)])

    def _axis_to_split(self, ranges: Sequence[range]) -> Optional[int]:
        """The axis with steps that has the most tiles, if one can be split between tiles."""
        tiles = [(r[-1] - r[0]) / self.chunks[axis] if r.step > 1 and self._split(r, axis) else 0.0
                 for axis, r in enumerate(ranges)]
        most = max(tiles)
        return tiles.index(most) if most > 0 else None

    def _split(self, r: range, axis: int) -> int:
        """How many coordinates come before a tile's edge near the middle; 0: there is no edge."""
        side = self.size[axis]
        count = -(-side // self.chunks[axis])  # tile i of n begins at i * side // n
        tile = ((r[len(r) // 2] + 1) * count - 1) // side
        for edge in (tile * side // count, (tile + 1) * side // count):
            before = len(range(r[0], min(edge, r[-1] + 1), r.step))
            if 0 < before < len(r):
                return before
        return 0

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> np.ndarray:
        if copy is False:
            raise ValueError("texels have to be decoded, so they cannot be had without a copy")
        texels = self[...]
        return texels if dtype is None else texels.astype(dtype, copy=False)
