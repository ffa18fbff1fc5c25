"""What toile evaluate says, recomputed with numpy and h5py alone: test_evaluation.py TOILE. Eight poses of a coarse T-shirt.

From the data set, a predictions file written here, and what `toile evaluate accuracy` leaves. Nothing of toile's code is used; the
formulas are those of the paper and of the contract, written a second time.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

SCENE = """[scene]
name = "small"
[body]
[contact]
[bending]
[poses]
count = 8
[garment]
source = "tshirt"
edge_length = 0.05
[image]
size = 32
[split]
validation = 0.25
test = 0.25
"""
SPLITS = ("train", "validation", "test")
STRETCH_MODULUS = 400.0  # N/m, of the quasistatic prior
OVERSTRETCHED = 0.05  # beyond rest length
LIMIT_SLACK = 1e-5  # that edges are let pass beyond a limit


def triangle_edges(triangle: np.ndarray) -> np.ndarray:
    """(F,3,2): the edge opposite each corner."""
    return np.stack([triangle[:, [1, 2]], triangle[:, [2, 0]], triangle[:, [0, 1]]], axis=1)


class Cloth:
    """A mesh with its rest state."""

    def __init__(self, file: h5py.File) -> None:
        self.triangle = file["mesh/triangle"][:]
        corners, plane = file["mesh/pattern_triangle"][:], file["mesh/pattern_position"][:]
        ends = triangle_edges(corners)
        length = np.linalg.norm(plane[ends[..., 0]] - plane[ends[..., 1]], axis=-1)
        sides = np.sort(triangle_edges(self.triangle), axis=-1).reshape(-1, 2)
        self.edge, index, self.triangles_at = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        self.rest_length = np.bincount(index.ravel(), length.ravel()) / self.triangles_at
        self.stiffness = np.sqrt(0.75) * STRETCH_MODULUS * np.where(self.triangles_at > 1, 1.0, 0.5)
        rest = plane[corners]
        self.rest_edges = np.stack([rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]], axis=-1)  # (F,2,2), columns
        self.rest_area = 0.5 * np.abs(np.linalg.det(self.rest_edges))

    def length(self, position: np.ndarray) -> np.ndarray:
        return np.linalg.norm(position[self.edge[:, 0]] - position[self.edge[:, 1]], axis=-1)

    def energies(self, position: np.ndarray) -> tuple[float, float]:
        """Of the edges longer than at rest, and of the shorter ones [J]."""
        extension = self.length(position) - self.rest_length
        energy = 0.5 * self.stiffness * extension**2
        return energy[extension > 0].sum(), energy[extension <= 0].sum()

    def normals(self, position: np.ndarray) -> np.ndarray:
        corner = position[self.triangle]
        cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        normal = np.zeros_like(position)
        for k in range(3):
            np.add.at(normal, self.triangle[:, k], cross)
        return normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    def principal_stretches(self, position: np.ndarray) -> np.ndarray:
        """(F,2), the larger first: singular values of F, which takes the rest edges to today's."""
        corner = position[self.triangle]
        now = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=-1)
        return np.linalg.svd(now @ np.linalg.inv(self.rest_edges), compute_uv=False)

    def vertex_strain(self, position: np.ndarray) -> np.ndarray:
        strain = self.principal_stretches(position)[:, 0] - 1.0
        total, weight = np.zeros(len(position)), np.zeros(len(position))
        for k in range(3):
            np.add.at(total, self.triangle[:, k], self.rest_area * strain)
            np.add.at(weight, self.triangle[:, k], self.rest_area)
        return total / weight

    def vertex_stretch(self, position: np.ndarray) -> np.ndarray:
        """Length over rest length of the edge at each vertex that is furthest from 1."""
        ratio = self.length(position) / self.rest_length
        far = np.zeros(len(position))
        np.maximum.at(far, self.edge.ravel(), np.repeat(np.abs(ratio - 1), 2))
        return far

    def judge(self, position: np.ndarray, target: np.ndarray) -> dict[str, float]:
        distance = np.linalg.norm(position - target, axis=-1)
        (stretching, compression), truth = self.energies(position), self.energies(target)
        cosine = np.einsum("vk,vk->v", self.normals(position), self.normals(target))
        ratio = self.length(position) / self.rest_length
        return {
            "sqrt_mse": 1e3 * np.sqrt((distance**2).mean()),
            "max_dist": 1e3 * distance.max(),
            "stretching_energy": stretching,
            "compression_energy": compression,
            "stretching_energy_error": abs(stretching - truth[0]),
            "compression_energy_error": abs(compression - truth[1]),
            "normal_error": np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean(),
            "overstretched_share": 100 * (ratio > (1 + OVERSTRETCHED) * (1 + LIMIT_SLACK)).mean(),
            "largest_stretch": ratio.max(),
        }


