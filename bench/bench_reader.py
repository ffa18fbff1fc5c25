#!/usr/bin/env python3
"""Samples a second through PyTorch's DataLoader.

    PYTHONPATH=python bench/bench_reader.py out/tshirt/dataset.h5 [--samples 256] [--levels 0 1 3 4] [--workers 0 1 2 8]
        [--ways fork spawn] [--fields pose,displacement pose,cloth,image] [--cold]

Writes the accepted samples of a data set, over and over up to `--samples`, into a temporary file by gzip level (shuffle,
fletcher32, a chunk a sample), and reads them shuffled in batches of 32. A figure is the second epoch's, when the workers
run; `start` is the time from making the loader to its first batch. Warm: the file is in the page cache. With --cold it is
put out of it before the epoch that counts (posix_fadvise), so that the disk counts too.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
import warnings

import h5py
import numpy as np
from torch.utils.data import DataLoader

from toile_data import TorchDataset

ARRAYS = ("pose", "cloth", "displacement", "image")
warnings.filterwarnings("ignore", message="This DataLoader will create")


def write_copy(source: str, path: str, samples: int, level: int) -> None:
    """`samples` samples, all of the train split."""
    with h5py.File(source, "r") as file, h5py.File(path, "w", libver="latest") as copy:
        accepted = np.flatnonzero(file["samples/status"][:] == 0)
        copy.attrs["format"] = np.bytes_("toile")
        copy["samples/id"] = np.arange(samples)
        copy["samples/split"] = copy["samples/status"] = np.zeros(samples, "i1")
        filters = {"shuffle": level > 0, "fletcher32": True}
        if level > 0:
            filters |= {"compression": "gzip", "compression_opts": level}
        for name in ARRAYS:
            if f"samples/{name}" not in file:
                continue
            rows = file[f"samples/{name}"]
            shape, chunk = (samples, *rows.shape[1:]), (1, *rows.shape[1:])
            stored = copy.create_dataset(f"samples/{name}", shape, rows.dtype, chunks=chunk, **filters)
            for k, row in enumerate(accepted[:samples]):
                stored[k] = rows[row]
            for k in range(len(accepted), samples):  # the same bytes again, without compressing them again
                mask, chunk_bytes = stored.id.read_direct_chunk((k % len(accepted), *(0 for _ in chunk[1:])))
                stored.id.write_direct_chunk((k, *(0 for _ in chunk[1:])), chunk_bytes, mask)


def drop_from_cache(path: str) -> None:
    with open(path, "rb") as file:
        os.fsync(file.fileno())
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def measure(path: str, fields: tuple[str, ...], workers: int, way: str | None, cold: bool) -> tuple[float, float]:
    """Samples a second of the second epoch, and seconds to the first batch."""
    start = time.perf_counter()
    data = TorchDataset(path, fields=fields)
    loader = DataLoader(
        data, 32, shuffle=True, num_workers=workers, multiprocessing_context=way, persistent_workers=workers > 0
    )
    first = None
    for _ in loader:
        first = first or time.perf_counter() - start
    if cold:
        drop_from_cache(path)
    start = time.perf_counter()
    count = sum(len(batch[fields[0]]) for batch in loader)
    return count / (time.perf_counter() - start), first or 0.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("dataset")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--levels", type=int, nargs="+", default=[0, 1, 3, 4])
    parser.add_argument("--workers", type=int, nargs="+", default=[0, 1, 2, 8])
    parser.add_argument("--ways", nargs="+", default=["fork", "spawn"], choices=["fork", "spawn"])
    parser.add_argument("--fields", nargs="+", default=["pose,displacement", "pose,cloth,image"])
    parser.add_argument("--cold", action="store_true")
    options = parser.parse_args()
    print(f"{'fields':20} {'gzip':>4} {'workers':>7} {'way':>5} {'samples/s':>10} {'start [s]':>10}")
    with tempfile.TemporaryDirectory() as folder:
        for level in options.levels:
            path = os.path.join(folder, f"level_{level}.h5")
            write_copy(options.dataset, path, options.samples, level)
            for fields in options.fields:
                for workers in options.workers:
                    for way in options.ways if workers > 0 else [None]:
                        rate, first = measure(path, tuple(fields.split(",")), workers, way, options.cold)
                        print(
                            f"{fields:20} {level:4} {workers:7} {way or '-':>5} {rate:10.0f} {first:10.2f}", flush=True
                        )
            os.remove(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
