"""python/examples on a data set whose displacements are linear in a joint's rotation matrix."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import unittest

import h5py
import numpy as np
from dataset_fixture import JOINTS, SAMPLES, VERTICES, DatasetCase

from toile_data import pose_features

EXAMPLES = os.path.join(os.path.dirname(__file__), "..", "..", "python", "examples")


class Ridge(DatasetCase):
    def run_example(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, os.path.join(EXAMPLES, "ridge.py"), *arguments]
        return subprocess.run(command, capture_output=True, text=True)

    def test_a_linear_law_is_found(self) -> None:
        random = np.random.default_rng(1)
        pose = np.zeros((SAMPLES, JOINTS, 3))
        pose[:, 2] = random.normal(size=(SAMPLES, 3))
        law = random.normal(size=(9, VERTICES * 3))
        displacement = (pose_features(pose, [2]) @ law).reshape(SAMPLES, VERTICES, 3)
        path = os.path.join(self.folder, "linear.h5")
        with h5py.File(self.whole) as whole, h5py.File(path, "w") as file:
            for name in whole.attrs:
                file.attrs[name] = whole.attrs[name]
            for name in ("id", "split", "status", "embedded"):
                whole.copy(f"samples/{name}", file, f"samples/{name}")
            file["samples/pose"] = pose
            file["samples/displacement"] = displacement.astype("f4")
            file["samples/frame"] = np.broadcast_to(np.array([1, 0, 0, 0], "f4"), (SAMPLES, VERTICES, 4))
            cloth = whole["samples/embedded"][:] + displacement
            file["samples/cloth"] = cloth.astype("f4")
        out = os.path.join(self.folder, "predictions.h5")
        outcome = self.run_example(path, "--out", out, "--ridge", "1e-9")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        rows = self.expected(None)
        with h5py.File(out) as file:
            self.assert_same(file["samples/id"][:], self.direct["id"][rows])
            np.testing.assert_allclose(file["samples/predicted"][:], cloth[rows], atol=1e-4)
        errors = [float(text) for text in re.findall(r"error +([\d.]+) mm", outcome.stdout)]
        self.assertEqual(len(errors), 3, outcome.stdout)
        self.assertLess(max(errors), 0.1)

    def test_a_missing_file(self) -> None:
        outcome = self.run_example("/nowhere/d.h5", "--out", os.path.join(self.folder, "p.h5"))
        self.assertEqual(outcome.returncode, 1)
        self.assertEqual(outcome.stderr, "ridge: there is no file /nowhere/d.h5\n")


if __name__ == "__main__":
    unittest.main()
