#!/usr/bin/python3
"""The repository's own gate: a small scene generated, predicted and evaluated, next to the committed baseline; and that
it trips where results are worse or slower.

    test_gate.py TOILE_PROGRAM SOURCE_FOLDER [unittest's arguments]
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest


class Gate(unittest.TestCase):
    toile = source = ""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="toile_gate_")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.baseline = f"{cls.source}/bench/baseline_evaluation.json"
        cls.run_once = subprocess.run([f"{cls.source}/scripts/gate", cls.toile, f"{cls.folder}/run", cls.baseline],
                                      capture_output=True, text=True)

    def report(self, results, baseline):
        return subprocess.run([self.toile, "report", results, "--baseline", baseline, "--gate"], capture_output=True,
                              text=True)

    def copy(self, name):
        """A copy of the results, to be changed."""
        target = f"{self.folder}/{name}"
        shutil.copytree(f"{self.folder}/run/evaluation", target)
        return target

    def own_baseline(self):
        """The run's own results: what a change is told by, whatever machine this is."""
        target = f"{self.folder}/own.json"
        shutil.copy(f"{self.folder}/run/evaluation/results.json", target)
        return target

    def change(self, folder, kind, wanted, factor):
        """Multiplies the first metric that is `wanted`; returns its name."""
        path = f"{folder}/{kind}.json"
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
        for metric in document["metric"]:
            if wanted(metric):
                metric["value"] *= factor
                metric["interval"] = [factor * end for end in metric["interval"]]
                with open(path, "w", encoding="utf-8") as file:
                    json.dump(document, file)
                return metric["metric"]
        self.fail(f"no metric of {kind} to change")

    def test_this_build_is_no_worse_than_the_baseline(self):
        self.assertEqual(self.run_once.returncode, 0, self.run_once.stdout + self.run_once.stderr)
        with open(self.baseline, encoding="utf-8") as file:
            judged = [one for one in json.load(file)["metric"] if one["direction"] != "none"]
        for kind in ("accuracy/", "runtime/", "stability/"):
            self.assertTrue(any(one["metric"].startswith(kind) for one in judged), f"nothing of {kind} is judged")

    def test_unchanged_results_do_not_trip_it(self):
        done = self.report(self.copy("unchanged"), self.own_baseline())
        self.assertEqual(done.returncode, 0, done.stderr)

    def trips(self, kind, wanted, factor):
        folder = self.copy(f"{self.id().rsplit('.', 1)[1]}")
        baseline = self.own_baseline()
        name = self.change(folder, kind, wanted, factor)
        done = self.report(folder, baseline)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertIn(name, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_a_worse_error_trips_it(self):
        self.trips("accuracy", lambda one: one["direction"] == "lower" and one["metric"].endswith("/sqrt_mse")
                   and one["metric"].count("/") > 2 and one["value"] > 0, 4.0)

    def test_a_doubled_ratio_of_times_trips_it(self):
        self.trips("runtime", lambda one: one["direction"] == "lower" and one["unit"] == "ratio" and one["value"] > 0,
                   4.0)

    def test_a_case_that_no_longer_passes_trips_it(self):
        self.trips("stability", lambda one: one["metric"].endswith("/passed_share") and one["value"] > 0, 0.9)

    def test_a_metric_that_is_missing_trips_it(self):
        folder = self.copy("missing")
        baseline = self.own_baseline()
        os.remove(f"{folder}/runtime.json")
        done = self.report(folder, baseline)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertIn("runtime/", done.stderr)


if __name__ == "__main__":
    Gate.toile, Gate.source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
