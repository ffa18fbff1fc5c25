"""toile_data.Dataset against plain h5py."""

from __future__ import annotations

import errno
import os
import pickle
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
import unittest.mock

import h5py
import numpy as np
from dataset_fixture import FIELDS, JOINTS, SAMPLES, VERTICES, DatasetCase, sample_values, write_merged, write_part

from toile_data import DataError, Dataset


class Reading(DatasetCase):
    def test_every_byte_of_every_field(self) -> None:
        for path in (self.whole, self.merged):
            for split, number in (("train", 0), ("validation", 1), ("test", 2), ("all", None)):
                for status in ("accepted", "all"):
                    data = Dataset(path, split, FIELDS, status)
                    rows = self.expected(number, status == "accepted")
                    self.assertEqual(len(data), len(rows))
                    self.assert_same(data.ids, self.direct["id"][rows])
                    whole = data[:]
                    for field in FIELDS:
                        self.assert_same(whole[field], self.direct[field][rows])
                        for i in (0, len(rows) - 1, -1):
                            self.assert_same(data[i][field], self.direct[field][rows[i]])

    def test_indices(self) -> None:
        rows = self.expected()
        cloth = self.direct["cloth"][rows]
        for preload in (False, True):
            data = Dataset(self.merged, fields="cloth", preload=preload)
            mask = np.arange(len(data)) % 3 == 0
            for index in (np.s_[2:9], np.s_[::-2], np.s_[5:5], [4, 1, 1, -1], np.array([3, 0]), mask):
                self.assert_same(data[index]["cloth"], cloth[np.arange(len(cloth))[index]])
            self.assert_same(data[[]]["cloth"], cloth[:0])
            self.assertEqual([len(data), sum(1 for _ in data)], [len(rows)] * 2)
            for index in (len(data), -len(data) - 1, [len(data)]):
                self.assertRaises(IndexError, lambda i=index: data[i])
            for index in ("cloth", 1.5, [0.5]):
                self.assertRaises(TypeError, lambda i=index: data[i])

    def test_pose_numbers(self) -> None:
        data = Dataset(self.whole, fields=("id",))
        self.assertEqual(data[data.index_of([31, 7])]["id"].tolist(), [31, 7])
        with self.assertRaisesRegex(DataError, "no pose 8, 1000 among its accepted samples of split train"):
            data.index_of([7, 8, 1000])

    def test_what_samples_share(self) -> None:
        data = Dataset(self.whole)
        self.assertEqual(data.shared("mesh/triangle").tolist(), [[0, 1, 2], [2, 1, 3]])
        self.assertEqual(data.attributes["reasons"][2], "penetrates_body")
        self.assertEqual((data.shape("pose"), data.shape("cloth")), ((JOINTS, 3), (VERTICES, 3)))
        with self.assertRaisesRegex(DataError, "no dataset mesh/mass"):
            data.shared("mesh/mass")

    def test_columns_may_be_virtual(self) -> None:
        parts = [os.path.join(self.folder, f"shard_{k}", "part_00000.h5") for k in range(3)]
        path = os.path.join(self.folder, "all_virtual.h5")
        write_merged(path, parts, columns_virtual=True)
        data = Dataset(path, fields=FIELDS)
        for field, value in data[:].items():
            self.assert_same(value, self.direct[field][self.expected()])

    def test_a_part_in_pieces(self) -> None:
        """As merge refers to a part of which samples in the middle were made again elsewhere."""
        path = os.path.join(self.folder, "pieces.h5")
        shutil.copy(self.merged, path)
        for name, picked in (("again", [10, 11]), ("rest", list(range(20, SAMPLES)))):
            with h5py.File(os.path.join(self.folder, f"{name}.h5"), "w") as file:
                file["samples/cloth"] = self.direct["cloth"][picked]
        runs = (("shard_0/part_00000.h5", 0, 10), ("again.h5", 0, 2), ("shard_0/part_00000.h5", 12, 8),
                ("rest.h5", 0, SAMPLES - 20))  # fmt: skip
        layout, row = h5py.VirtualLayout((SAMPLES, VERTICES, 3), "f4"), 0
        for part, first, count in runs:
            source = h5py.VirtualSource(part, "samples/cloth", (first + count, VERTICES, 3))
            layout[row : row + count] = source[first : first + count]
            row += count
        with h5py.File(path, "r+") as file:
            del file["samples/cloth"]
            file.create_virtual_dataset("samples/cloth", layout, fillvalue=np.nan)
        data = Dataset(path, "all", ("cloth",), "all")
        self.assert_same(data[:]["cloth"], self.direct["cloth"])
        self.assert_same(data[13]["cloth"], self.direct["cloth"][13])

    def test_a_relative_path_holds_when_the_folder_changes(self) -> None:
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        for path in ("whole.h5", "merged.h5"):
            os.chdir(self.folder)
            data = Dataset(path, fields=("cloth",))
            os.chdir("/")
            self.assert_same(data[:]["cloth"], self.direct["cloth"][self.expected()])

    def test_a_link_to_a_merged_file(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            link = os.path.join(folder, "link.h5")
            os.symlink(self.merged, link)
            self.assert_same(Dataset(link, fields=("cloth",))[:]["cloth"], self.direct["cloth"][self.expected()])

    def test_more_parts_than_files_may_be_open(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            parts = [os.path.join(folder, f"part_{k:05}.h5") for k in range(150)]
            for k, part in enumerate(parts):
                write_part(part, k, 1)
            write_merged(os.path.join(folder, "merged.h5"), parts)
            soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
            resource.setrlimit(resource.RLIMIT_NOFILE, (110, hard))
            self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
            data = Dataset(os.path.join(folder, "merged.h5"), "all", ("cloth", "image"), "all")
            for i in np.random.default_rng(1).permutation(150):
                self.assert_same(data[i]["image"], sample_values(i, 1)["image"][0])


class Refusals(DatasetCase):
    def copy(self) -> str:
        """A folder of its own with the same files."""
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        return shutil.copytree(self.folder, os.path.join(folder, "copy"))

    def test_arguments(self) -> None:
        for message, keywords in (
            ("no split 'dev'", {"split": "dev"}),
            ("status is 'good'", {"status": "good"}),
            ("has no field 'coth'; its samples have cloth, ", {"fields": ("coth",)}),
            ("has no field 'certificate/x'", {"fields": ("certificate/x",)}),
            ("does not have one value a sample", {"fields": ("mesh/triangle",)}),
            ("does not have one value a sample", {"fields": ("mesh/scalar",)}),
        ):
            with self.assertRaisesRegex(DataError, message):
                Dataset(self.whole, **keywords)

    def test_files(self) -> None:
        with self.assertRaisesRegex(DataError, "no file /nowhere/a.h5"):
            Dataset("/nowhere/a.h5")
        with self.assertRaisesRegex(DataError, "cannot be opened as HDF5"):
            Dataset(__file__)
        other = os.path.join(self.folder, "other.h5")
        with h5py.File(other, "w") as file:
            file["samples/id"] = [1]
        with self.assertRaisesRegex(DataError, "not a data set of toile"):
            Dataset(other)

    def test_a_split_without_samples(self) -> None:
        path = os.path.join(self.folder, "train_only.h5")
        write_part(path, 0, 3)
        with self.assertRaisesRegex(DataError, r"no samples of split 'test': it has none \(in the file: 3 train"):
            Dataset(path, split="test")
        with h5py.File(path, "r+") as file:
            file["samples/status"][:] = 1
        with self.assertRaisesRegex(DataError, "none of its 3 was accepted"):
            Dataset(path)
        self.assertEqual(len(Dataset(path, status="all")), 3)

    def test_a_part_that_is_missing_damaged_or_another(self) -> None:
        folder = self.copy()
        part = os.path.join(folder, "shard_1", "part_00000.h5")
        merged = os.path.join(folder, "merged.h5")
        data = Dataset(merged, fields=("cloth",), split="all")
        os.rename(part, part + ".gone")
        with self.assertRaisesRegex(DataError, "shard_1/part_00000.h5"):
            data[:]
        with self.assertRaisesRegex(DataError, "parts that are not there: .*shard_1/part_00000.h5; move a merged"):
            Dataset(merged)
        with open(part + ".gone", "rb") as whole, open(part, "wb") as cut:
            cut.write(whole.read()[:4000])
        with self.assertRaisesRegex(DataError, "shard_1/part_00000.h5"):
            Dataset(merged, fields=("cloth",), split="all")[:]
        with h5py.File(part, "w") as file:
            file["samples/cloth"] = np.zeros((1, VERTICES + 1, 3), "f4")
        with self.assertRaisesRegex(DataError, "not that of a part"):
            Dataset(merged, fields=("cloth",), split="all")[:]

    def test_a_flipped_bit(self) -> None:
        path = os.path.join(self.copy(), "whole.h5")
        with h5py.File(path, "r") as file:
            chunk = file["samples/cloth"].id.get_chunk_info(2)
        with open(path, "r+b") as file:
            file.seek(chunk.byte_offset + chunk.size // 2)
            byte = file.read(1)[0]
            file.seek(-1, os.SEEK_CUR)
            file.write(bytes([byte ^ 1]))
        data = Dataset(path, "all", ("cloth",), "all")
        self.assert_same(data[1]["cloth"], self.direct["cloth"][1])
        with self.assertRaisesRegex(DataError, "whole.h5:/samples/cloth row 2 cannot be read"):
            data[2]

    def test_rows_that_no_part_fills(self) -> None:
        path = os.path.join(self.copy(), "merged.h5")
        with h5py.File(path, "r+") as file:
            del file["samples/cloth"]
            layout = h5py.VirtualLayout((SAMPLES, VERTICES, 3), "f4")
            layout[:20] = h5py.VirtualSource("shard_0/part_00000.h5", "samples/cloth", (20, VERTICES, 3))
            file.create_virtual_dataset("samples/cloth", layout)
        with self.assertRaisesRegex(DataError, "rows that no part fills"):
            Dataset(path)


class Processes(DatasetCase):
    def in_child(self, task) -> None:
        """Runs `task` in a forked process; its failures are this test's."""
        child = os.fork()
        if child == 0:
            try:
                task()
                os._exit(0)
            except BaseException:
                import traceback

                traceback.print_exc()
                os._exit(1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_a_fork_after_reading_has_no_file_open(self) -> None:
        for path in (self.whole, self.merged):
            data = Dataset(path, fields=FIELDS)
            data[0]

            def read(data: Dataset = data) -> None:
                opened = [os.path.realpath(f"/proc/self/fd/{fd}") for fd in os.listdir("/proc/self/fd")]
                self.assertEqual([name for name in opened if name.startswith(os.path.realpath(self.folder))], [])
                for i in reversed(range(len(data))):
                    for field, value in data[i].items():
                        self.assert_same(value, self.direct[field][self.expected()[i]])

            self.in_child(read)
            read_again = data[:]  # the parent goes on
            self.assert_same(read_again["image"], self.direct["image"][self.expected()])
            data.close()

    def test_forks_while_other_threads_read(self) -> None:
        data = Dataset(self.merged, fields=("image",))
        expected, stop, wrong = self.direct["image"][self.expected()], threading.Event(), []

        def read() -> None:
            while not stop.is_set():
                i = np.random.randint(len(data))
                if data[i]["image"].tobytes() != expected[i].tobytes():
                    wrong.append(i)

        threads = [threading.Thread(target=read) for _ in range(3)]
        for thread in threads:
            thread.start()
        try:
            for _ in range(30):
                self.in_child(lambda: self.assert_same(data[:]["image"], expected))
        finally:
            stop.set()
            for thread in threads:
                thread.join()
        self.assertEqual(wrong, [])

    def test_a_pickle_is_small_and_opens_the_file_again(self) -> None:
        for path in (self.whole, self.merged):
            data = Dataset(path, fields=FIELDS)
            data[0]
            pickled = pickle.dumps(data)
            self.assertLess(len(pickled), 10_000)
            for field, value in pickle.loads(pickled)[:].items():
                self.assert_same(value, self.direct[field][self.expected()])

    def test_beside_other_readers_and_writers(self) -> None:
        for locking in (None, True, False):  # this process reads it too, with any kind of lock
            with h5py.File(self.whole, "r", locking=locking):
                self.assertGreater(len(Dataset(self.whole)), 0)
        plain = h5py.File

        def refuse_locks(path: str, mode: str, locking: bool | None = None, **keywords: int) -> h5py.File:
            if locking is None:
                raise OSError(errno.ENOLCK, "Unable to open file (unable to lock file, errno = 37)")
            return plain(path, mode, locking=locking, **keywords)

        with unittest.mock.patch.object(h5py, "File", refuse_locks):  # a file system without locks
            self.assertGreater(len(Dataset(self.whole)), 0)
        read = [sys.executable, "-c", f"import toile_data; toile_data.Dataset({self.whole!r})"]
        with h5py.File(self.whole, "r+"):
            outcome = subprocess.run(read, stderr=subprocess.PIPE, text=True)
        self.assertIn(
            "DataError: " + self.whole + " cannot be opened as HDF5; another program is writing", outcome.stderr
        )
        self.assertEqual(subprocess.run(read).returncode, 0)


if __name__ == "__main__":
    unittest.main()
