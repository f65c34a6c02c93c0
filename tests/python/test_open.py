"""Opening paths, bytes, file objects and URLs."""
import contextlib
import http.server
import io
import pickle
import threading
import zipfile

import numpy as np
import pytest
from conftest import GOLDEN

import tessera


def test_attributes(tiled_file, texels):
    with tessera.open(str(tiled_file)) as texture:
        assert texture.shape == (20, 17, 6, 5, 3) and texture.size == (20, 17, 6, 5)
        assert texture.dtype == np.uint8 and texture.ndim == 5 and len(texture) == 20
        assert texture.nbytes == texels.nbytes and texture.chunks == (8, 8, 4, 4, 3)
        assert texture.metadata["Title"] == "Größe" and texture.mesh == b""
        assert np.array_equal(np.asarray(texture), texels)
        assert np.array_equal(np.asarray(texture, np.float32), texels.astype(np.float32))
        assert "tiled.tess" in repr(texture) and "closed" not in repr(texture)


def test_description():
    given = tessera.Description(proxy="sphere", surface_map="sphere-longitude-latitude",
                                angular_map="octahedral-hemisphere", transfer="srgb",
                                primaries="bt709", sphere_centre=(1, 2, 3), sphere_radius=4,
                                viewing_radius=(5, 60))
    data = tessera.encode_bytes(np.zeros((4, 4, 2, 2), np.uint8), effort=0, description=given)
    assert tessera.open(data).description == given
    with pytest.raises(ValueError, match="proxy is 'cube'; it can be none, sphere"):
        tessera.Description(proxy="cube")
    with pytest.raises(ValueError, match="sphere_centre has 2 numbers"):
        tessera.Description(sphere_centre=(1, 2))


def test_bytes_and_file_objects(tiled_file, texels, tmp_path):
    data = tiled_file.read_bytes()
    archive = tmp_path / "archive.zip"
    with zipfile.ZipFile(archive, "w") as out:
        out.writestr("a.tess", data)
    with zipfile.ZipFile(archive) as opened, opened.open("a.tess") as member, \
            open(tiled_file, "rb", buffering=0) as raw:
        for source in (data, bytearray(data), memoryview(data), io.BytesIO(data), member, raw):
            with tessera.open(source) as texture:
                assert np.array_equal(texture[2:15, ::4, 3], texels[2:15, ::4, 3])


def test_refuses_sources(tmp_path):
    with pytest.raises(FileNotFoundError, match="none.tess"):
        tessera.open(tmp_path / "none.tess")
    with pytest.raises(OSError, match=str(tmp_path)):
        tessera.open(tmp_path)
    with pytest.raises(ValueError, match="null byte"):
        tessera.open("a\0b")
    with pytest.raises(ValueError, match="s3://.*fsspec"):
        tessera.open("s3://bucket/a.tess")
    with pytest.raises(TypeError, match="not int"):
        tessera.open(5)
    with pytest.raises(ValueError, match="binary mode"):
        tessera.open(io.StringIO("text"))
    for damaged in (b"", b"not a texture" * 100, (GOLDEN / "rgb8.tess").read_bytes()[:500]):
        with pytest.raises(ValueError):
            tessera.open(damaged)
        with pytest.raises(ValueError):
            tessera.open(io.BytesIO(damaged))


def test_partial_files():
    data = (GOLDEN / "rgb8_tiles.tess").read_bytes()
    with pytest.raises(ValueError):
        tessera.open(data[:-200])
    with tessera.open(data[:-200], allow_partial=True) as partial, tessera.open(data) as whole:
        assert partial.shape == whole.shape and partial[...].shape == whole.shape


def test_closed_textures(tiled_file):
    texture = tessera.open(tiled_file)
    level = texture.levels[0]
    texture.close()
    texture.close()
    assert "closed" in repr(texture)
    for use in (lambda: texture[0], lambda: texture.metadata, lambda: texture.description,
                lambda: level[0], lambda: texture.mesh):
        with pytest.raises(ValueError, match="tiled.tess: the texture is closed"):
            use()


class Faulty(io.BytesIO):
    """Fails to read once it is told to."""

    error = None
    started = released = None

    def read(self, count=-1):
        if self.error is not None:
            raise self.error
        if self.started is not None:
            self.started.set()
            assert self.released.wait(60)
        return super().read(count)


