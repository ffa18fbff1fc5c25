"""toile_data on what toile writes: test_real_dataset.py TOILE. Two poses of a coarse T-shirt.

The identities of the format hold in what this module reads: r = r̃ + q·d·q⁻¹, and images read back within the reported error.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

from toile_data import DataError, Dataset, read_image, reconstruct, write_problem

SCENE = """[scene]
name = "small"
[body]
[contact]
[bending]
[poses]
count = 2
[garment]
source = "tshirt"
edge_length = 0.05
[image]
size = 32
[split]
validation = 0.0
test = 0.0
"""
FIELDS = ("id", "pose", "cloth", "embedded", "displacement", "frame", "image", "certificate/seconds")


class RealDataset(unittest.TestCase):
    toile = ""

    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        scene = os.path.join(cls.folder, "scene.toml")
        with open(scene, "w") as stream:
            stream.write(SCENE)
        subprocess.run([cls.toile, "generate", scene, "--out", os.path.join(cls.folder, "out")], check=True)
        cls.path = os.path.join(cls.folder, "out", "dataset.h5")

    def test_identities(self) -> None:
        data = Dataset(self.path, fields=FIELDS)
        samples = data[:]
        self.assertEqual(samples["id"].tolist(), [0, 1])
        found = reconstruct(samples["embedded"], samples["frame"], samples["displacement"])
        np.testing.assert_allclose(found, samples["cloth"], atol=1e-6)
        mesh = data.shared("mesh/triangle"), data.shared("mesh/pattern_triangle")
        read = read_image(samples["image"], data.shared("image/pattern_pixel"), *mesh)
        error = np.linalg.norm(read - samples["displacement"], axis=-1)
        largest, rms = data.attributes["resampling_error"]
        np.testing.assert_allclose([error.max(), np.sqrt((error**2).mean())], [largest, rms], rtol=0.01)
        self.assertGreater(samples["certificate/seconds"].min(), 0)

    def test_every_byte(self) -> None:
        samples = Dataset(self.path, fields=FIELDS)[:]
        with h5py.File(self.path) as file:
            for field, value in samples.items():
                self.assertTrue(np.array_equal(value, file[field if "/" in field else f"samples/{field}"][:]))

    def test_shards_that_were_merged(self) -> None:
        scene, folder = os.path.join(self.folder, "scene.toml"), os.path.join(self.folder, "shards")
        for shard in ("0/2", "1/2"):
            subprocess.run([self.toile, "generate", scene, "--out", folder, "--shard", shard], check=True)
        subprocess.run([self.toile, "merge", folder], check=True)
        whole = Dataset(self.path, fields=FIELDS[:-1])[:]
        merged = Dataset(os.path.join(folder, "dataset.h5"), fields=FIELDS[:-1])
        for field, value in merged[:].items():
            self.assertEqual(value.tobytes(), whole[field].tobytes(), field)
        part = os.path.join(folder, "shard_00001_of_00002", "part_00000.h5")
        os.rename(part, part + ".gone")
        with self.assertRaisesRegex(DataError, "shard_00001_of_00002/part_00000.h5"):
            Dataset(merged.path)

    def test_a_problem_is_solved(self) -> None:
        cloth = Dataset(self.path, fields="cloth")[:]["cloth"]
        problem, projection = (os.path.join(self.folder, name) for name in ("problem.h5", "projection.h5"))
        write_problem(
            problem,
            self.path,
            cloth + np.float32(0.002) * np.random.default_rng(1).normal(size=cloth.shape).astype("f4"),
            cloth,
        )
        command = [self.toile, "project", "quasistatic", problem, "--out", projection, "--gradient"]
        subprocess.run(command, check=True)
        with h5py.File(projection) as file:
            self.assertEqual(file["samples/status"][:].tolist(), [0, 0])


if __name__ == "__main__":
    RealDataset.toile = os.path.abspath(sys.argv.pop(1))
    unittest.main()
