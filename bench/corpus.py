#!/usr/bin/python3
"""Measures the making of a corpus: rate by workers, peak memory by samples, and whether one process, two workers, shards and a
Slurm array with faults make the same data set. Prints a table in Markdown.

    bench/corpus.py TOILE_PROGRAM FOLDER [--samples 2000] [--only rate,memory,same,slurm]

FOLDER is filled and left behind. The garment is the small one of bench/corpus.toml; the Slurm array needs root."""

import argparse
import functools
import os
import subprocess
import sys
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "tests", "slurm"))
import cluster  # noqa: E402

SCENE = os.path.join(HERE, "corpus.toml")
SHARDS = 16


class Memory(threading.Thread):
    """Largest resident set of a process and of the largest of its workers [MB], looked at ten times a second."""

    def __init__(self, pid):
        super().__init__(daemon=True)
        self.pid, self.parent, self.worker = pid, 0.0, 0.0

    def run(self):
        while True:
            peak = peak_megabytes(self.pid)
            if not peak:
                return
            self.parent = max(self.parent, peak)
            self.worker = max([self.worker] + [peak_megabytes(child) for child in cluster.children(self.pid)])
            time.sleep(0.1)


def peak_megabytes(pid):
    for line in cluster.text_of(f"/proc/{pid}/status").splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    return 0.0


@functools.cache
def generate(toile, folder, *options):
    """Runs it to its end, once; answers seconds, the parent's and a worker's peak memory."""
    start = time.monotonic()
    run = subprocess.Popen([toile, "generate", SCENE, "--out", folder, *options], stderr=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL)
    memory = Memory(run.pid)
    memory.start()
    status = run.wait()
    if status not in (0, 3):
        raise RuntimeError(f"toile generate {' '.join(options)}: exit status {status}")
    return time.monotonic() - start, memory


def merge(toile, folder, *options):
    start = time.monotonic()
    done = subprocess.run([toile, "merge", folder, *options], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise RuntimeError(f"toile merge: exit status {done.returncode}\n{done.stderr}")
    return time.monotonic() - start


def digests(folder):
    import h5py

    with h5py.File(f"{folder}/dataset.h5") as dataset:
        return dataset["samples/id"][:].tobytes(), dataset["samples/digest"][:].tobytes(), dataset["samples/id"].shape[0]


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def measure_rate(toile, folder, samples):
    """Start-up is taken out: the seconds of so many samples less those of one."""
    row("workers", f"seconds for {samples} samples", "samples a second")
    row("---", "---", "---")
    for jobs in (1, 2):
        first, _ = generate(toile, f"{folder}/rate_{jobs}_start", "--jobs", str(jobs), "--set", "poses.number=[0]")
        whole, _ = generate(toile, f"{folder}/rate_{jobs}", "--jobs", str(jobs), "--set", f"poses.count={samples}")
        row(jobs, f"{whole:.1f}", f"{(samples - 1) / (whole - first):.2f}")


def measure_memory(toile, folder, samples):
    row("samples", "parent [MB]", "worker [MB]")
    row("---", "---", "---")
    for count in (100, samples):
        _, memory = generate(toile, f"{folder}/single_{count}", "--jobs", "1", "--set", f"poses.count={count}")
        row(count, f"{memory.parent:.1f}", f"{memory.worker:.1f}")


def make_in_shards(toile, folder, count):
    start = time.monotonic()
    for shard in range(SHARDS):
        generate(toile, folder, "--jobs", "1", "--shard", f"{shard}/{SHARDS}", *count)
    return time.monotonic() - start


def make_under_slurm(toile, folder, count):
    """An array of which a worker, a task's toile, a node's daemon and a node are killed, and a task is requeued."""
    scene = f"{folder}_scene.toml"
    with open(scene, "w") as file:
        file.write(subprocess.run([toile, "config", SCENE, *count], check=True, capture_output=True, text=True).stdout)
    start = time.monotonic()

    def work(own):
        slurm = cluster.Cluster(own)
        slurm.environment["TOILE"] = toile
        said = slurm.run(os.path.join(HERE, "..", "scripts", "slurm", "submit"), scene, folder, str(SHARDS))
        array, joined = (line.split()[1] for line in said.splitlines()[:2])
        tasks = [f"{array}_{shard}" for shard in range(SHARDS)]

        def main_process(shard):
            found = slurm.processes("generate", folder, f"--shard {shard}/{SHARDS}")
            return min(found, default=0)

        def at_work(shard):
            part = f"{folder}/shard_{shard:05d}_of_{SHARDS:05d}/progress.json"
            cluster.wait_until(f"shard {shard} at work", lambda: '"done":' in cluster.text_of(part)
                               and '"done":0,' not in cluster.text_of(part) and main_process(shard), 1800)
            return main_process(shard)

        cluster.kill(cluster.children(at_work(0))[0])
        cluster.kill(at_work(1))
        at_work(2)
        slurm.run("scontrol", "requeue", f"{array}_2")
        for task in tasks[1:3]:  # an order to end a task that the daemon did not get would reach the task's next start
            slurm.wait_for_state(task, "PENDING", "RUNNING")
        at_work(4)
        slurm.kill_node_daemon()
        slurm.start_node()
        at_work(6)
        slurm.kill_node()
        slurm.wait_for_node("down")
        slurm.start_node()
        slurm.release_requeued_until_end([*tasks, joined], 3600)
        restarts = sum(int(slurm.job(task)["Restarts"]) for task in tasks)
        print(f"Slurm: {restarts} restarts of {SHARDS} tasks", file=sys.stderr)
        return 0

    if cluster.in_guarded_folder(work) != 0:
        raise RuntimeError("the Slurm array did not end well")
    return time.monotonic() - start


def measure_same(toile, folder, samples, with_slurm):
    count = ("--set", f"poses.count={samples}")
    row("made by", "seconds", "samples", "digests")
    row("---", "---", "---", "---")
    seconds, _ = generate(toile, f"{folder}/single_{samples}", "--jobs", "1", *count)
    expected = digests(f"{folder}/single_{samples}")
    row("one process", f"{seconds:.0f}", expected[2], "")

    def compare(name, made_by, seconds):
        found = digests(f"{folder}/{name}")
        row(made_by, f"{seconds:.0f}", found[2], "same" if found == expected else "DIFFERENT")
        return found == expected

    seconds, _ = generate(toile, f"{folder}/two", "--jobs", "2", *count)
    same = compare("two", "2 workers", seconds)
    seconds = make_in_shards(toile, f"{folder}/shards", count)
    seconds += merge(toile, f"{folder}/shards")
    same &= compare("shards", f"{SHARDS} shards, merged", seconds)
    if with_slurm:
        seconds = make_under_slurm(toile, f"{folder}/slurm", count)
        same &= compare("slurm", f"Slurm array of {SHARDS}, with faults, merged", seconds)
    return same


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("toile")
    parser.add_argument("folder")
    parser.add_argument("--samples", type=int, default=2000)
    parser.add_argument("--only", default="rate,memory,same,slurm")
    arguments = parser.parse_args()
    toile, folder, wanted = os.path.abspath(arguments.toile), os.path.abspath(arguments.folder), arguments.only.split(",")
    os.makedirs(folder)
    if "rate" in wanted:
        measure_rate(toile, folder, max(2, arguments.samples // 10))
    if "memory" in wanted:
        measure_memory(toile, folder, arguments.samples)
    if "same" in wanted or "slurm" in wanted:
        return 0 if measure_same(toile, folder, arguments.samples, "slurm" in wanted) else 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
