"""Encoding arrays: what is accepted, what is refused, and what is left behind."""
import io
import signal
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest
from conftest import smooth

import tessera


def lossless(array, **options):
    return tessera.encode_bytes(array, lossless=True, effort=0, **options)


def decoded(data):
    with tessera.open(data) as texture:
        return texture[...]


class Sliced:
    """An array that is not numpy's and that cannot be converted, as those on disk."""

    def __init__(self, array):
        self._array, self.shape, self.ndim = array, array.shape, array.ndim
        self.dtype, self.largest = array.dtype, 0

    def __getitem__(self, key):
        part = self._array[key]
        self.largest = max(self.largest, part.size)
        return part

    def __array__(self, *_):
        raise AssertionError("the whole array was read")


def test_all_layouts_give_the_same_bytes(texels):
    wanted = lossless(texels)
    own_order = np.ascontiguousarray(texels.transpose(1, 0, 3, 2, 4)).transpose(1, 0, 3, 2, 4)
    views = np.ascontiguousarray(texels.transpose(3, 2, 1, 0, 4))
    larger = np.zeros((40, 17, 6, 5, 4), np.uint8)
    larger[::-2, ..., :3] = texels
    for array in (own_order, np.asfortranarray(texels), views.transpose(3, 2, 1, 0, 4),
                  larger[::-2, ..., :3], Sliced(texels)):
        assert lossless(array) == wanted
    assert lossless(tessera.open(wanted)) == wanted
    assert np.array_equal(decoded(wanted), texels)


@pytest.mark.parametrize("dtype", [np.uint8, np.float16])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_strides_of_every_texel_size(channels, dtype):
    array = smooth((9, 8, 3, 4), channels=channels, dtype=dtype)
    apart = np.repeat(array, 2, axis=4)[..., ::2]  # channels that are not side by side
    for strided in (array, apart, np.broadcast_to(array[:, :1], array.shape)):
        assert np.array_equal(decoded(lossless(strided)).reshape(array.shape), strided)
    grey = array[..., 0][::-1]
    assert np.array_equal(decoded(lossless(grey)), grey)


def test_an_array_without_strides():
    everywhere = np.broadcast_to(np.uint8(7), (4, 3, 2, 2, 3))
    assert everywhere.strides == (0, 0, 0, 0, 0)
    assert np.array_equal(decoded(lossless(everywhere)), everywhere)


def test_arrays_of_numpy_are_not_copied(texels, monkeypatch):
    from tessera import _encode
    monkeypatch.setattr(_encode, "_reader", None)  # which copies
    own_order = np.ascontiguousarray(texels.transpose(1, 0, 3, 2, 4)).transpose(1, 0, 3, 2, 4)
    lossless(own_order)
    lossless(decoded(lossless(own_order)))
    lossless(texels[::-1, ..., :2], mask=np.ones(texels.shape[:4], bool)[:, ::-1])
    with pytest.raises(TypeError):
        lossless(Sliced(texels))


def test_other_arrays_are_read_by_tiles():
    array = Sliced(smooth((32, 32, 4, 4)))
    lossless(array, tile=(8, 8, 4, 4))
    assert array.largest == 8 * 8 * 4 * 4 * 3


def test_float16(tmp_path):
    halves = smooth((9, 8, 3, 4), channels=4, dtype=np.float16)
    for array in (halves, halves.astype(">f2"), Sliced(halves.astype(">f2"))):
        found = decoded(lossless(array))
        assert found.dtype == np.float16 and np.array_equal(found, halves)
    halves[0, 0, 0, 0] = [np.nan, np.inf, -np.inf, 1]
    report = tessera.encode(halves, tmp_path / "a.tess", max_error=0, effort=0)
    assert (report.nan_count, report.infinity_count) == (1, 2)


def test_rates_and_report(texels, tmp_path):
    path = tmp_path / "a.tess"
    for rate in ({"psnr": 40}, {"quality": 50}, {"bytes": 6000}, {"max_error": 2},
                 {"bits_per_texel": 4}, {}):
        report = tessera.encode(texels, path, effort=0, **rate)
        found = decoded(path)
        error = found.astype(float) - texels
        assert report.file_bytes == path.stat().st_size and report.raw_bytes == texels.nbytes
        assert abs(report.psnr - 10 * np.log10(255 ** 2 / (error ** 2).mean())) < 0.01
        assert report.max_error == np.abs(error).max() and report.target_met
        if "psnr" in rate:
            assert 40 <= report.psnr < 43
        if "bytes" in rate:
            assert report.file_bytes <= 6000
        if "max_error" in rate:
            assert report.max_error <= 2
        if "bits_per_texel" in rate:
            assert report.bits_per_texel <= 4
    assert tessera.encode(texels, path, lossless=True, effort=0).psnr == 999


