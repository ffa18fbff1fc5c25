"""A data set's samples as numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any, Literal, Union

import h5py
import numpy as np

from toile_data.error import DataError
from toile_data.open_file import OpenFile, OpenFiles, hdf5_lock
from toile_data.rows import Rows

Split = Literal["train", "validation", "test", "all"]
Status = Literal["accepted", "all"]
Index = Union[slice, Sequence[int], np.ndarray]
SPLITS = ("train", "validation", "test")


class Dataset:
    """The samples of a data set file, of one split, those that passed the gate.

        train = Dataset("dataset.h5", split="train", fields=("pose", "cloth"))
        len(train)               # N
        train[3]                 # {"pose": [J x 3] float64, "cloth": [V x 3] float32}
        train[2:10]["cloth"]     # [8 x V x 3]; also train[[4, 1, 1]] and boolean masks
        train.ids                # [N] pose numbers

    fields: names of `/samples` (`id` int64, `pose` [J x 3] rad, `cloth`, `embedded`, `displacement` [V x 3] m, `frame`
        [V x 4] w,x,y,z, `image` [C x H x W] m, `split`, `status` int8, ...) or paths such as `certificate/max_stretch`.
    split: "train", "validation", "test" or "all".
    status: "accepted", or "all" with those that failed: their cloth may be at fault or NaN.
    preload: reads everything into memory now; without it a sample is read when asked for.

    The file is opened when first needed and closed before each fork; a pickled data set opens the file again where it
    arrives. A file that `toile merge` put together from shards reads the same way; parts that are missing or damaged are
    an error. May be used by several threads. Raises DataError for a missing file, a field that is not there, a
    split without samples, a chunk whose checksum is wrong.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        split: Split = "train",
        fields: Sequence[str] = ("pose", "cloth"),
        status: Status = "accepted",
        preload: bool = False,
    ) -> None:
        if split not in (*SPLITS, "all"):
            raise DataError(f"there is no split {split!r}; it is one of train, validation, test, all")
        if status not in ("accepted", "all"):
            raise DataError(f"status is {status!r}, not accepted or all")
        self._file = OpenFile(path)
        self._parts = OpenFiles()
        self.path = self._file.path
        self.split, self.status = split, status
        self.attributes = self._read_attributes()
        self.fields: tuple[str, ...] = (fields,) if isinstance(fields, str) else tuple(fields)
        self._rows = {field: self._open_rows(field) for field in self.fields}
        self._row, self.ids = self._select()
        self._loaded: dict[str, np.ndarray] | None = None
        if preload:
            self._loaded = self._read(self._row)

    def __len__(self) -> int:
        return len(self._row)

    def __getitem__(self, index: int | Index) -> dict[str, Any]:
        """One sample for a whole number, arrays with a leading sample axis for slices, lists and masks."""
        if isinstance(index, (int, np.integer)):
            if not -len(self) <= index < len(self):
                raise IndexError(f"sample {index} of {len(self)}")
            return {field: value[0] for field, value in self._at(np.array([index])).items()}
        if isinstance(index, slice):
            return self._at(np.arange(len(self))[index])
        chosen = np.asarray(index)
        if chosen.dtype != bool and not np.issubdtype(chosen.dtype, np.integer) and chosen.size > 0:
            raise TypeError(f"a data set is indexed by whole numbers, slices, lists and masks, not {index!r}")
        return self._at(np.arange(len(self))[chosen if chosen.size > 0 else chosen.astype(int)])

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"Dataset({self.path!r}, split={self.split!r}, fields={self.fields}, {len(self)} samples)"

    def shape(self, field: str) -> tuple[int, ...]:
        """Of one sample's `field`."""
        return self._rows[field].shape[1:]

    def index_of(self, ids: Sequence[int]) -> np.ndarray:
        """Where pose numbers are in this data set: `dataset[dataset.index_of([12, 40])]`."""
        place = {int(number): k for k, number in enumerate(self.ids)}
        missing = [int(number) for number in ids if int(number) not in place]
        if missing:
            raise DataError(
                f"{self.path} has no pose {', '.join(map(str, missing[:10]))}{' ...' if len(missing) > 10 else ''} "
                f"among its {self.status} samples of split {self.split}"
            )
        return np.array([place[int(number)] for number in ids], int)

    def shared(self, name: str) -> np.ndarray:
        """What all samples share, for example "mesh/triangle" [F x 3], "image/pattern_pixel" [P x 3], "image/mask"."""
        with hdf5_lock:
            stored = self._file.handle.get(name)
            if not isinstance(stored, h5py.Dataset):
                raise DataError(f"{self.path} has no dataset {name}")
            return stored[()]

    def close(self) -> None:
        """Closes the file; the next use opens it again."""
        self._file.close()
        self._parts.close()

    def _at(self, index: np.ndarray) -> dict[str, np.ndarray]:
        if self._loaded is not None:
            return {field: value[index] for field, value in self._loaded.items()}
        return self._read(self._row[index])

    def _read(self, row: np.ndarray) -> dict[str, np.ndarray]:
        return {field: rows.read(row) for field, rows in self._rows.items()}

    def _read_attributes(self) -> dict[str, Any]:
        """The root's: config, config_hash, seed, reasons, resampling_error (largest, root mean square) [m], ..."""
        with hdf5_lock:
            handle = self._file.handle
            attributes = {key: _text(value) for key, value in handle.attrs.items()}
            if attributes.get("format") != "toile" or "samples" not in handle:
                raise DataError(f"{self.path} is not a data set of toile")
            return attributes

    def _open_rows(self, field: str) -> Rows:
        name = f"/{field}" if "/" in field else f"/samples/{field}"
        with hdf5_lock:
            handle = self._file.handle
            if name not in handle or not isinstance(handle[name], h5py.Dataset):
                there = ", ".join(sorted(handle["samples"]))
                raise DataError(f"{self.path} has no field {field!r}; its samples have {there}")
            rows = Rows(self._file, self._parts, name)
            if rows.shape[:1] != handle["samples/id"].shape:
                raise DataError(f"{self.path}: {field!r} does not have one value a sample")
            return rows

    def _select(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows in the file, and their pose numbers."""
        id_, split, status = (self._open_rows(name).column() for name in ("id", "split", "status"))
        wanted = np.ones(len(id_), bool) if self.split == "all" else split == SPLITS.index(self.split)
        of_split = int(wanted.sum())
        if self.status == "accepted":
            wanted &= status == 0
        if not wanted.any():
            counts = ", ".join(f"{(split == k).sum()} {name}" for k, name in enumerate(SPLITS))
            refused = f"none of its {of_split} was accepted" if of_split > 0 else "it has none"
            raise DataError(f"{self.path} has no samples of split {self.split!r}: {refused} (in the file: {counts})")
        row = np.flatnonzero(wanted)
        return row, id_[row]


def _text(value: Any) -> Any:
    """Strings are stored as bytes of one length."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.ndarray) and value.dtype.kind == "S":
        return [one.decode() for one in value]
    return value
