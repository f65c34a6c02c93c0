"""The examples of python/README.md run, one after the other."""
import os
import re
import subprocess

import numpy as np
import pytest
from conftest import ROOT

import tessera

Image = pytest.importorskip("PIL.Image", reason="needs python3-pil")
TOOL = os.environ.get("TESSERA_TOOL")
ROWS = COLUMNS = 9
DISPARITY = 2


@pytest.fixture(scope="module")
def pattern():
    """A picture that repeats along both axes, so that shifting it loses nothing."""
    v, u = np.mgrid[:24, :32] * 2 * np.pi
    waves = [np.sin(u / 32 * a) * np.cos(v / 24 * b) for a, b in ((1, 1), (3, 2), (1, 3))]
    return (127 + 100 * np.stack(waves, axis=-1)).astype(np.uint8)


@pytest.fixture(scope="module")
def folder(pattern, tmp_path_factory):
    """Views of a plane whose places differ by DISPARITY pixels between neighbouring cameras."""
    path = tmp_path_factory.mktemp("readme")
    (path / "views").mkdir()
    for t in range(ROWS):
        for s in range(COLUMNS):
            shift = -DISPARITY * (t - ROWS // 2), -DISPARITY * (s - COLUMNS // 2)
            Image.fromarray(np.roll(pattern, shift, (0, 1))).save(
                path / "views" / f"{t}_{s}.png", compress_level=1)
    return path


@pytest.fixture(scope="module")
def examples():
    found = re.findall(r"```python\n(.*?)```", (ROOT / "python" / "README.md").read_text(), re.S)
    assert len(found) == 3
    return found


def test_folder_to_file_and_refocus(examples, folder, pattern, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    exec(examples[0].replace("psnr=40,", "psnr=40, effort=0,"), {})
    assert re.fullmatch(r"186624 -> \d+ bytes at \d\d\.\d\d dB\n", capsys.readouterr().out)
    with tessera.open("field.tess") as field:
        assert field.shape == (32, 24, 9, 9, 3)
        assert field.description.angular_map == "planar-views"
        right = np.roll(pattern, (0, -DISPARITY), (0, 1)).astype(int)
        assert np.abs(field.views(5, 4) - right).mean() < 4
    exec(examples[1], {})
    focused = np.asarray(Image.open("focused.png")).astype(int)
    assert np.abs(focused - pattern).mean() < 2


@pytest.mark.skipif(TOOL is None, reason="needs the tool, in TESSERA_TOOL")
def test_box_from_a_url(examples, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    server = subprocess.Popen([TOOL, "serve", ".", "--port", "0"], stdout=subprocess.PIPE,
                              text=True)
    try:
        port = re.search(r"http://127\.0\.0\.1:(\d+)", server.stdout.readline())[1]
        names = {}
        exec(examples[2].replace("8123", port), names)
        assert "(32, 24, 9, 9, 3) My field planar-views" in capsys.readouterr().out
        with tessera.open("field.tess") as field:
            assert np.array_equal(names["box"], field[8:24, 4:20, 4, 4])
    finally:
        server.terminate()
        requests = [line for line in server.communicate()[0].splitlines() if "field.tess" in line]
    assert 1 <= len(requests) <= 3
