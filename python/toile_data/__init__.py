"""Reads data sets of toile, and writes what toile reads back.

    from toile_data import Dataset
    train = Dataset("out/quick/dataset.h5", split="train", fields=("pose", "cloth"))
    train[0]["cloth"]          # [V x 3] float32, metres
    train[:]["pose"]           # [N x J x 3] float64, axis-angle, radians

`TorchDataset` is the same for PyTorch and any number of DataLoader workers; it alone imports torch. Lengths are metres,
angles radians, y is up. A file needs none of this to be read: see the dataset's format in toile's documentation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from toile_data.dataset import Dataset
from toile_data.displacement import read_image, reconstruct
from toile_data.error import DataError
from toile_data.output import write_predictions, write_problem
from toile_data.pose import pose_features, rotation_matrices

if TYPE_CHECKING:
    from toile_data.torch_dataset import TorchDataset

__version__ = "0.1.0"
__all__ = [
    "DataError",
    "Dataset",
    "TorchDataset",
    "pose_features",
    "read_image",
    "reconstruct",
    "rotation_matrices",
    "write_predictions",
    "write_problem",
]


def __getattr__(name: str) -> Any:
    if name != "TorchDataset":
        raise AttributeError(f"module 'toile_data' has no attribute '{name}'")
    from toile_data.torch_dataset import TorchDataset

    return TorchDataset
