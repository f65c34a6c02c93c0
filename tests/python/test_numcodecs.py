"""The codec for numcodecs and zarr 2."""
import numpy as np
import pytest

numcodecs = pytest.importorskip("numcodecs", reason="needs python3-numcodecs")
zarr = pytest.importorskip("zarr", reason="needs python3-zarr")

import tessera
from tessera.numcodecs import Tessera


def test_is_found_by_its_entry_point():
    codec = numcodecs.get_codec({"id": "tessera", "psnr": 40})
    assert isinstance(codec, Tessera) and codec.psnr == 40
    assert numcodecs.get_codec(codec.get_config()) == codec


def test_zarr_lossless(texels, tmp_path):
    path = str(tmp_path / "a.zarr")
    array = zarr.open(path, "w", shape=texels.shape, chunks=(16, 16, 6, 5, 3), dtype="u1",
                      compressor=Tessera(effort=0))
    array[:] = texels
    again = zarr.open(path, "r")
    assert np.array_equal(again[...], texels)
    assert np.array_equal(again[3:19, ::2, 1, -1], texels[3:19, ::2, 1, -1])
    with tessera.open(path + "/0.0.0.0.0") as chunk:
        assert np.array_equal(chunk[...], texels[:16, :16])
    array[2, 3] = 7
    assert (again[2, 3] == 7).all() and np.array_equal(again[3], texels[3])


def test_zarr_of_pictures(texels):
    pictures = np.ascontiguousarray(texels.transpose(3, 2, 1, 0, 4))
    array = zarr.array(pictures, chunks=(5, 6, 16, 16, 3),
                       compressor=Tessera(axes="tsvuc", effort=0))
    assert np.array_equal(array[...], pictures)


@pytest.mark.parametrize("shape, axes", [((9, 8, 3, 4), None), ((9, 8, 3, 4, 1), None),
                                         ((3, 4, 9, 8), "stuv"), ((1, 3, 4, 9, 8), "cstuv")])
@pytest.mark.parametrize("dtype", ["u1", "<f2"])
def test_shapes_and_types(shape, axes, dtype):
    values = np.arange(np.prod(shape)).reshape(shape).astype(dtype)
    array = zarr.array(values, chunks=shape, compressor=Tessera(axes=axes, effort=0))
    assert array[...].dtype == values.dtype and np.array_equal(array[...], values)


def test_rates(texels):
    for rate in ({"psnr": 40}, {"quality": 60}, {"max_error": 3}, {"bits_per_texel": 6}):
        codec = Tessera(effort=0, **rate)
        data = codec.encode(texels)
        assert data == tessera.encode_bytes(texels, effort=0, **rate)
        assert np.array_equal(codec.decode(data), tessera.open(data)[...])
        assert not np.array_equal(codec.decode(data), texels)


def test_flat_buffers(texels):
    codec = Tessera(effort=0, shape=texels.shape, dtype="u1")
    data = codec.encode(texels.tobytes())
    assert codec.decode(data).tobytes() == texels.tobytes()
    out = bytearray(texels.nbytes)
    codec.decode(data, out=out)
    assert out == texels.tobytes()


def test_refuses_buffers(texels):
    codec = Tessera(effort=0, shape=texels.shape, dtype="u1")
    for wrong in (texels.tobytes()[:-1], b"", texels[1:].copy()):
        with pytest.raises(ValueError, match=r"the buffer has \d+ bytes; a chunk of .* has 30600"):
            codec.encode(wrong)
    data = codec.encode(texels)
    with pytest.raises(ValueError, match="has 30599 bytes; the chunk has 30600"):
        codec.decode(data, out=bytearray(30599))
    for damaged in (b"", data[:-5], b"x" + data[1:], texels.tobytes()):
        with pytest.raises(ValueError):
            codec.decode(damaged)
    with pytest.raises(ValueError, match='order="C"'):
        Tessera().encode(np.asfortranarray(texels))
    with pytest.raises(ValueError, match="1 axes"):
        Tessera().encode(texels.tobytes())
    with pytest.raises(ValueError, match="3 axes"):
        Tessera().encode(texels[0, 0])
    with pytest.raises(ValueError, match="not float64"):
        Tessera().encode(texels.astype(float))
    for axes in ("uvs", "uvsst", "xyst", "uvstcc"):
        with pytest.raises(ValueError, match="not a permutation"):
            Tessera(axes=axes)
