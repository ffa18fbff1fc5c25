"""Open HDF5 files that survive fork, spawn and pickling.

HDF5 keeps its state in the process. A handle that was open at a fork is shared by parent and child, and opening the same
path again in the child finds the parent's handle; DataLoader workers then read wrong numbers or stop (pytorch#11929).
So no handle of this module is ever open at a fork: they are closed before it, in the parent, and each side opens its own
when it reads next. A pickled `OpenFile` is its path.
"""

from __future__ import annotations

import errno
import os
import threading
import weakref
from collections import OrderedDict

import h5py

from toile_data.error import DataError

#: Held while HDF5 is called, so that no other thread is in the middle of a read when a fork closes the files. HDF5 has
#: a lock of its own that lets one thread in at a time, so this one costs no time.
hdf5_lock = threading.RLock()
_files: weakref.WeakSet[OpenFile] = weakref.WeakSet()


class OpenFile:
    """A file to read, opened when first asked for, and opened anew in each process.

    Locks are HDF5's default: any number of readers, and none while someone writes. Where the file system refuses locks,
    as those of some clusters do, or this process has the file open without one, it is opened without. Its datasets stay
    open, with `cache_bytes` of chunk cache each: a sample is a chunk, read once an epoch, so there is nothing to keep.
    """

    def __init__(self, path: str | os.PathLike[str], cache_bytes: int = 0) -> None:
        self.path = os.path.realpath(path)  # of a link too: the parts of a merged file lie beside it
        self._cache_bytes = cache_bytes
        self._forget()
        with hdf5_lock:
            _files.add(self)

    def _forget(self) -> None:
        self._handle: h5py.File | None = None
        self._datasets: dict[str, h5py.Dataset] = {}
        self._pid = -1

    def __getstate__(self) -> dict[str, object]:
        return {"path": self.path, "cache_bytes": self._cache_bytes}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__init__(state["path"], state["cache_bytes"])  # type: ignore[misc,arg-type]

    @property
    def handle(self) -> h5py.File:
        """Call with `hdf5_lock` held, and keep nothing of it afterwards."""
        if self._handle is not None and self._pid != os.getpid():
            self.close()  # a fork that Python did not see: drop the parent's handle in this process alone
        if self._handle is None:
            self._handle = self._open()
            self._pid = os.getpid()
        return self._handle

    def dataset(self, name: str) -> h5py.Dataset:
        """The dataset of an absolute name, kept open. Call with `hdf5_lock` held."""
        handle = self.handle
        if name not in self._datasets:
            self._datasets[name] = handle[name]
        return self._datasets[name]

    def close(self) -> None:
        """Closes the file; the next use opens it again."""
        with hdf5_lock:
            handle = self._handle
            self._forget()
            if handle is not None:
                handle.close()

    def _open(self) -> h5py.File:
        if not os.path.exists(self.path):
            raise DataError(f"there is no file {self.path}")
        try:
            return self._try(None)
        except OSError as error:
            if "lock" not in str(error) or error.errno == errno.EAGAIN:
                raise self._refusal(error) from error
        try:
            return self._try(False)
        except OSError as error:
            raise self._refusal(error) from error

    def _try(self, locking: bool | None) -> h5py.File:
        return h5py.File(self.path, "r", locking=locking, rdcc_nbytes=self._cache_bytes)

    def _refusal(self, error: OSError) -> DataError:
        writing = "; another program is writing to it" if error.errno == errno.EAGAIN else ""
        return DataError(f"{self.path} cannot be opened as HDF5{writing}: {error}")


class OpenFiles:
    """Files by path, at most `most` of them open: a corpus has more parts than a process may have open files."""

    def __init__(self, most: int = 64) -> None:
        self.most = most
        self._by_path: OrderedDict[str, OpenFile] = OrderedDict()

    def __getstate__(self) -> dict[str, object]:
        return {"most": self.most}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__init__(state["most"])  # type: ignore[misc,arg-type]

    def get(self, path: str) -> OpenFile:
        """Call with `hdf5_lock` held."""
        if path in self._by_path:
            self._by_path.move_to_end(path)
            return self._by_path[path]
        while len(self._by_path) >= self.most:
            self._by_path.popitem(last=False)[1].close()
        self._by_path[path] = OpenFile(path)
        return self._by_path[path]

    def close(self) -> None:
        with hdf5_lock:
            for file in self._by_path.values():
                file.close()


def _before_fork() -> None:
    hdf5_lock.acquire()
    for file in list(_files):
        file.close()


os.register_at_fork(before=_before_fork, after_in_parent=hdf5_lock.release, after_in_child=hdf5_lock.release)
