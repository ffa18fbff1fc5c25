"""toile_data.TorchDataset through DataLoader: 0, 1 and 8 workers, forked and spawned, against plain h5py.

Exit status 77 says that PyTorch is not there.
"""

from __future__ import annotations

import os
import sys
import unittest
import warnings

import numpy as np
from dataset_fixture import FIELDS, DatasetCase

try:
    import torch
    from torch.utils.data import DataLoader
except ImportError:
    print("skipped: PyTorch (python3-torch) is not installed")
    sys.exit(77)

from toile_data import DataError, TorchDataset

WAYS = ((0, None), (1, "fork"), (1, "spawn"), (8, "fork"), (8, "spawn"))
warnings.filterwarnings("ignore", message="This DataLoader will create 8 worker processes")


class Loading(DatasetCase):
    def check_epoch(self, loader: DataLoader, rows: np.ndarray) -> list[int]:
        """Every sample once, every byte as in the file; the ids in the order they came."""
        came: list[int] = []
        row_of = {int(self.direct["id"][row]): row for row in rows}
        for batch in loader:
            for k, number in enumerate(batch["id"].tolist()):
                came.append(number)
                for field, tensor in batch.items():
                    truth = self.direct[field][row_of[number]]
                    kind = np.float32 if truth.dtype.kind == "f" else np.int64
                    self.assert_same(tensor[k].numpy(), np.asarray(truth, kind))
        self.assertEqual(sorted(came), sorted(row_of))
        return came

    def test_two_epochs_in_order_and_shuffled(self) -> None:
        for path in (self.whole, self.merged):
            data = TorchDataset(path, fields=FIELDS)
            data[0]  # the parent has read before workers start: pytorch#11929
            rows = self.expected()
            for workers, way in WAYS:
                if way == "spawn" and (workers == 8) != (path == self.merged):
                    continue  # each spawned worker imports torch for seconds
                with self.subTest(path=path, workers=workers, way=way):
                    keywords = {"num_workers": workers, "multiprocessing_context": way, "batch_size": 4}
                    if workers > 0:
                        keywords["persistent_workers"] = True
                    plain = DataLoader(data, **keywords)
                    for _ in range(2):
                        self.assertEqual(self.check_epoch(plain, rows), self.direct["id"][rows].tolist())
                    del plain
                    if way == "spawn":
                        continue  # shuffling is the parent's work
                    shuffled = DataLoader(data, shuffle=True, generator=torch.Generator().manual_seed(3), **keywords)
                    orders = [self.check_epoch(shuffled, rows) for _ in range(2)]
                    self.assertNotEqual(*orders)
                    del shuffled
            self.assert_same(data[1]["cloth"].numpy(), self.direct["cloth"][rows[1]])  # and reads on

    def test_preloaded(self) -> None:
        data = TorchDataset(self.merged, fields=FIELDS, preload=True)
        for workers, way in ((0, None), (2, "fork"), (1, "spawn")):
            with self.subTest(workers=workers, way=way):
                loader = DataLoader(data, num_workers=workers, multiprocessing_context=way, batch_size=4)
                self.check_epoch(loader, self.expected())

    def test_workers_start_anew_each_epoch(self) -> None:
        data = TorchDataset(self.merged, split="all", status="all", fields=("id", "cloth"))
        loader = DataLoader(data, num_workers=2, batch_size=4, multiprocessing_context="fork")
        for _ in range(3):
            self.check_epoch(loader, self.expected(None, False))
            data[0]

    def test_a_relative_path_in_workers(self) -> None:
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        data = TorchDataset("merged.h5", fields=("id", "cloth"))
        os.chdir("/")
        self.check_epoch(DataLoader(data, num_workers=1, multiprocessing_context="spawn"), self.expected())

    def test_items(self) -> None:
        for preload in (False, True):
            data = TorchDataset(self.whole, fields=("id", "pose"), preload=preload)
            self.assertEqual({name: value.dtype for name, value in data[0].items()},
                             {"id": torch.int64, "pose": torch.float32})  # fmt: skip
            self.assertEqual([len(data), sum(1 for _ in data)], [len(self.expected())] * 2)
            self.assertEqual([int(data[k]["id"]) for k in (2, -1)], data.ids[[2, -1]].tolist())
            self.assertRaises(IndexError, lambda d=data: d[len(d)])
        with self.assertRaisesRegex(DataError, "no field 'x'"):
            TorchDataset(self.whole, fields=("x",))


if __name__ == "__main__":
    unittest.main()