def test_mask():
    noise = np.random.default_rng(2).integers(0, 256, (16, 16, 4, 4), np.uint8)
    mask = np.zeros((16, 16, 1, 1), bool)
    mask[:4] = True
    sizes = {}
    for name, given in (("none", None), ("bool", mask), ("uint8", mask.view(np.uint8)),
                        ("strided", np.repeat(mask, 2, 1)[:, ::2])):
        data = lossless(noise, mask=given)
        assert np.array_equal(decoded(data)[:4], noise[:4])
        sizes[name] = len(data)
    assert sizes["bool"] == sizes["uint8"] == sizes["strided"] < 0.6 * sizes["none"]
    with pytest.raises(ValueError, match="mask has four axes"):
        lossless(noise, mask=mask.astype(float))
    with pytest.raises(ValueError, match="mask"):
        lossless(noise, mask=np.ones((15, 1, 1, 1), bool))


def test_output_to_a_file_object(texels):
    class Slow(io.RawIOBase):
        """Writes at most 1000 bytes at a time."""

        def __init__(self):
            self.data = b""

        def write(self, piece):
            self.data += bytes(piece[:1000])
            return min(1000, len(piece))

    out = Slow()
    report = tessera.encode(texels, out, lossless=True, effort=0)
    assert out.data == lossless(texels) and len(out.data) == report.file_bytes

    class Full:
        @staticmethod
        def write(piece):
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        tessera.encode(texels, Full, lossless=True, effort=0)


@pytest.mark.parametrize("array, part", [
    (np.array([[[["a", "b"]]]]), "not <U1"), (np.zeros((4, 4, 2, 2)), "not float64"),
    (np.zeros((4, 4, 2, 2), object), "not object"), (np.zeros((4, 4, 2, 2), bool), "not bool"),
    (np.zeros((4, 4, 2), np.uint8), r"shape \(4, 4, 2\)"), (np.uint8(3), r"shape \(\)"),
    (np.zeros((4, 4, 2, 2, 5), np.uint8), "channels is 5"),
    (np.zeros((4, 4, 0, 2), np.uint8), "0 elements"),
    (np.zeros((0,) * 5, np.uint8), "0 elements"), ("text", "shape")])
def test_refuses_arrays(array, part, tmp_path):
    with pytest.raises(ValueError, match=part):
        tessera.encode(array, tmp_path / "a.tess")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("options, part", [
    ({"psnr": 40, "quality": 50}, "quality and psnr exclude each other"),
    ({"bytes": 9, "lossless": True}, "bytes and lossless exclude"), ({"psnr": 121}, "120"),
    ({"quality": 0}, "100"), ({"quality": float("nan")}, "not a number"),
    ({"bytes": 10}, "10 bytes"),
    ({"effort": 5}, "effort"), ({"effort": -1}, "effort is -1"), ({"effort": 2.5}, "effort is 2.5"),
    ({"effort": 1 << 32}, "effort"), ({"tile": (8, 8)}, "four numbers"),
    ({"tile": (1000, 8, 8, 8)}, "tile sides"), ({"metadata": {"a\0b": "c"}}, "NUL"),
    ({"metadata": {"a": "b\0c"}}, "NUL"), ({"metadata": {"": "c"}}, "key"),
    ({"mesh": b"no mesh"}, "mesh"),
    ({"description": tessera.Description(proxy="mesh")}, "mesh")])
def test_refuses_options(options, part, texels, tmp_path):
    path = tmp_path / "a.tess"
    path.write_bytes(b"old")
    with pytest.raises(ValueError, match=part):
        tessera.encode(texels, path, **options)
    assert path.read_bytes() == b"old" and len(list(tmp_path.iterdir())) == 1


def test_refuses_paths(texels, tmp_path):
    with pytest.raises(OSError, match="none/a.tess"):
        tessera.encode(texels, tmp_path / "none" / "a.tess", effort=0)
    with pytest.raises(OSError):
        tessera.encode(texels, tmp_path, effort=0)
    with pytest.raises(ValueError, match="NUL"):
        tessera.encode(texels, str(tmp_path / "a\0b"), effort=0)
    with pytest.raises(TypeError):
        tessera.encode(texels, None)
    assert list(tmp_path.iterdir()) == []


