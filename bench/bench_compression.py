#!/usr/bin/env python3
"""What compression costs and saves: bytes, write time and read time of a data set's samples, array by array.

    bench/bench_compression.py out/tshirt/dataset.h5 [--repeat 5] [--csv FILE]

Rewrites the accepted samples of a data set, one chunk a sample, with gzip at several levels, with and without the
shuffle filter and the fletcher32 checksum, into a temporary file, and reads them back sample by sample. Times are the
best of `--repeat` rounds, the file in the page cache: what the filters take, not what the disk takes. Each array is
compared with what was written.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
import tempfile
import time

import h5py
import numpy as np

ARRAYS = ("cloth", "embedded", "displacement", "frame", "image")
GZIP = (0, 1, 2, 3, 4, 6, 9)


def variants() -> list[tuple[str, dict]]:
    """Name and h5py's keywords of each way to store a sample."""
    result: list[tuple[str, dict]] = [("none", {})]
    for level in GZIP:
        for shuffle in (False, True):
            if level == 0 and shuffle:
                continue
            keywords = {"shuffle": shuffle, "fletcher32": True}
            if level > 0:
                keywords |= {"compression": "gzip", "compression_opts": level}
            result.append((f"gzip {level}" + (" shuffle" if shuffle else "") + " fletcher32", keywords))
    result.append(("gzip 4 shuffle", {"shuffle": True, "compression": "gzip", "compression_opts": 4}))
    return result


def write(path: str, values: np.ndarray, keywords: dict) -> float:
    with h5py.File(path, "w") as file:
        rows = file.create_dataset("a", values.shape, values.dtype, chunks=(1, *values.shape[1:]), **keywords)
        start = time.perf_counter()
        for i, value in enumerate(values):
            rows[i] = value
        file.flush()
        return (time.perf_counter() - start) / len(values)


def read(path: str, values: np.ndarray) -> float:
    with h5py.File(path, "r") as file:
        rows = file["a"]
        buffer = np.empty_like(values)
        start = time.perf_counter()
        for i in range(len(values)):
            rows.read_direct(buffer, np.s_[i], np.s_[i])
        seconds = (time.perf_counter() - start) / len(values)
    if not np.array_equal(buffer, values, equal_nan=True):
        raise SystemExit(f"bench_compression: {path} does not hold what was written")
    return seconds


def stored_bytes(path: str, values: np.ndarray) -> float:
    with h5py.File(path, "r") as file:
        return file["a"].id.get_storage_size() / len(values)


def measure(values: np.ndarray, keywords: dict, repeat: int, folder: str) -> tuple[float, float, float]:
    """Bytes, seconds to write and seconds to read of a sample."""
    path = os.path.join(folder, "a.h5")
    written = min(write(path, values, keywords) for _ in range(repeat))
    return stored_bytes(path, values), written, min(read(path, values) for _ in range(repeat))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("dataset")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--arrays", nargs="+", default=list(ARRAYS))
    parser.add_argument("--csv", help="also write the table here")
    options = parser.parse_args()
    rows = []
    with h5py.File(options.dataset, "r") as file, tempfile.TemporaryDirectory() as folder:
        accepted = np.flatnonzero(file["samples/status"][:] == 0)
        for array in options.arrays:
            if f"samples/{array}" not in file:
                continue
            values = file[f"samples/{array}"][:][accepted]
            print(f"{array} {values.shape} {values.dtype}, {values[0].nbytes / 1e3:.1f} kB a sample")
            for name, keywords in variants():
                size, written, taken = measure(values, keywords, options.repeat, folder)
                rows.append((array, name, size, 1e3 * written, 1e3 * taken))
                print(f"  {name:26} {size / 1e3:9.1f} kB   write {1e3 * written:8.3f} ms   read {1e3 * taken:7.3f} ms")
    print("all arrays")
    for name, _ in variants():
        size, written, taken = (sum(row[k] for row in rows if row[1] == name) for k in (2, 3, 4))
        print(f"  {name:26} {size / 1e3:9.1f} kB   write {written:8.3f} ms   read {taken:7.3f} ms")
    if options.csv:
        with open(options.csv, "w", newline="") as stream:
            csv.writer(stream).writerows([("array", "filters", "bytes", "write_ms", "read_ms"), *rows])
    return 0


if __name__ == "__main__":
    sys.exit(main())
