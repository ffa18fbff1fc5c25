"""Rows of a dataset, also of one that is put together from many files.

`toile merge` joins shards by virtual datasets: a list of which rows lie in which file. HDF5 reads these, but fills
in for a part that is missing or damaged without a word, and keeps every part open that it ever read. So rows are looked up
in that list and read from their part here.
"""

from __future__ import annotations

import os
from bisect import bisect_right
from dataclasses import dataclass

import h5py
import numpy as np

from toile_data.error import DataError
from toile_data.open_file import OpenFile, OpenFiles, hdf5_lock


@dataclass(frozen=True)
class _Source:
    """Rows [first, first + count) are the rows from `source_first` of a dataset of another file."""

    first: int
    count: int
    path: str
    dataset: str
    source_first: int


def _box(space: h5py.h5s.SpaceID, whole: tuple[int, ...], where: str) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Start and size of what a dataspace selects, which must be one box; `whole` is the size where it selects all."""
    if space.get_select_type() == h5py.h5s.SEL_ALL:
        return (0,) * len(whole), whole
    start, last = space.get_select_bounds()
    size = tuple(int(b) - int(a) + 1 for a, b in zip(start, last))
    if int(np.prod(size)) != space.get_select_npoints():
        raise DataError(f"{where} is a virtual dataset that picks single values, which toile merge does not write")
    return tuple(int(a) for a in start), size


def _sources(dataset: h5py.Dataset, path: str) -> list[_Source]:
    """The parts of a virtual dataset, in the order of its rows, with no gap between."""
    where = f"{path}:{dataset.name}"
    result = []
    for part in dataset.virtual_sources():
        start, size = _box(part.vspace, dataset.shape, where)
        source_start, source_size = _box(part.src_space, size, where)
        if any(start[1:]) or any(source_start[1:]) or size[1:] != dataset.shape[1:] or size != source_size:
            raise DataError(f"{where} is a virtual dataset whose parts are not whole rows")
        file = path if part.file_name == "." else os.path.join(os.path.dirname(path), part.file_name)
        result.append(_Source(start[0], size[0], os.path.abspath(file), part.dset_name, source_start[0]))
    result.sort(key=lambda source: source.first)
    ends = [0] + [source.first + source.count for source in result]
    if [source.first for source in result] != ends[:-1] or ends[-1] != dataset.shape[0]:
        raise DataError(f"{where} has rows that no part fills; toile generate --resume makes them")
    missing = sorted({source.path for source in result if not os.path.exists(source.path)})
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise DataError(
            f"{where} lies in parts that are not there: {missing[0]}{more}; move a merged data set together with its "
            "shard folders"
        )
    return result


class Rows:
    """One dataset of a file, read a row at a time. Picklable; `shape` and `dtype` are as stored."""

    def __init__(self, file: OpenFile, parts: OpenFiles, name: str) -> None:
        self._file, self._parts, self.name = file, parts, name
        with hdf5_lock:
            dataset = file.handle[name]
            self.shape: tuple[int, ...] = dataset.shape
            self.dtype: np.dtype = dataset.dtype
            if dataset.is_virtual:
                self._sources = _sources(dataset, file.path)
            else:
                self._sources = [_Source(0, dataset.shape[0] if dataset.shape else 0, file.path, name, 0)]
        self._first = [source.first for source in self._sources]
        self._loaded: np.ndarray | None = None

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_loaded": None}

    def read(self, rows: np.ndarray) -> np.ndarray:
        """`[len(rows) x ...]` of the stored type."""
        if len(self.shape) == 1:
            return self.column()[rows]
        result = np.empty((len(rows), *self.shape[1:]), self.dtype)
        for k, row in enumerate(rows):
            source = self._sources[bisect_right(self._first, row) - 1]
            first = source.source_first + int(row) - source.first
            self._read(source, first, result[k : k + 1])
        return result

    def column(self) -> np.ndarray:
        """All rows, kept in memory: for datasets of one value a sample, of which many share a chunk."""
        if self._loaded is None:
            result = np.empty(self.shape, self.dtype)
            for source in self._sources:
                self._read(source, source.source_first, result[source.first : source.first + source.count])
            self._loaded = result
        return self._loaded

    def _read(self, source: _Source, first: int, buffer: np.ndarray) -> None:
        """Rows [first, first + len(buffer)) of a part."""
        if len(buffer) == 0:
            return
        with hdf5_lock:
            try:
                file = self._file if source.path == self._file.path else self._parts.get(source.path)
                dataset = file.dataset(source.dataset)
                if dataset.is_virtual:
                    raise OSError("a part that is put together from parts, which toile merge does not write")
                if dataset.shape[1:] != buffer.shape[1:] or first + len(buffer) > dataset.shape[0]:
                    raise OSError(f"it has shape {dataset.shape}, which is not that of a part of {self._file.path}")
                dataset.read_direct(buffer, np.s_[first : first + len(buffer)])
            except (OSError, KeyError) as error:
                last = first + len(buffer) - 1
                rows = f"row {first}" if first == last else f"rows {first} to {last}"
                raise DataError(f"{source.path}:{source.dataset} {rows} cannot be read: {error}") from error
