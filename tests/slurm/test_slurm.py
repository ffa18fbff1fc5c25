#!/usr/bin/python3
"""Makes corpora under a real Slurm on loopback, with faults, and compares them with a single run.

    test_slurm.py TOILE_PROGRAM SOURCE_FOLDER [unittest's arguments]

Exit status 77: no Slurm can be started here."""

import filecmp
import glob
import os
import signal
import subprocess
import sys
import traceback
import unittest

import cluster
from cluster import kill, wait_until

SKIPPED = 77
SHARDS = 6


class CorpusUnderSlurm(unittest.TestCase):
    """Each test submits a corpus of its own to the one cluster."""

    slurm = None
    toile = scripts = config = single = ""

    @classmethod
    def setUpClass(cls):
        cls.single = f"{cls.slurm.folder}/single"
        done = subprocess.run([cls.toile, "generate", cls.config, "--out", cls.single, "--jobs", "1"],
                              capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise AssertionError(f"the single run: exit status {done.returncode}\n{done.stderr}")

    def setUp(self):
        self.folder = f"{self.slurm.folder}/{self.id().rsplit('.', 1)[1]}"
        self.slurm.environment["TOILE"] = self.toile
        self.slurm.environment.pop("MERGE", None)

    def tearDown(self):
        self.slurm.run("scancel", "--user=root")
        wait_until("an empty queue", lambda: not self.slurm.run("squeue", "--noheader"))

    def submit(self, *options, merge=""):
        """Answers the two jobs' numbers."""
        self.slurm.environment["MERGE"] = merge
        said = self.slurm.run(f"{self.scripts}/submit", self.config, self.folder, str(SHARDS), *options)
        ids = dict(line.split()[:2] for line in said.splitlines() if line.startswith(("array", "merge")))
        return ids["array"], ids["merge"]

    def log(self, name):
        return cluster.text_of(f"{self.folder}/slurm/{name}.log")

    def shard_log(self, shard):
        return self.log(f"shard_{shard:05d}")

    def main_process(self, shard):
        """The toile that works on a shard; not its workers, which it has forked."""
        found = self.slurm.processes("generate", self.folder, f"--shard {shard}/{SHARDS}")
        found = [one for one in found if "slurm_script" not in cluster.command_line(one)]
        return min(found, key=lambda one: len(ancestors(one)), default=0)

    def halt_at_work(self, shard):
        """Waits until a shard has a sample and lacks one, and brings its main process, whose id it answers, to a halt: what
        then befalls it befalls it in mid-work. Slurm wakes what it ends."""
        part = f"{self.folder}/shard_{shard:05d}_of_{SHARDS:05d}"

        def in_the_middle():
            process = self.main_process(shard)
            if not process or not any(size_of(journal) > 4096 for journal in glob.glob(f"{part}/journal_*")):
                return 0
            kill(process, signal.SIGSTOP)
            self.assertFalse(glob.glob(f"{part}/part_*.h5"), f"shard {shard} is finished: it is too quick for this test")
            return process

        return wait_until(f"shard {shard} at work, its log:\n{self.shard_log(shard)}", in_the_middle)

    def start_and_halt(self, array, shard):
        """The same for a task that was submitted on hold."""
        self.slurm.run("scontrol", "release", f"{array}_{shard}")
        return self.halt_at_work(shard)

    def wait_for_end(self, jobs, state="COMPLETED", seconds=600):
        self.slurm.release_requeued_until_end(jobs, seconds)
        for job in jobs:
            if self.slurm.state(job) != state:
                self.fail(f"job {job} is {self.slurm.state(job)}, not {state}\n{self.all_logs()}")

    def all_logs(self):
        return "\n".join(f"{name}\n{cluster.text_of(name)}"
                         for name in sorted(glob.glob(f"{self.folder}/slurm/*.log")))

    def expect_single_runs_bytes(self):
        """The merged file, virtual as it is, and one file of it."""
        self.expect_equal_contents()
        done = subprocess.run([self.toile, "merge", self.folder, "--copy"], capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        self.assertTrue(filecmp.cmp(f"{self.single}/dataset.h5", f"{self.folder}/dataset.h5", shallow=False),
                        "dataset.h5 differs from the single run's\n" + self.all_logs())

    def expect_equal_contents(self):
        import h5py
        import numpy

        with h5py.File(f"{self.single}/dataset.h5") as expected, h5py.File(f"{self.folder}/dataset.h5") as found:
            names = []
            expected.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
            self.assertIn("samples/cloth", names)
            for name in names:
                if name == "certificate/seconds":
                    continue
                one, other = expected[name][()], found[name][()]
                same = one.shape == other.shape and one.tobytes() == other.tobytes() if one.dtype != object else \
                    numpy.array_equal(one, other)
                self.assertTrue(same, f"{name} differs from the single run's")

    def test_faults(self):
        array, merge = self.submit("--hold")
        process = self.start_and_halt(array, 0)  # a worker dies
        kill(cluster.children(process)[0])
        kill(process, signal.SIGCONT)
        kill(self.start_and_halt(array, 1))  # all of a task's toile dies
        self.start_and_halt(array, 2)
        self.slurm.run("scontrol", "requeue", f"{array}_2")
        for shard in (1, 2):  # an order to end a task that the daemon did not get would reach the task's next start
            self.slurm.wait_for_state(f"{array}_{shard}", "PENDING", "RUNNING")
        process = self.start_and_halt(array, 3)  # a node's daemon dies and comes back
        self.slurm.kill_node_daemon()
        self.slurm.start_node()
        kill(process, signal.SIGCONT)
        self.wait_for_end([f"{array}_3"])  # before the node's power goes, which it would not outlive
        process = self.start_and_halt(array, 4)  # what Slurm does when the time limit is near
        self.slurm.run("scancel", "--batch", "--signal=USR1", f"{array}_4")
        wait_until("the script's signal", lambda: pending(process, signal.SIGTERM))
        kill(process, signal.SIGCONT)
        self.start_and_halt(array, 5)  # the node loses its power
        self.slurm.kill_node()
        self.slurm.wait_for_node("down")
        self.slurm.start_node()
        self.slurm.run("scontrol", "release", merge)

        self.wait_for_end([f"{array}_{shard}" for shard in range(SHARDS)])
        self.wait_for_end([merge])
        for shard, restarts in enumerate((0, 1, 1, 0, 1, 1)):
            self.assertGreaterEqual(int(self.slurm.job(f"{array}_{shard}")["Restarts"]), restarts, f"shard {shard}")
        self.assertIn("exit status 137", self.shard_log(1))
        self.assertEqual(self.shard_log(3).count("start "), 1, "the task was to outlive its node's daemon")
        self.assertIn("back into the queue", self.shard_log(4))
        status = subprocess.run([self.toile, "status", self.folder], capture_output=True, text=True).stdout
        self.assertIn(f"{SHARDS} finished", status)
        self.expect_single_runs_bytes()

    def test_preemption(self):
        array, merge = self.submit("--partition=low", "--hold")
        self.start_and_halt(array, 0)
        self.start_and_halt(array, 1)
        urgent = self.slurm.run("sbatch", "--parsable", "--partition=high", "--ntasks=2", "--output=/dev/null",
                                "--wrap=sleep 1")
        self.slurm.wait_for_state(urgent, "COMPLETED")
        preempted = [shard for shard in range(SHARDS) if int(self.slurm.job(f"{array}_{shard}").get("Restarts", 0)) > 0]
        for job in (array, merge):
            self.slurm.run("scontrol", "release", job)
        self.assertTrue(preempted, "no task made room\n" + self.all_logs())
        self.wait_for_end([f"{array}_{shard}" for shard in range(SHARDS)] + [merge])
        self.expect_single_runs_bytes()

    def test_retry_after_a_failure(self):
        in_the_way = f"{self.folder}/shard_00002_of_{SHARDS:05d}/lock"  # a folder where toile must have a file
        os.makedirs(in_the_way)
        array, merge = self.submit()
        self.wait_for_end([f"{array}_{shard}" for shard in range(SHARDS) if shard != 2])
        self.wait_for_end([f"{array}_2"], state="FAILED")
        self.wait_for_end([merge], state="FAILED")
        self.assertIn("missing          6 samples", self.log("merge"))

        os.rmdir(in_the_way)
        array, merge = self.submit("--array=2")
        self.wait_for_end([f"{array}_2", merge])
        self.expect_single_runs_bytes()

    def test_cancelled_and_submitted_again(self):
        array, merge = self.submit()
        self.halt_at_work(0)
        self.slurm.run("scancel", array, merge)
        self.wait_for_end([f"{array}_0"], state="CANCELLED")
        self.assertNotIn("back into the queue", self.all_logs())
        array, merge = self.submit(merge="--copy")
        self.wait_for_end([f"{array}_{shard}" for shard in range(SHARDS)] + [merge])
        self.expect_single_runs_bytes()

    def test_arrays_that_would_leave_samples_out_are_refused(self):
        for option, complaint in (("--array=1-3", "3 array tasks from 1 to 3 are not 0-2"),
                                  ("--array=0-4:2", "3 array tasks from 0 to 4 are not 0-2")):
            job = self.slurm.run("sbatch", "--parsable", option, f"--output={self.slurm.folder}/refused.log",
                                 "--open-mode=truncate", f"{self.scripts}/corpus.sbatch", self.config, self.folder)
            self.wait_for_end([f"{job}_2"], state="FAILED")
            self.assertIn(complaint, cluster.text_of(f"{self.slurm.folder}/refused.log"))
        self.assertFalse(os.path.exists(self.folder))


def size_of(path):
    try:
        return os.path.getsize(path)
    except OSError:
        return 0


def pending(pid, number):
    """Whether a signal waits for a process that is at a halt."""
    for line in cluster.text_of(f"/proc/{pid}/status").splitlines():
        if line.startswith(("SigPnd", "ShdPnd")) and int(line.split()[1], 16) >> (number - 1) & 1:
            return True
    return False


def ancestors(pid):
    found = []
    while pid > 1:
        try:
            with open(f"/proc/{pid}/stat") as stat:
                pid = int(stat.read().rsplit(")", 1)[1].split()[1])
        except OSError:
            break
        found.append(pid)
    return found


def run_tests(folder, toile, source, arguments):
    try:
        CorpusUnderSlurm.slurm = cluster.Cluster(folder)
    except Exception:
        traceback.print_exc()
        for name in glob.glob(f"{folder}/*.log") + glob.glob(f"{folder}/*.out"):
            print(name, cluster.text_of(name)[-2000:], sep="\n", file=sys.stderr)
        return 1
    CorpusUnderSlurm.toile = os.path.abspath(toile)
    CorpusUnderSlurm.scripts = os.path.abspath(f"{source}/scripts/slurm")
    CorpusUnderSlurm.config = os.path.abspath(f"{source}/tests/slurm/corpus.toml")
    program = unittest.main(module=sys.modules[__name__], argv=["test_slurm.py", "--verbose", *arguments], exit=False)
    return 0 if program.result.wasSuccessful() and program.result.testsRun > 0 else 1


def main():
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    reason = cluster.missing()
    if reason:
        print(f"skipped: {reason}")
        return SKIPPED
    return cluster.in_guarded_folder(lambda folder: run_tests(folder, sys.argv[1], sys.argv[2], sys.argv[3:]))


if __name__ == "__main__":
    sys.exit(main())