def test_progress(texels, tmp_path):
    steps = []
    tessera.encode(texels, tmp_path / "a.tess", psnr=40, effort=0, tile=(8, 8, 4, 4),
                   progress=lambda *step: steps.append(step + (threading.get_ident(),)))
    assert len(steps) >= 36  # tiles
    for stage, done, total, thread in steps:
        assert isinstance(stage, str) and stage and 0 <= done <= total
        assert thread == threading.get_ident()


@pytest.mark.parametrize("place", [0, 5, -1])
def test_exceptions_of_progress(place, texels, tmp_path):
    path = tmp_path / "a.tess"
    options = dict(lossless=True, effort=0, tile=(8, 8, 4, 4), threads=1)
    calls = []
    tessera.encode(texels, path, progress=lambda *_: calls.append(None), **options)
    failing, seen = range(len(calls))[place], []
    path.write_bytes(b"old")

    def progress(stage, done, total):
        seen.append(None)
        if len(seen) == failing + 1:
            raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        tessera.encode(texels, path, progress=progress, **options)
    assert path.read_bytes() == b"old" and len(list(tmp_path.iterdir())) == 1
    assert threading.Thread(target=lambda: None).start() is None  # the lock is not lost
    assert np.array_equal(decoded(lossless(texels)), texels)


def test_exceptions_of_arrays(texels, tmp_path):
    class Failing(Sliced):
        def __getitem__(self, key):
            raise KeyError("mine")

    class Wrong(Sliced):
        def __getitem__(self, key):
            return self._array

    for threads in (1, 3):
        with pytest.raises(KeyError, match="mine"):
            tessera.encode(Failing(texels), tmp_path / "a.tess", effort=0, threads=threads)
    with pytest.raises(ValueError, match="for a box of"):
        tessera.encode(Wrong(texels), tmp_path / "a.tess", effort=0, tile=(8, 8, 4, 4))
    assert list(tmp_path.iterdir()) == []


def test_other_threads_run_meanwhile(texels):
    """Encoding in another thread waits for this one, which only works without the lock."""
    may_continue, reached = threading.Event(), threading.Event()

    def progress(*_):
        reached.set()
        assert may_continue.wait(60)

    found = []
    thread = threading.Thread(
        target=lambda: found.append(tessera.encode_bytes(texels, effort=0, progress=progress)))
    thread.start()
    assert reached.wait(60)
    other = tessera.encode_bytes(texels, effort=0, threads=2)
    may_continue.set()
    thread.join()
    assert found == [other]


def run_script(text, **options):
    return subprocess.Popen([sys.executable, "-c", textwrap.dedent(text)], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)


def test_interrupt(tmp_path):
    """Ctrl-C ends encoding and writes nothing."""
    script = run_script("""
        import numpy, tessera
        noise = numpy.random.default_rng(1).integers(0, 256, (256, 256, 8, 8, 3), numpy.uint8)
        try:
            tessera.encode(noise, "a.tess", psnr=40, effort=4, tile=(8, 8, 4, 4), threads=1,
                           progress=lambda *_: print("step", flush=True))
        except KeyboardInterrupt:
            print("interrupted")
        """, cwd=tmp_path)
    assert script.stdout.readline() == "step\n"
    script.send_signal(signal.SIGINT)
    out, errors = script.communicate(timeout=60)
    assert out.endswith("interrupted\n") and errors == "", errors
    assert list(tmp_path.iterdir()) == []


def test_out_of_memory():
    script = run_script("""
        import resource, numpy, tessera
        class Zeros:
            shape, ndim, dtype = (512, 512, 16, 16, 3), 5, numpy.dtype("u1")
            def __getitem__(self, key):
                return numpy.zeros([k.stop - k.start for k in key] + [3], "u1")
        texels = numpy.zeros((64, 64, 4, 4), "u1")
        data = tessera.encode_bytes(texels, effort=0)
        used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 20), -1))
        try:
            tessera.encode_bytes(Zeros(), effort=0, threads=1)
        except MemoryError as error:
            print("MemoryError:", error)
        """)
    out, errors = script.communicate(timeout=60)
    assert out.startswith("MemoryError: "), (out, errors)
