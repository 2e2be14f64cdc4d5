"""Files are written whole or not at all, and a user's file is never lost."""

import errno
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

from matstd.twin.errors import DesignError
from matstd.twin.files.lock import in_turn
from matstd.twin.text import json_text

NOT_WRITABLE = (
    errno.ENOSPC,
    errno.EDQUOT,
    errno.EFBIG,
    errno.EEXIST,
    errno.EROFS,
    errno.EACCES,
    errno.EPERM,
    errno.EISDIR,
    errno.ENOTDIR,
    errno.EIO,
    errno.ENAMETOOLONG,
)
"""Errors that a user can correct: a full disk, no permission to write."""

SPREADSHEETS = (".xls", ".xlsx", ".xlsm", ".xlsb", ".ods")  # no output is one
AT_ONCE = 0.1  # wait for a folder that another run holds for its whole duration, s
UNFINISHED: set[Path] = set()  # unfinished files of this process; they are removed when it is ended
_ASKED: dict[Path, bool] = {}
"""Outputs of this process that are not written yet, and whether they may be overwritten."""


@contextmanager
def written_whole(path: str | Path) -> Iterator[Path]:
    """A neighbour name to write to; renamed to `path` when the block ends well, else removed.

    If `refuse_to_overwrite` found the name free, it is checked again before the renaming: if
    another process has written the file meanwhile, this one is kept under a free name beside it.

    Raises:
        DesignError: The folder cannot be written to, the disk is full, or the file exists now.
    """
    if "\0" in str(path):
        raise DesignError(f"{str(path)!r}: cannot be written (no name has a zero byte in it)")
    path = Path(os.path.realpath(path))  # the file that a link leads to, not the link
    if os.path.exists(path) and not os.path.isfile(path):
        raise DesignError(f"{path}: cannot be written (it is a folder or a device, not a file)")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # a part of the name is enough, and a long one leaves no room for what is appended
        handle, name = tempfile.mkstemp(
            prefix=f".{path.stem[:32]}-", suffix=path.suffix[-32:], dir=path.parent
        )
    except OSError as error:
        raise _not_written(path, error) from error
    os.close(handle)
    # mkstemp makes private files; an output is as readable as any other file of the user
    umask = os.umask(0)
    os.umask(umask)
    os.chmod(name, 0o666 & ~umask)
    part = Path(name)
    UNFINISHED.add(part)
    try:
        yield part
        if path in _ASKED:
            with in_turn(path):
                _put(part, path, _ASKED.pop(path))
        else:
            part.replace(path)
    except OSError as error:
        if error.errno is not None and error.errno not in NOT_WRITABLE:
            raise  # a file that the block wanted to read, say
        raise _not_written(path, error) from error
    finally:
        part.unlink(missing_ok=True)
        UNFINISHED.discard(part)


def _put(part: Path, path: Path, force: bool) -> None:
    """Rename a finished output, or keep it beside a file that appeared meanwhile."""
    if not force and path.exists():
        kept = free_name(path)
        part.replace(kept)
        raise written_meanwhile(path, kept)
    part.replace(path)


def free_name(path: Path) -> Path:
    """The first of `run-2.csv`, `run-3.csv` ... that does not exist."""
    names = (path.with_name(f"{path.stem[:200]}-{k}{path.suffix}") for k in count(2))
    return next(name for name in names if not os.path.lexists(name))


def written_meanwhile(path: Path, kept: Path) -> DesignError:
    """The exception for an output that another process wrote first."""
    return DesignError(
        f"{path}: another run has written it meanwhile; it stays as it is, and the results of this "
        f"run are in {kept}"
    )


def _not_written(path: Path, error: OSError) -> DesignError:
    name = str(path)
    shown = name if len(name) < 300 else f"{name[:200]} ..."
    return DesignError(f"{shown}: cannot be written ({error.strerror or error})")


