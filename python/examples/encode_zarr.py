#!/usr/bin/env python3
"""Encodes a light field that is larger than a worker's memory, by chunks, with dask.distributed.

    encode_zarr.py FOLDER [--gigabytes 2] [--workers 2] [--memory 400MiB] [--psnr 40] [--effort 0]

Writes FOLDER/raw.zarr, a synthetic light field of that size without compression, and encodes it to
FOLDER/tessera.zarr, of which each chunk is a .tess file. Then it compares
the two and samples one view. Prints sizes, times and the most memory that a worker took.
"""
import argparse
import os
import pathlib
import resource
import shutil
import time

import dask
import dask.array
import distributed
import numpy as np
import zarr

from tessera.numcodecs import Tessera

CHUNK = (128, 128, 16, 16, 3)  # u, v, s, t, channels: 12.6 MB


def make_chunk(block_info=None):
    """Waves that move with the camera, with a parallax that differs from place to place."""
    place = block_info[None]["array-location"]
    u, v, s, t = np.meshgrid(*(np.arange(*side, dtype=np.float32) for side in place[:4]),
                             indexing="ij", sparse=True)
    depth = 0.5 + 0.5 * np.sin(u / 150) * np.cos(v / 110)
    x, y = u + depth * s, v + depth * t
    random = np.random.default_rng(list(block_info[None]["chunk-location"]))
    texels = np.empty([end - begin for begin, end in place], np.uint8)
    for channel, (a, b) in enumerate(((9, 13), (17, 11), (23, 29))):
        waves = np.sin(x / a) * np.cos(y / b) + 0.3 * np.sin((x + 2 * y) / 5)
        noise = random.standard_normal(waves.shape, np.float32)
        texels[..., channel] = 127 + 80 * waves + 1.5 * noise
    return texels


def squared_error(one, other):
    """The sum over a chunk, channel by channel to save memory, as an array of one element."""
    total = sum(np.square(one[..., i].astype(np.float32) - other[..., i]).sum(dtype=np.float64)
                for i in range(one.shape[-1]))
    return np.full((1,) * one.ndim, total)


def peak_memory(dask_worker):
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # MiB


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--gigabytes", type=float, default=2)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--memory", default="400MiB", help="limit of each worker")
    parser.add_argument("--psnr", type=float, default=40)
    parser.add_argument("--effort", type=int, default=0)
    options = parser.parse_args()
    raw_path, coded_path = str(options.folder / "raw.zarr"), str(options.folder / "tessera.zarr")
    for path in (raw_path, coded_path):
        shutil.rmtree(path, ignore_errors=True)

    chunks = max(1, round(options.gigabytes * 1e9 / np.prod(CHUNK)))
    rows = max(1, int(chunks ** 0.5))
    shape = (CHUNK[0] * -(-chunks // rows), CHUNK[1] * rows) + CHUNK[2:]
    layout = {"shape": shape, "chunks": CHUNK, "dtype": "u1"}
    # Workers that keep few chunks at a time stay far below the limit, so they need not spill.
    dask.config.set({"distributed.scheduler.worker-saturation": 1.1})
    with distributed.LocalCluster(n_workers=options.workers, threads_per_worker=1,
                                  memory_limit=options.memory, dashboard_address=None) as cluster, \
            distributed.Client(cluster) as client:
        start = time.time()
        field = dask.array.map_blocks(
            make_chunk, dtype=np.uint8,
            chunks=dask.array.core.normalize_chunks(CHUNK, shape=shape))
        field.store(zarr.open(raw_path, "w", compressor=None, **layout), lock=False)
        made = time.time()
        print(f"raw: {np.prod(shape) / 1e9:.2f} GB, {shape}, made in {made - start:.0f} s")

        coded = zarr.open(coded_path, "w", **layout,
                          compressor=Tessera(psnr=options.psnr, effort=options.effort))
        dask.array.from_zarr(raw_path).store(coded, lock=False)
        print(f"encoded: {coded.nbytes_stored / 1e6:.2f} MB in {time.time() - made:.0f} s by "
              f"{options.workers} workers on {os.cpu_count()} cores")

        start = time.time()
        result, truth = (dask.array.from_zarr(path) for path in (coded_path, raw_path))
        errors = dask.array.map_blocks(squared_error, result, truth, dtype=np.float64,
                                       chunks=(1,) * len(CHUNK))
        mean = float(errors.sum().compute()) / np.prod(shape)
        print(f"all of it compared: {10 * np.log10(255 ** 2 / mean):.2f} dB in "
              f"{time.time() - start:.0f} s")
        start = time.time()
        view = result[:, :, 7, 7].compute()
        print(f"one view, {view.shape}, in {time.time() - start:.1f} s")
        most = max(client.run(peak_memory).values())
        print(f"most memory of a worker: {most:.0f} MiB, limit {options.memory}")


if __name__ == "__main__":
    main()
