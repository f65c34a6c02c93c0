#!/usr/bin/env python3
"""Times tessera.encode and slicing beside the tool, on the same texels.

    speed.py TOOL FOLDER [EFFORT...]

Writes the texels and the results to FOLDER. Each time is the shortest of five runs, alternately of
the tool and of numpy. The tool's time is that of its process, which reads and writes raw texels.
The time of decoding by numpy includes writing them, too.
"""
import pathlib
import subprocess
import sys
import time

import numpy as np

import tessera

RUNS = 5


def texture():
    u, v, s, t = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in (256, 256, 16, 16)),
                             indexing="ij", sparse=True)
    x, y = u + 0.4 * s, v + 0.3 * t
    planes = [np.sin(x / a) * np.cos(y / b) + 0.3 * np.sin((x + 2 * y) / 5)
              for a, b in ((9, 13), (17, 11), (23, 29))]
    texels = (127 + 90 * np.stack(planes, axis=-1)).astype(np.uint8)
    return texels + np.random.default_rng(1).integers(0, 4, texels.shape, np.uint8)


def timed(work):
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def compare(what, tool_command, work):
    tool, own = [], []
    for _ in range(RUNS):
        tool.append(timed(lambda: subprocess.run(tool_command, check=True, capture_output=True)))
        own.append(timed(work))
    percent = 100 * (min(own) / min(tool) - 1)
    print(f"| {what} | {min(tool):.3f} s | {min(own):.3f} s | {percent:+.1f} % |", flush=True)


def main(tool, folder, *efforts):
    folder = pathlib.Path(folder)
    texels = texture()
    raw, by_tool, by_numpy = folder / "texels.raw", folder / "tool.tess", folder / "numpy.tess"
    texels.transpose(1, 0, 3, 2, 4).tofile(raw)
    size = "x".join(map(str, texels.shape[:4]))
    print(f"{texels.nbytes / 1e6:.1f} MB\n\n| | tool | numpy | difference |\n|---|---|---|---|")
    for effort in efforts or ("0", "1", "3"):
        command = [tool, "encode", raw, "--size", size, "--type", "unorm8", "--channels", "3", "-o",
                   by_tool, "--target-psnr", "40", "--effort", effort, "--quiet"]
        compare(f"encode, effort {effort}", command,
                lambda: tessera.encode(texels, by_numpy, psnr=40, effort=int(effort)))
        with tessera.open(by_tool) as one, tessera.open(by_numpy) as other:
            assert np.array_equal(one[...], other[...])

        def decode():
            with tessera.open(by_numpy) as opened:
                opened[...].transpose(1, 0, 3, 2, 4).tofile(folder / "decoded.raw")

        compare(f"decode, effort {effort}",
                [tool, "decode", by_numpy, "-o", folder / "decoded.raw", "--quiet"], decode)


main(*sys.argv[1:])
