#!/usr/bin/env python3
"""Times tessera.encode and slicing beside the tool, on the same texels.

    speed.py TOOL FOLDER [EFFORT...]

Writes the texels and the results to FOLDER, and prints the shortest of seven runs, alternately of the
tool and of numpy: elapsed and processor seconds. The tool runs as a process, which reads and writes
raw texels. Decoding by numpy includes writing them, too.
"""
import pathlib
import resource
import subprocess
import sys
import time

import numpy as np

import tessera

RUNS = 7


def texture(side):
    u, v, s, t = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in (side, side, 16, 16)),
                             indexing="ij", sparse=True)
    x, y = u + 0.4 * s, v + 0.3 * t
    planes = [np.sin(x / a) * np.cos(y / b) + 0.3 * np.sin((x + 2 * y) / 5)
              for a, b in ((9, 13), (17, 11), (23, 29))]
    texels = (127 + 90 * np.stack(planes, axis=-1)).astype(np.uint8)
    return texels + np.random.default_rng(1).integers(0, 4, texels.shape, np.uint8)


def timed(work, who):
    """Elapsed and processor seconds of this process or of its children."""
    def processor():
        usage = resource.getrusage(who)
        return usage.ru_utime + usage.ru_stime

    start = time.perf_counter(), processor()
    work()
    return time.perf_counter() - start[0], processor() - start[1]


def compare(what, tool_command, work):
    tool, own = [], []
    for _ in range(RUNS):
        tool.append(timed(lambda: subprocess.run(tool_command, check=True, capture_output=True),
                          resource.RUSAGE_CHILDREN))
        own.append(timed(work, resource.RUSAGE_SELF))
    cells = []
    for column in (0, 1):
        a, b = min(times[column] for times in tool), min(times[column] for times in own)
        cells += [f"{a:.3f} s", f"{b:.3f} s", f"{100 * (b / a - 1):+.1f} %"]
    print(f"| {what} | {' | '.join(cells)} |", flush=True)


def main(tool, folder, *efforts):
    folder = pathlib.Path(folder)
    raw, by_tool, by_numpy = folder / "texels.raw", folder / "tool.tess", folder / "numpy.tess"
    print("| | tool | numpy | | tool, CPU | numpy, CPU | |\n|---|---|---|---|---|---|---|")
    for effort in map(int, efforts or (0, 1, 3)):
        texels = texture(256 if effort < 2 else 48)
        texels.transpose(1, 0, 3, 2, 4).tofile(raw)
        what = f"{texels.nbytes / 1e6:.1f} MB, effort {effort}"
        command = [tool, "encode", raw, "--size", "x".join(map(str, texels.shape[:4])), "--type",
                   "unorm8", "--channels", "3", "-o", by_tool, "--target-psnr", "40", "--effort",
                   str(effort), "--quiet"]
        compare(f"encode {what}", command,
                lambda: tessera.encode(texels, by_numpy, psnr=40, effort=effort))
        with tessera.open(by_tool) as one, tessera.open(by_numpy) as other:
            assert np.array_equal(one[...], other[...])

        def decode():
            with tessera.open(by_numpy) as opened:
                opened[...].transpose(1, 0, 3, 2, 4).tofile(folder / "decoded.raw")

        compare(f"decode {what}",
                [tool, "decode", by_numpy, "-o", folder / "decoded.raw", "--quiet"], decode)


main(*sys.argv[1:])
