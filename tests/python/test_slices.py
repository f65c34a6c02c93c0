"""Slices and boxes of textures follow numpy."""
import numpy as np
import pytest
from conftest import GOLDEN, smooth

import tessera
from tessera import _array

KEYS = [
    np.s_[...], np.s_[3], np.s_[-1, 2:9], np.s_[2:9, 3:11, 1, 2], np.s_[::3, ::-2, ..., 1],
    np.s_[..., 0], np.s_[..., 0:2], np.s_[:, :, -1, -2], np.s_[5:5], np.s_[9:2], np.s_[15:1000],
    np.s_[-1000:3, 0], np.s_[19::-7, 1:16:5, ::-1, 4::-4, ::-1], np.s_[1, 2, 3, 4, 2],
    np.s_[1, 2, 3, 4], np.s_[np.int64(4), :, np.uint8(1)], np.s_[0, ..., 1, :], np.s_[3:17:100],
]


@pytest.mark.parametrize("box_bytes", [1 << 26, 0])  # 0: decode in as many parts as possible
@pytest.mark.parametrize("key", KEYS, ids=str)
def test_equals_numpy(key, box_bytes, tiled_file, texels, monkeypatch):
    monkeypatch.setattr(_array, "BOX_BYTES", box_bytes)
    with tessera.open(tiled_file) as texture:
        found, wanted = texture[key], texels[key]
    assert found.shape == wanted.shape and found.dtype == wanted.dtype
    assert np.array_equal(found, wanted)


def test_steps_decode_each_tile_once_and_nothing_else(tiled_file, texels, monkeypatch):
    monkeypatch.setattr(_array, "BOX_BYTES", 0)
    boxes = []
    decode = tessera.Level._decode

    def record(self, begin, end, raw, threads):
        boxes.append(tuple(zip(begin, end)))
        decode(self, begin, end, raw, threads)

    monkeypatch.setattr(tessera.Level, "_decode", record)
    with tessera.open(tiled_file) as texture:
        assert np.array_equal(texture[::9, 0, 0, 0], texels[::9, 0, 0, 0])  # u: 0, 9, 18
    # Tiles begin at 0, 6 and 13.
    assert [box[0] for box in sorted(boxes)] == [(0, 1), (9, 10), (18, 19)]


def test_one_channel_has_no_axis():
    grey = smooth((9, 8, 3, 2), channels=1)
    for given in (grey, grey[..., 0]):
        with tessera.open(tessera.encode_bytes(given, lossless=True, effort=0)) as texture:
            assert texture.shape == (9, 8, 3, 2) and texture.channels == 1
            assert np.array_equal(texture[::2, 1], grey[::2, 1, ..., 0])


@pytest.mark.parametrize("key, part", [
    (20, "index 20 is outside axis 0 of 20"), (-21, "outside"), (np.s_[0, 0, 0, 0, 3], "axis 4"),
    (np.s_[0, 0, 0, 0, 0, 0], "6 indices"), (np.s_[..., ...], "one '...'"), ("u", "not 'u'"),
    (None, "not None"), (1.5, "not 1.5"), (True, "not True"), ([1, 2], "not \\[1, 2\\]")])
def test_refuses_indices(key, part, tiled_file):
    with tessera.open(tiled_file) as texture, pytest.raises(IndexError, match=part):
        texture[key]


def test_box(tiled_file, texels):
    with tessera.open(tiled_file) as texture:
        found = texture.box((1, 2, 3, 4), (20, 3, 6, 5), threads=1)
        assert np.array_equal(found, texels[1:20, 2:3, 3:6, 4:5])
        for begin, end in [((0, 0, 0, 0), (21, 1, 1, 1)), ((3, 0, 0, 0), (3, 1, 1, 1)),
                           ((-1, 0, 0, 0), (3, 1, 1, 1))]:
            with pytest.raises(ValueError, match="along u is empty or not inside 0 to 20"):
                texture.box(begin, end)
        with pytest.raises(ValueError, match="four numbers"):
            texture.box((0, 0), (1, 1))


def test_views_are_pictures(tiled_file, texels):
    pictures = texels.transpose(3, 2, 1, 0, 4)
    with tessera.open(tiled_file) as texture:
        assert np.array_equal(texture.views(), pictures)
        assert np.array_equal(texture.views(4, 3), pictures[3, 4])
        assert np.array_equal(texture.views(s=slice(1, 3)), pictures[:, 1:3])
        assert np.array_equal(texture.views(t=-1), pictures[-1])


def test_levels_are_arrays():
    # Coarse levels of a smooth texture are near the means of the texels that they cover.
    ramp = np.zeros((64, 64, 4, 4), np.uint8)
    ramp[...] = np.arange(64)[:, None, None, None] * 2
    with tessera.open(tessera.encode_bytes(ramp, quality=90, effort=0, tile=(16, 16, 4, 4),
                                           layers=True)) as texture:
        assert len(texture.levels) > 1
        for level in texture.levels[1:]:
            scale = 1 << level.spatial_lod
            assert level.shape == (64 // scale, 64 // scale) + (4 >> level.angular_lod,) * 2
            means = 2 * (np.arange(level.shape[0]) * scale + (scale - 1) / 2)
            assert np.abs(level[:, 0, 0, 0] - means).max() <= 8
        assert np.array_equal(texture.levels[0][3], texture[3])


def fnv1a(data):
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 & (1 << 64) - 1
    return f"{value:x}"


def test_golden_files():
    checked = 0
    for line in (GOLDEN / "manifest.txt").read_text().splitlines():
        name, wanted = line.split()
        with tessera.open(GOLDEN / name) as texture:
            if texture.nbytes > 50000:
                continue
            box = texture.box((0, 0, 0, 0), texture.size)
        raw = box.reshape(*texture.size, -1).transpose(1, 0, 3, 2, 4)
        assert fnv1a(raw.tobytes()) == wanted, name
        checked += 1
    assert checked >= 8
