"""Data sets of random numbers in the layout of the contract, whole and joined from parts."""

from __future__ import annotations

import os
import tempfile
import unittest

import h5py
import numpy as np

SAMPLES, VERTICES, JOINTS, SIZE = 48, 40, 5, 16
ARRAYS = {
    "pose": ((JOINTS, 3), "f8"),
    "cloth": ((VERTICES, 3), "f4"),
    "embedded": ((VERTICES, 3), "f4"),
    "displacement": ((VERTICES, 3), "f4"),
    "frame": ((VERTICES, 4), "f4"),
    "image": ((6, SIZE, SIZE), "f4"),
}
FIELDS = ("id", *ARRAYS, "certificate/max_stretch")


def sample_values(first: int, count: int) -> dict[str, np.ndarray]:
    """Values of samples [first, first + count), which depend on the sample's number alone."""
    values: dict[str, np.ndarray] = {name: np.empty((count, *shape), kind) for name, (shape, kind) in ARRAYS.items()}
    for k in range(count):
        random = np.random.default_rng(first + k)
        for name, (shape, _) in ARRAYS.items():
            values[name][k] = random.normal(size=shape)
    number = np.arange(first, first + count)
    values["id"] = 3 * number + 7
    values["split"] = np.array([0, 0, 0, 1, 2, 0, 0, 0], "i1")[number % 8]
    values["status"] = np.where(number % 11 == 5, 2, 0).astype("i1")
    values["digest"] = np.zeros((count, 16), "u1")
    return values


def write_header(file: h5py.File) -> None:
    file.attrs["format"] = np.bytes_("toile")
    file.attrs["reasons"] = np.array([b"accepted", b"not_at_rest", b"penetrates_body"])
    file["mesh/triangle"] = np.array([[0, 1, 2], [2, 1, 3]], "i4")
    file["mesh/scalar"] = 1.0
    file["mesh/rest_position"] = np.zeros((VERTICES, 3))


def write_part(path: str, first: int, count: int) -> None:
    with h5py.File(path, "w") as file:
        write_header(file)
        for name, value in sample_values(first, count).items():
            if value.ndim == 1:
                file[f"samples/{name}"] = value
            else:
                file.create_dataset(f"samples/{name}", data=value, chunks=(1, *value.shape[1:]), compression="gzip",
                                    compression_opts=1, shuffle=True, fletcher32=True)  # fmt: skip
        file["certificate/max_stretch"] = 1 + 0.01 * np.arange(first, first + count)


def write_merged(path: str, parts: list[str], columns_virtual: bool = False) -> None:
    """As toile merge joins: big arrays virtual, by relative paths, columns copied."""
    with h5py.File(path, "w") as file:
        write_header(file)
        opened = [h5py.File(part, "r") for part in parts]
        for name in (*(f"samples/{n}" for n in sample_values(0, 1)), "certificate/max_stretch"):
            pieces = [part[name] for part in opened]
            shape = (sum(len(piece) for piece in pieces), *pieces[0].shape[1:])
            if len(shape) == 1 and not columns_virtual:
                file[name] = np.concatenate([piece[:] for piece in pieces])
                continue
            layout, row = h5py.VirtualLayout(shape, pieces[0].dtype), 0
            for part, piece in zip(parts, pieces):
                source = h5py.VirtualSource(os.path.relpath(part, os.path.dirname(path)), name, piece.shape)
                layout[row : row + len(piece)] = source
                row += len(piece)
            file.create_virtual_dataset(name, layout)
        for part in opened:
            part.close()


class DatasetCase(unittest.TestCase):
    """A folder with `whole.h5` and `merged.h5` of the same samples, the latter of three parts in folders."""

    @classmethod
    def setUpClass(cls) -> None:
        cls._folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls._folder.cleanup)
        cls.folder = cls._folder.name
        cls.whole = os.path.join(cls.folder, "whole.h5")
        write_part(cls.whole, 0, SAMPLES)
        parts = []
        for first, count in ((0, 20), (20, 1), (21, SAMPLES - 21)):
            parts.append(os.path.join(cls.folder, f"shard_{len(parts)}", "part_00000.h5"))
            os.makedirs(os.path.dirname(parts[-1]))
            write_part(parts[-1], first, count)
        cls.merged = os.path.join(cls.folder, "merged.h5")
        write_merged(cls.merged, parts)
        with h5py.File(cls.whole, "r") as file:  # the truth: plain h5py
            cls.direct = {
                name: file[name if "/" in name else f"samples/{name}"][:] for name in (*FIELDS, "split", "status")
            }

    def expected(self, split: int | None = 0, accepted: bool = True) -> np.ndarray:
        """Rows of a split."""
        rows = np.ones(SAMPLES, bool) if split is None else self.direct["split"] == split
        return np.flatnonzero(rows & (self.direct["status"] == 0) if accepted else rows)

    def assert_same(self, found: np.ndarray, expected: np.ndarray) -> None:
        """Type, shape and every byte."""
        found = np.asarray(found)
        self.assertEqual((found.dtype, found.shape), (expected.dtype, expected.shape))
        self.assertEqual(found.tobytes(), expected.tobytes())
