"""Locks that the operating system releases when a process ends, however it ends.

`locked` marks the working folder of a running process: if the lock is free, the process has ended.
`in_turn` lets processes write results under one name one after the other.
"""

import errno
import os
import sys
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from matstd.twin.errors import DesignError

_LOCK = "matstd.lock"
_MARK = "matstd works here; this folder goes when it is done\n"
_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)  # a file system that knows no locks
PATIENCE, _PAUSE = 60.0, 0.02
"""Longest wait for a lock, which is held for milliseconds, and pause between tries, s."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder that has just been made."""
    with (folder / _LOCK).open("x", encoding="utf-8") as file:
        _is_free(file)
        file.write(_MARK)
        file.flush()
        yield


def is_abandoned(folder: Path) -> bool:
    """Whether a folder is one of ours whose process has ended."""
    try:
        with (folder / _LOCK).open("r+", encoding="utf-8") as file:
            # the lock first: who holds it may be about to write the mark
            return _is_free(file) and file.read() == _MARK
    except OSError:
        return False


@contextmanager
def in_turn(path: Path, patience: float = PATIENCE) -> Iterator[None]:
    """Keep every other process from this block for the same name, which need not exist.

    Where the file system knows no locks, the block runs without. Raises DesignError if another
    process has held the lock for longer than `patience`, s.
    """
    # of the name, which may itself be as long as names can be; a shared lock does no harm
    lock = path.with_name(f".matstd-{zlib.crc32(path.name.casefold().encode()):08x}.lock")
    end = time.monotonic() + patience
    while time.monotonic() < end:
        try:
            file = lock.open("a", encoding="utf-8")
        except PermissionError:  # Windows, while another process removes it
            if sys.platform != "win32":
                raise
            time.sleep(_PAUSE)
            continue
        with file:
            is_ours = _is_free(file, without=True)
            if is_ours:
                try:
                    yield
                finally:
                    if sys.platform != "win32":  # while it is held: it is no other's then
                        lock.unlink(missing_ok=True)
        if is_ours:
            if sys.platform == "win32":  # only what is closed; never what another has open
                with suppress(OSError):
                    lock.unlink()
            return
        time.sleep(_PAUSE)
    raise DesignError(f"{path}: another run is writing it; wait for it, or choose another name")


def _is_free(file: IO[str], without: bool = False) -> bool:
    """Take the lock until the file is closed; `without` is the answer where there are no locks."""
    try:
        if sys.platform == "win32":
            import msvcrt

            # far behind the text: on Windows a locked place cannot be read
            file.seek(1 << 20)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            file.seek(0)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return without and error.errno in _NO_LOCKS
    return os.fstat(file.fileno()).st_nlink > 0  # else it was removed meanwhile
