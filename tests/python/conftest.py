"""What the tests of the Python package share."""
import pathlib

import numpy as np
import pytest

import tessera

ROOT = pathlib.Path(__file__).resolve().parents[2]
GOLDEN = ROOT / "tests" / "golden"


def smooth(size, channels=3, dtype=np.uint8):
    """A texture that is smooth along all axes; all its axes differ."""
    u, v, s, t = np.meshgrid(*map(np.arange, size), indexing="ij")
    planes = [3 * u + 5 * v + 7 * s + 11 * t + 40 * i + (u * v) % 5 for i in range(channels)]
    texels = np.stack(planes, axis=-1) % 256
    return (texels if dtype == np.uint8 else texels / 16).astype(dtype)


@pytest.fixture(scope="session")
def texels():
    return smooth((20, 17, 6, 5))


@pytest.fixture(scope="session")
def tiled_file(texels, tmp_path_factory):
    """A lossless file of `texels` with 3 x 3 x 2 x 2 tiles."""
    path = tmp_path_factory.mktemp("python") / "tiled.tess"
    tessera.encode(texels, path, lossless=True, effort=0, tile=(8, 8, 4, 4),
                   metadata={"Title": "Größe"})
    return path


@pytest.fixture(scope="session")
def noise():
    return np.random.default_rng(1).integers(0, 256, (64, 64, 8, 8), np.uint8)


@pytest.fixture(scope="session")
def noise_bytes(noise):
    """A file of `noise` with 4 x 4 tiles, too large to be read at opening."""
    data = tessera.encode_bytes(noise, lossless=True, effort=0, tile=(16, 16, 8, 8))
    assert len(data) > 200000
    return data
