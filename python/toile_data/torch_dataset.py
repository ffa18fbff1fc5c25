"""A data set's samples as PyTorch tensors, for any number of DataLoader workers."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

import numpy as np

try:
    import torch
    from torch.utils import data
except ImportError as error:
    raise ImportError(
        "toile_data.TorchDataset needs PyTorch (Debian: python3-torch); toile_data.Dataset does without"
    ) from error

from toile_data.dataset import Dataset, Split, Status


class TorchDataset(data.Dataset):
    """`Dataset` as a map-style torch.utils.data.Dataset.

        train = TorchDataset("dataset.h5", split="train", fields=("pose", "displacement"))
        for batch in torch.utils.data.DataLoader(train, batch_size=32, shuffle=True, num_workers=8):
            batch["pose"], batch["displacement"]     # [32 x J x 3], [32 x V x 3]

    An item is a dict of tensors, one for each field: float32 for numbers with a fraction, int64 for whole numbers. Each
    worker opens the file for itself when it first reads, whether it was forked or spawned, and whatever was read before
    in the parent. `preload` keeps all samples in memory; workers share it.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        split: Split = "train",
        fields: Sequence[str] = ("pose", "cloth"),
        status: Status = "accepted",
        preload: bool = False,
    ) -> None:
        self.samples = Dataset(path, split, fields, status)
        self._loaded: dict[str, torch.Tensor] | None = None
        if preload:
            self._loaded = {field: _tensor(value) for field, value in self.samples[:].items()}

    def __len__(self) -> int:
        return len(self.samples)

    def __getitem__(self, index: int) -> dict[str, torch.Tensor]:
        if self._loaded is None:
            return {field: _tensor(value) for field, value in self.samples[index].items()}
        if not -len(self) <= index < len(self):
            raise IndexError(f"sample {index} of {len(self)}")
        return {field: value[index] for field, value in self._loaded.items()}

    def __iter__(self) -> Iterator[dict[str, torch.Tensor]]:
        return (self[i] for i in range(len(self)))

    @property
    def ids(self) -> np.ndarray:
        """Pose numbers `[N]`, in the order of the items."""
        return self.samples.ids


def _tensor(value: np.ndarray | np.generic) -> torch.Tensor:
    array = np.asarray(value)
    return torch.from_numpy(array.astype(np.float32 if array.dtype.kind == "f" else np.int64, copy=False))
