"""Files for toile to read: predictions, and problems for the priors."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

import h5py
import numpy as np

from toile_data.error import DataError


def write_predictions(path: str | os.PathLike[str], ids: Sequence[int] | np.ndarray, predicted: np.ndarray) -> None:
    """A predictions file: r̂ `[N x V x 3]` [m], float32 or float64, of the poses `ids` `[N]`, each named once.

    Written beside `path` and renamed, so that a file of this name is whole.
    """
    number, positions = np.asarray(ids), _positions(predicted, "predicted")
    if number.ndim != 1 or (number.size > 0 and not np.issubdtype(number.dtype, np.integer)):
        raise DataError("ids are pose numbers, one whole number a prediction")
    if len(number) != len(positions):
        raise DataError(f"{len(number)} ids do not go with {len(positions)} predictions")
    unique, times = np.unique(number, return_counts=True)
    if len(unique) < len(number):
        raise DataError(f"pose {unique[times > 1][0]} is predicted twice")

    def write(file: h5py.File) -> None:
        file["samples/id"] = number.astype(np.int64)
        file["samples/predicted"] = positions

    _write_whole(path, write)


def write_problem(
    path: str | os.PathLike[str],
    dataset: str | os.PathLike[str],
    predicted: np.ndarray,
    target: np.ndarray | None = None,
) -> None:
    """A problem file for `toile project`: the mesh of the file `dataset`, r̂ and, for gradients, r_T `[N x V x 3]` [m]."""
    positions = _positions(predicted, "predicted")
    truth = None if target is None else _positions(target, "target")
    if truth is not None and truth.shape != positions.shape:
        raise DataError(f"target has shape {truth.shape}, predicted {positions.shape}")
    if not os.path.exists(dataset):
        raise DataError(f"there is no file {os.fspath(dataset)}")
    with h5py.File(dataset, "r", locking=False) as source:
        if "mesh/rest_position" not in source:
            raise DataError(f"{os.fspath(dataset)} has no mesh")
        vertices = source["mesh/rest_position"].shape[0]
        if positions.shape[1] != vertices:
            raise DataError(f"predicted has {positions.shape[1]} vertices, the mesh {vertices}")

        def write(file: h5py.File) -> None:
            source.copy("mesh", file)
            file["samples/predicted"] = positions
            if truth is not None:
                file["samples/target"] = truth

        _write_whole(path, write)


def _positions(value: np.ndarray, name: str) -> np.ndarray:
    positions = np.asarray(value)
    if positions.ndim != 3 or positions.shape[2] != 3 or positions.dtype not in (np.float32, np.float64):
        raise DataError(f"{name} has shape {positions.shape} of {positions.dtype}, not (N, V, 3) of float32 or float64")
    return positions


def _write_whole(path: str | os.PathLike[str], write: Callable[[h5py.File], None]) -> None:
    partial = os.fspath(path) + ".partial"
    try:
        with h5py.File(partial, "w", locking=False) as file:
            write(file)
        os.replace(partial, path)
    except BaseException:
        if os.path.exists(partial):
            os.remove(partial)
        raise