def together(quantity: str, value: np.ndarray) -> float:
    return np.sqrt((value**2).mean()) if quantity == "sqrt_mse" else value.mean()


class Evaluation(unittest.TestCase):
    toile = ""

    @classmethod
    def run_toile(cls, *arguments: str) -> None:
        subprocess.run([cls.toile, *arguments], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        scene, out = os.path.join(folder.name, "scene.toml"), os.path.join(folder.name, "out")
        dataset, predictions = os.path.join(out, "dataset.h5"), os.path.join(folder.name, "noisy.h5")
        with open(scene, "w") as stream:
            stream.write(SCENE)
        cls.run_toile("generate", scene, "--out", out)
        with h5py.File(dataset) as file:
            cls.cloth = Cloth(file)
            accepted = file["samples/status"][:] == 0
            cls.id = file["samples/id"][:][accepted]
            cls.split = file["samples/split"][:][accepted]
            cls.target = file["samples/cloth"][:][accepted].astype(float)
            mesh = {name: file[f"mesh/{name}"][:] for name in file["mesh"]}
        random = np.random.default_rng(7)
        noisy = (cls.target + random.normal(0, 0.004, cls.target.shape)).astype(np.float32)
        cls.predicted = noisy.astype(float)
        with h5py.File(predictions, "w") as file:
            order = random.permutation(len(cls.id))  # a network's loader may shuffle
            file["samples/id"] = cls.id[order]
            file["samples/predicted"] = noisy[order]
        cls.folder = os.path.join(folder.name, "evaluated")
        cls.run_toile("evaluate", "accuracy", "--dataset", dataset, "--predictions", predictions, "--limit", "0", "--mu", "0.1",
                      "--learn-mu", "global", "--out", cls.folder)  # fmt: skip
        cls.projected = {"predicted": cls.predicted}
        problem = os.path.join(folder.name, "problem.h5")
        with h5py.File(problem, "w") as file:
            for name, value in mesh.items():
                file[f"mesh/{name}"] = value
            file["samples/predicted"] = cls.predicted
        for method, prior in (("inextensibility@limit=0", "inextensibility"), ("quasistatic@mu=0.1", "quasistatic")):
            result = os.path.join(folder.name, prior + ".h5")
            cls.run_toile("project", prior, problem, "--out", result, "--jobs", "2")
            with h5py.File(result) as file:
                cls.projected[method] = file["samples/projected"][:]
        cls.figures = h5py.File(os.path.join(cls.folder, "accuracy.h5"))
        cls.addClassCleanup(cls.figures.close)
        with open(os.path.join(cls.folder, "accuracy.json")) as stream:
            cls.results = json.load(stream)
        names = [name for name in cls.figures["figures"] if name not in ("id", "split", "target")]
        assert len(names) == 1, names
        cls.predictor = names[0]
        cls.row = {int(number): k for k, number in enumerate(cls.id)}

    def same(self, found: float, expected: float, relative: float, absolute: float, what: str) -> None:
        self.assertLessEqual(abs(found - expected), absolute + relative * abs(expected), f"{what}: {found}, not {expected}")

    def test_figures_of_every_sample(self) -> None:
        """A prediction's own figures to rounding; after a prior within what its tolerance (1e-6) and that of the start allow."""
        figures = self.figures["figures"]
        self.assertEqual(sorted(figures["id"][:].tolist()), sorted(self.id.tolist()))
        for method, position in self.projected.items():
            relative, absolute = (1e-9, 1e-9) if method == "predicted" else (2e-3, 2e-3)
            for k, number in enumerate(figures["id"][:]):
                row = self.row[int(number)]
                self.assertEqual(figures["split"][k], self.split[row])
                for quantity, value in self.cloth.judge(position[row], self.target[row]).items():
                    found = figures[f"{self.predictor}/{method}/{quantity}"][k]
                    slack = absolute * (100 if quantity == "overstretched_share" and method != "predicted" else 1)
                    self.same(found, value, relative, slack, f"{method}, {quantity} of sample {number}")

    def test_figures_of_the_truth(self) -> None:
        group = self.figures["figures/target/target"]
        for k, number in enumerate(self.figures["figures/id"][:]):
            row = self.row[int(number)]
            for quantity, value in self.cloth.judge(self.target[row], self.target[row]).items():
                slack = 1e-5 if quantity == "normal_error" else 1e-9  # the arc cosine here, at 1
                self.same(group[quantity][k], value, 1e-9, slack, f"target, {quantity} of sample {number}")

    def test_tables(self) -> None:
        """Each split's numbers are those of its samples, and lie in their intervals."""
        metric = {one["metric"]: one for one in self.results["metric"]}
        figures, seen = self.figures["figures"], 0
        for name, one in metric.items():
            parts = name.split("/")
            if len(parts) != 5 or parts[1] not in (self.predictor, "target") or one["value"] is None:
                continue
            _, predictor, split, method, quantity = parts
            rows = figures["split"][:] == SPLITS.index(split)
            value = figures[f"{predictor}/{method}/{quantity}"][:][rows]
            self.assertEqual(one["samples"], rows.sum(), name)
            self.same(one["value"], together(quantity, value), 1e-9, 1e-12, name)
            low, high = one["interval"]
            slack = 1e-9 * abs(one["value"]) + 1e-12
            self.assertTrue(low - slack <= one["value"] <= high + slack, f"{name}: {one['value']} in {low} to {high}")
            seen += 1
        self.assertGreaterEqual(seen, 3 * len(self.projected) * 9)

    def test_cloth_that_is_shown(self) -> None:
        """Fields over the vertices, from the positions beside them: stored in single precision, so to 1e-4."""
        shown = self.figures["shown"]
        views = [name for name in shown if isinstance(shown[name], h5py.Group)]
        self.assertTrue({"target", "predicted", "inextensibility", "quasistatic"} <= set(views), views)
        for view in views:
            for k, number in enumerate(shown["id"][:]):
                position = shown[f"{view}/position"][k].astype(float)
                target = self.target[self.row[int(number)]]
                distance = np.linalg.norm(position - target, axis=-1)
                np.testing.assert_allclose(shown[f"{view}/distance"][k], distance, atol=1e-6)
                np.testing.assert_allclose(shown[f"{view}/strain"][k], self.cloth.vertex_strain(position), atol=1e-4)
                far = np.abs(shown[f"{view}/stretch"][k] - 1)
                np.testing.assert_allclose(far, self.cloth.vertex_stretch(position), atol=1e-4)
        for k, number in enumerate(shown["id"][:]):
            row = self.row[int(number)]
            np.testing.assert_allclose(shown["predicted/position"][k], self.predicted[row], atol=1e-6)
            np.testing.assert_allclose(shown["target/position"][k], self.target[row], atol=1e-7)

    def test_learned_mu_is_better_than_its_neighbours(self) -> None:
        """On the train split, the error at the μ that was learned is no more than at 0.1."""
        rows = self.figures["figures/split"][:] == 0
        error = {
            method: together("sqrt_mse", self.figures[f"figures/{self.predictor}/{method}/sqrt_mse"][:][rows])
            for method in ("quasistatic@mu=0.1", "quasistatic@mu=best", "predicted")
        }
        self.assertLessEqual(error["quasistatic@mu=best"], 1.02 * error["quasistatic@mu=0.1"])
        self.assertLess(error["quasistatic@mu=best"], error["predicted"])
        self.assertTrue(1e-4 <= self.figures["mu/global"][()] <= 1e3)


if __name__ == "__main__":
    Evaluation.toile = os.path.abspath(sys.argv.pop(1))
    unittest.main()