def write_whole(path: str | Path, text: str, newline: str = "\n") -> None:
    """Write a text file (UTF-8) whole or not at all.

    Lines of the text end with a line feed, those of the file with `newline`: a control wants
    carriage return and line feed.
    """
    with written_whole(path) as part:
        part.write_bytes(text.replace("\n", newline).encode("utf-8"))


def write_json(path: str | Path, table: Mapping[str, Any], sort_keys: bool = False) -> None:
    """Write a table as JSON (`json_text`) whole or not at all."""
    write_whole(path, json_text(table, sort_keys))


def write_into(
    folder: str | Path, texts: Mapping[str, str], force: bool = False, newline: str = "\n"
) -> list[Path]:
    """Write texts by file name into a folder that may hold others; none is overwritten unasked.

    If one of them exists when they are written, all are kept in a free folder beside it, and
    DesignError is raised; so it is where the folder cannot be written to.
    """
    folder = Path(os.path.realpath(folder))
    with in_turn(folder):
        is_taken = not force and any(os.path.lexists(folder / name) for name in texts)
        place = free_name(folder) if is_taken else folder
        paths = [place / name for name in texts]
        for path, text in zip(paths, texts.values(), strict=True):
            write_whole(path, text, newline)
    if is_taken:
        taken = next(name for name in texts if os.path.lexists(folder / name))
        raise written_meanwhile(folder / taken, place)
    return paths


def copy_into(folder: str | Path, data: Mapping[str, bytes], force: bool = False) -> list[Path]:
    """Write files, by their paths within a folder and as they are; none is overwritten unasked.

    Raises:
        DesignError: A file of the same name exists; nothing is written then.
    """
    folder = Path(folder)
    with in_turn(Path(os.path.realpath(folder))):
        taken = next((n for n in data if not force and os.path.lexists(folder / n)), None)
        if taken is not None:
            raise DesignError(f"{folder / taken}: already exists; choose another folder or --force")
        for name, content in data.items():
            with written_whole(folder / name) as part:
                part.write_bytes(content)
    return [folder / name for name in data]


@contextmanager
def claimed(folder: str | Path, force: bool = False) -> Iterator[Path]:
    """A folder, made if need be, into which no other run writes while the block lasts.

    For results that are kept whatever happens; those that appear whole have `results_folder`. With
    `force` it may hold files.

    Raises:
        DesignError: It holds files, another run is writing into it, or it cannot be made.
    """
    out = Path(folder)
    if out.exists() and not out.is_dir():
        raise DesignError(f"{out}: is a file, expected a folder or a name that is free")
    with in_turn(Path(os.path.realpath(out)), patience=AT_ONCE):
        if out.is_dir() and any(out.iterdir()) and not force:
            raise DesignError(f"{out}: already exists; choose another folder or give --force")
        try:
            out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DesignError(f"{out}: cannot be made ({error.strerror or error})") from error
        yield out


def refuse_to_overwrite(path: str | Path, force: bool = False) -> None:
    """Raise DesignError if the file exists and is not to be overwritten, now or when written.

    A name that spreadsheet programs take for theirs is refused: what is written is text.
    """
    if Path(path).suffix.lower() in SPREADSHEETS:
        raise DesignError(f"{path}: no spreadsheet is written, expected a name such as run.csv")
    if not force and os.path.exists(path):
        raise DesignError(f"{path}: already exists; choose another name or give --force")
    if "\0" not in str(path):  # else it is refused when it is written
        _ASKED[Path(os.path.realpath(path))] = force


def refuse_own_input(output: str | Path, inputs: Iterable[str | Path]) -> None:
    """Raise DesignError if the output is a file that is read, or the folder in which one lies."""
    for path in inputs:
        if not (os.path.isfile(path) and os.path.exists(output)):
            continue
        if os.path.samefile(path, output):
            raise DesignError(f"{output}: is an input of this command; choose another name")
        if os.path.samefile(os.path.dirname(os.path.abspath(path)), output):
            name = os.path.basename(path)
            raise DesignError(f"{output}: holds {name}, an input of this command; choose another")
