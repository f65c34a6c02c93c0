#!/usr/bin/env python3
"""Checks that read_box.py reads the file that consumer_c writes.   check_read_box.py LIBRARY CONSUMER_C"""
import os
import subprocess
import sys
import tempfile

library, consumer = sys.argv[1:]
script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "read_box.py")


def read_box(*arguments):
    return subprocess.run([sys.executable, script, library, *arguments], capture_output=True,
                          text=True)


def check_picture(path, u0, v0, width, height, s, t):
    """Compares with the gradient of consumers/c/main.c, whose coding error is at most 1."""
    with open(path, "rb") as file:
        head, pixels = file.readline(), file.read()
    assert head == b"P5 %d %d 255\n" % (width, height), head
    assert len(pixels) == width * height
    for i, pixel in enumerate(pixels):
        u, v = u0 + i % width, v0 + i // width
        assert abs(pixel - (4 * u + 4 * v + 2 * s + 2 * t)) <= 1, (path, u, v, pixel)


with tempfile.TemporaryDirectory() as folder:
    file, out = os.path.join(folder, "gradient.tess"), os.path.join(folder, "out")
    subprocess.run([consumer, file], check=True)

    done = read_box(file, out)
    assert done.returncode == 0, done.stderr
    check_picture(out + "-2-2.pgm", 0, 0, 32, 16, 2, 2)

    done = read_box(file, out, "5:9,3:14,1:3,0:2")
    assert done.returncode == 0, done.stderr
    for s in (1, 2):
        for t in (0, 1):
            check_picture("%s-%d-%d.pgm" % (out, s, t), 5, 3, 4, 11, s, t)
    assert len(os.listdir(folder)) == 1 + 1 + 4, os.listdir(folder)

    done = read_box(file, out, "0:33,0:1,0:1,0:1")
    assert done.returncode == 1 and done.stderr.startswith("bad_argument: "), done.stderr
    done = read_box(file + ".none", out)
    assert done.returncode == 1 and done.stderr.startswith("io: "), done.stderr
    assert "Traceback" not in done.stderr
