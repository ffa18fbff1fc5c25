"""The inextensibility prior against CVXOPT, which shares no code with it: test_inextensibility_cvxopt.py TOILE.

CVXOPT's coneqp solves the quadratic program with a second-order cone for each edge, as the paper's Section 3 states
it: minimise Σ ½ k_i |r_i − r̂_i|² subject to (l^max_e, r_a − r_b) in Q^4. The problem is convex, so both must give the same r*.
Skipped where CVXOPT is not installed (Debian: python3-cvxopt).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

try:
    import cvxopt
    from cvxopt import solvers
except ImportError:
    print("skipped: CVXOPT is not installed (Debian: python3-cvxopt)")
    sys.exit(77)

ROWS, COLUMNS, EDGE = 5, 6, 0.02
ACCURACY = 1e-9  # metres, on cloth of 10 cm


def grid() -> tuple[np.ndarray, np.ndarray]:
    """A flat grid of triangles: rest positions `[V x 3]`, triangles `[F x 3]`."""
    rest = np.array([[j * EDGE, 0.0, i * EDGE] for i in range(ROWS) for j in range(COLUMNS)])
    triangle = []
    for i in range(ROWS - 1):
        for j in range(COLUMNS - 1):
            a = i * COLUMNS + j
            triangle += [[a, a + COLUMNS, a + 1], [a + 1, a + COLUMNS, a + COLUMNS + 1]]
    return rest, np.array(triangle)


def edges(triangle: np.ndarray) -> np.ndarray:
    pairs = np.concatenate([triangle[:, [0, 1]], triangle[:, [1, 2]], triangle[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def stiffness(rest: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """k_i: vertex mass over mean vertex mass, of cloth of uniform density."""
    a, b, c = (rest[triangle[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    mass = np.zeros(len(rest))
    for k in range(3):
        np.add.at(mass, triangle[:, k], area / 3)
    return mass / mass.mean()


def solve(k: np.ndarray, edge: np.ndarray, max_length: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """r* by CVXOPT, in units of the edge length about the prediction's mean: its tolerances are absolute."""
    middle = predicted.mean(axis=0)
    wanted = (predicted - middle) / EDGE
    count = wanted.size
    weight = np.repeat(k, 3)
    rows, columns, values, h = [], [], [], []
    for e, (a, b) in enumerate(edge):
        h += [max_length[e] / EDGE, 0.0, 0.0, 0.0]
        for c in range(3):  # s = h − G r = (l_max, r_a − r_b)
            rows += [4 * e + 1 + c] * 2
            columns += [3 * int(a) + c, 3 * int(b) + c]
            values += [-1.0, 1.0]
    solvers.options.update(show_progress=False, abstol=1e-12, reltol=1e-12, feastol=1e-12, maxiters=200, refinement=2)
    found = solvers.coneqp(
        cvxopt.spdiag(cvxopt.matrix(weight)),
        cvxopt.matrix(-weight * wanted.ravel()),
        cvxopt.spmatrix(values, rows, columns, (4 * len(edge), count)),
        cvxopt.matrix(h),
        {"l": 0, "q": [4] * len(edge), "s": []},
    )
    gap = found["relative gap"] if found["relative gap"] is not None else found["gap"]
    assert found["x"] is not None and gap < 1e-9, f"CVXOPT came to {found['status']}, relative gap {gap}"
    return np.array(found["x"]).reshape(-1, 3) * EDGE + middle


class AgainstCvxopt(unittest.TestCase):
    toile = ""

    def check(self, method: str, limit: float) -> None:
        rest, triangle = grid()
        edge = edges(triangle)
        max_length = (1 + limit) * np.linalg.norm(rest[edge[:, 0]] - rest[edge[:, 1]], axis=1)
        random = np.random.default_rng(11)
        bend = rest + np.stack([0 * rest[:, 0], 0.02 * np.sin(rest[:, 0] / 0.03), 0 * rest[:, 0]], axis=1)
        predicted = np.stack([bend + noise * random.standard_normal(rest.shape) for noise in (0.001, 0.004, 0.015)])
        with tempfile.TemporaryDirectory() as folder:
            problem, out = os.path.join(folder, "problem.h5"), os.path.join(folder, "out.h5")
            with h5py.File(problem, "w") as file:
                file["/mesh/triangle"] = triangle.astype(np.int32)
                file["/mesh/rest_position"] = rest
                file["/samples/predicted"] = predicted
            keys = [f"method={method}", "tolerance=1e-9", f"stretch_limit={limit}"]
            command = [self.toile, "project", "inextensibility", problem, "--out", out]
            subprocess.run(command + [part for key in keys for part in ("--set", key)], check=True, capture_output=True)
            with h5py.File(out) as file:
                projected, k = file["/samples/projected"][:], file["/model/target_stiffness"][:]
        own = stiffness(rest, triangle)
        np.testing.assert_allclose(k / k.mean(), own / own.mean(), rtol=1e-12)
        for n, r in enumerate(projected):
            reference = solve(own, edge, max_length, predicted[n])
            moved = np.abs(reference - predicted[n]).max()
            self.assertGreater(moved, 1e-4, "a prediction with nothing to project proves nothing")
            self.assertLess(np.abs(r - reference).max(), ACCURACY, f"sample {n}, moved by up to {moved:.3g} m")

    def test_interior_point(self) -> None:
        self.check("interior_point", 0.0)

    def test_cone(self) -> None:
        self.check("cone", 0.0)

    def test_some_stretch(self) -> None:
        self.check("interior_point", 0.05)


if __name__ == "__main__":
    AgainstCvxopt.toile = os.path.abspath(sys.argv.pop(1))
    unittest.main()
