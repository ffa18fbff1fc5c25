"""Displacements, images, poses and output files of toile_data."""

from __future__ import annotations

import os
import subprocess
import sys
import unittest

import h5py
import numpy as np
from dataset_fixture import VERTICES, DatasetCase

from toile_data import (
    DataError,
    pose_features,
    read_image,
    reconstruct,
    rotation_matrices,
    write_predictions,
    write_problem,
)

QUARTER = np.pi / 2


class Geometry(unittest.TestCase):
    def test_rotation_matrices(self) -> None:
        np.testing.assert_allclose(rotation_matrices([0, 0, QUARTER]), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
        np.testing.assert_allclose(rotation_matrices([0, QUARTER, 0]), [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-15)
        np.testing.assert_allclose(rotation_matrices([QUARTER, 0, 0]), [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-15)
        self.assertTrue(
            np.array_equal(rotation_matrices(np.zeros((2, 5, 3))), np.broadcast_to(np.eye(3), (2, 5, 3, 3)))
        )
        pose = np.random.default_rng(1).normal(size=(4, 7, 3)) * [[[1e-9], [1e-4], [0.1], [1], [2], [3], [6]]]
        matrix = rotation_matrices(pose)
        np.testing.assert_allclose(
            matrix @ np.swapaxes(matrix, -1, -2), np.broadcast_to(np.eye(3), matrix.shape), atol=1e-14
        )
        np.testing.assert_allclose(np.einsum("...ij,...j", matrix, pose), pose, atol=1e-14)  # the axis stays
        angle = np.linalg.norm(pose, axis=-1)
        np.testing.assert_allclose(np.trace(matrix, axis1=-2, axis2=-1), 1 + 2 * np.cos(angle), atol=1e-14)
        # twice half the angle is the angle: the sense of turning holds too
        half = rotation_matrices(pose / 2)
        np.testing.assert_allclose(half @ half, matrix, atol=1e-14)

    def test_pose_features(self) -> None:
        pose = np.random.default_rng(1).normal(size=(6, 4, 3))
        features = pose_features(pose)
        self.assertEqual((features.shape, features.dtype), ((6, 36), np.float32))
        np.testing.assert_array_equal(pose_features(pose, [2, 0])[:, 9:], features[:, :9])
        self.assertFalse(pose_features(np.zeros((4, 3))).any())

    def test_reconstruct(self) -> None:
        random = np.random.default_rng(1)
        embedded, displacement = random.normal(size=(2, 3, 9, 3))
        turn = random.normal(size=(3, 9, 3))
        angle = np.linalg.norm(turn, axis=-1, keepdims=True)
        frame = np.concatenate([np.cos(angle / 2), np.sin(angle / 2) * turn / angle], axis=-1)
        expected = embedded + np.einsum("...ij,...j", rotation_matrices(turn), displacement)
        np.testing.assert_allclose(reconstruct(embedded, frame, displacement), expected, atol=1e-14)
        floats = [value.astype("f4") for value in (embedded, frame, displacement)]
        self.assertEqual(reconstruct(*floats).dtype, np.float32)

    def test_read_image_of_a_linear_function_with_a_seam(self) -> None:
        # two panels of one triangle each; cloth vertex 1 is pattern position 1 of layer 0 and 4 of layer 1
        triangle = np.array([[0, 1, 2], [3, 1, 0]])
        pattern_triangle = np.array([[0, 1, 2], [3, 4, 5]])
        pixel = np.array([[0, 2.25, 3.5], [0, 6, 1], [0, 0, 7], [1, 7, 7], [1, 3.125, 2], [1, 0.5, 0.75]])
        row, column = np.mgrid[0:8, 0:8]
        slope = np.random.default_rng(1).normal(size=(5, 6, 3))
        image = np.einsum("ncj,jhw->nchw", slope, np.stack([np.ones((8, 8)), column, row]))

        def at(position: int) -> np.ndarray:
            layer, x, y = pixel[position]
            return np.einsum("ncj,j->nc", slope, [1, x, y])[:, 3 * int(layer) :][:, :3]

        expected = np.stack([(at(0) + at(5)) / 2, (at(1) + at(4)) / 2, at(2), at(3)], axis=1)
        np.testing.assert_allclose(read_image(image, pixel, triangle, pattern_triangle), expected, atol=1e-13)
        np.testing.assert_allclose(read_image(image[2], pixel, triangle, pattern_triangle), expected[2], atol=1e-13)
        with self.assertRaisesRegex(DataError, "layers"):
            read_image(image[:, :3], pixel, triangle, pattern_triangle)

    def test_read_image_is_bilinear_between_pixels(self) -> None:
        image = np.zeros((3, 4, 4))
        image[1, 1:3, 1:3] = [[1, 10], [100, 1000]]
        found = read_image(image, np.array([[0, 1.25, 1.5]]), np.zeros((1, 3), int), np.zeros((1, 3), int))
        np.testing.assert_allclose(found, [[0, 0.5 * (0.75 + 2.5) + 0.5 * (75 + 250), 0]], atol=1e-12)


class Output(DatasetCase):
    def test_predictions(self) -> None:
        path = os.path.join(self.folder, "predictions.h5")
        predicted = np.random.default_rng(1).normal(size=(3, VERTICES, 3)).astype("f4")
        write_predictions(path, [40, 1, 7], predicted)
        with h5py.File(path) as file:
            self.assert_same(file["samples/id"][:], np.array([40, 1, 7]))
            self.assert_same(file["samples/predicted"][:], predicted)
        for message, ids, value in (
            ("2 ids do not go with 3", [1, 2], predicted),
            ("pose 7 is predicted twice", [7, 1, 7], predicted),
            ("ids are pose numbers", [0.5, 1, 2], predicted),
            ("not .N, V, 3.", [1, 2, 3], predicted[..., :2]),
            ("of int64", [1, 2, 3], np.zeros((3, 4, 3), int)),
        ):
            with self.assertRaisesRegex(DataError, message):
                write_predictions(path, ids, value)
        self.assertRaises(OSError, write_predictions, "/nowhere/p.h5", [40, 1, 7], predicted)
        with h5py.File(path) as file:
            self.assertEqual(len(file["samples/id"]), 3)
        self.assertFalse(os.path.exists(path + ".partial"))

    def test_problem(self) -> None:
        path = os.path.join(self.folder, "problem.h5")
        predicted, target = np.random.default_rng(1).normal(size=(2, 3, VERTICES, 3))
        write_problem(path, self.merged, predicted, target)
        with h5py.File(path) as file, h5py.File(self.merged) as dataset:
            for name in dataset["mesh"]:
                self.assert_same(file["mesh"][name][()], dataset["mesh"][name][()])
            self.assert_same(file["samples/predicted"][:], predicted)
            self.assert_same(file["samples/target"][:], target)
        write_problem(path, self.merged, predicted)
        with h5py.File(path) as file:
            self.assertNotIn("samples/target", file)
        for message, arguments in (
            ("39 vertices, the mesh 40", (self.merged, predicted[:, 1:])),
            ("target has shape", (self.merged, predicted, target[1:])),
            ("no file", ("/nowhere/d.h5", predicted)),
            ("has no mesh", (path, predicted)),
        ):
            if message == "has no mesh":
                with h5py.File(path, "r+") as file:
                    del file["mesh"]
            with self.assertRaisesRegex(DataError, message):
                write_problem(os.path.join(self.folder, "other.h5"), *arguments)

    def test_without_pytorch(self) -> None:
        program = (
            "import sys; sys.modules['torch'] = None\n"
            "import toile_data\n"
            f"print(len(toile_data.Dataset({self.whole!r})))\n"
            "toile_data.TorchDataset"
        )
        outcome = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertEqual(int(outcome.stdout), len(self.expected()))
        self.assertIn("TorchDataset needs PyTorch (Debian: python3-torch)", outcome.stderr)


if __name__ == "__main__":
    unittest.main()