def test_exceptions_of_file_objects(noise_bytes, noise):
    source = Faulty(noise_bytes)
    texture = tessera.open(source)
    source.error = ZeroDivisionError("mine")
    for _ in range(100):  # more often than exceptions are kept
        with pytest.raises(ZeroDivisionError, match="mine"):
            texture[...]
    source.error = None
    assert np.array_equal(texture[0], noise[0])
    source.close()
    with pytest.raises(ValueError, match="closed file"):
        texture[...]
    short = io.BytesIO(noise_bytes)
    texture = tessera.open(short)
    short.truncate(50000)
    with pytest.raises(OSError, match="ended [0-9]+ bytes early"):
        texture[...]


def test_closing_waits_for_other_threads(noise_bytes, noise):
    source = Faulty(noise_bytes)
    texture = tessera.open(source)
    source.released = threading.Event()
    source.started = threading.Event()
    found = []
    reader = threading.Thread(target=lambda: found.append(texture[...]))
    reader.start()
    assert source.started.wait(60)
    texture.close()
    source.released.set()
    reader.join()
    assert np.array_equal(found[0], noise)
    with pytest.raises(ValueError, match="closed"):
        texture[0]


def test_threads_share_a_texture(noise_bytes, noise):
    with tessera.open(io.BytesIO(noise_bytes)) as texture:
        found = [None] * 4
        threads = [threading.Thread(target=lambda i=i: found.__setitem__(i, texture[i:i + 9]))
                   for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert all(np.array_equal(found[i], noise[i:i + 9]) for i in range(4))


def test_pickles(tiled_file, texels):
    copy = pickle.loads(pickle.dumps(tessera.open(tiled_file)))
    assert np.array_equal(copy[3], texels[3])
    with pytest.raises(TypeError, match="path or URL"):
        pickle.dumps(tessera.open(tiled_file.read_bytes()))


class Server(http.server.BaseHTTPRequestHandler):
    data, tag, status, requests, missing, is_garbage = b"", '"1"', 206, 0, 0, False

    def do_GET(self):
        cls = type(self)
        cls.requests += 1
        cls.login = self.headers["Authorization"]
        begin, end = map(int, self.headers["Range"].partition("=")[2].split("-"))
        end = min(end + 1, len(cls.data))
        if cls.is_garbage:
            self.wfile.write(b"nonsense\r\n\r\n")
            return
        self.send_response(cls.status)
        self.send_header("Content-Range", f"bytes {begin}-{end - 1}/{len(cls.data)}")
        self.send_header("ETag", cls.tag)
        self.send_header("Content-Length", str(end - begin))
        self.end_headers()
        self.wfile.write(cls.data[begin:end - cls.missing])

    def log_message(self, *_):
        pass


@contextlib.contextmanager
def serve(**attributes):
    handler = type("Handler", (Server,), attributes)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,))
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/a.tess", handler
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def test_urls(noise_bytes, noise):
    with serve(data=noise_bytes) as (url, handler), tessera.open(url) as texture:
        assert handler.requests == 1
        assert np.array_equal(texture[40:44, 3, 2, 1], noise[40:44, 3, 2, 1])
        assert handler.requests <= 3
        assert np.array_equal(texture[...], noise)
        assert handler.requests < 20  # near tiles are merged


def test_logins_of_urls():
    data = (GOLDEN / "rgb8.tess").read_bytes()
    with serve(data=data) as (url, handler):
        for login, sent in (("", None), ("me:a%40b@", "Basic bWU6YUBi")):
            with tessera.open(url.replace("//", "//" + login)) as texture:
                assert handler.login == sent and "a%40b" not in repr(texture)
    with pytest.raises(OSError) as raised:
        tessera.open("http://me:secret@127.0.0.1:1/a.tess", timeout=5)
    assert "secret" not in str(raised.value) and "127.0.0.1:1" in str(raised.value)


def test_urls_of_files_that_change(noise_bytes):
    with serve(data=noise_bytes) as (url, handler), tessera.open(url) as texture:
        handler.tag = '"2"'
        with pytest.raises(OSError, match="has changed"):
            texture[...]


def test_urls_that_fail():
    data = (GOLDEN / "rgb8.tess").read_bytes()
    with serve(data=data, status=200) as (url, _), pytest.raises(OSError, match="range requests"):
        tessera.open(url)
    with serve(data=data, status=404) as (url, _), pytest.raises(OSError, match="404"):
        tessera.open(url)
    with serve(data=data, missing=7) as (url, _), pytest.raises(OSError, match="other bytes"):
        tessera.open(url)
    with serve(data=data, is_garbage=True) as (url, _), pytest.raises(OSError, match="not HTTP"):
        tessera.open(url)
    with pytest.raises(OSError, match="127.0.0.1:1/"):
        tessera.open("http://127.0.0.1:1/a.tess", timeout=5)
