"""Marks a folder as one that a running process of ours works in.

The mark is a file under a lock that the operating system takes back when the process ends, however
it ends: a folder whose lock is free belongs to nobody any more.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

_LOCK = "matstd.lock"
_MARK = "matstd works here; this folder goes when it is done\n"


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


def _is_free(file: IO[str]) -> bool:
    """Take the lock; it is given back when the file is closed."""
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
    except OSError:
        return False
    return os.fstat(file.fileno()).st_nlink > 0  # else it was removed meanwhile
