"""A folder of results that appears whole or not at all."""

import os
import re
import secrets
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from matstd.twin.errors import DesignError
from matstd.twin.files.lock import in_turn, is_abandoned, locked
from matstd.twin.files.whole import NOT_WRITABLE, free_name, written_meanwhile

WORKING: set[Path] = set()
"""Folders in which this process works; whoever ends it at once removes them."""


@contextmanager
def results_folder(
    out: str | Path, force: bool = False, ours: Sequence[str] = (), refused: Sequence[str] = ()
) -> Iterator[Path]:
    """A neighbour folder to work in; its files move to `out` when the block ends well.

    Files of the same name are replaced, which is why a folder that is not empty needs `force`;
    whatever else lies in it stays, but for results of an earlier run that this one does not have.
    Whether it is free is looked at again when the files are moved, one process after the other: if
    another run was faster, these results are kept whole under a free name beside it. Neighbours
    that killed runs have left are removed.

    Args:
        force: Whether results of an earlier run may be replaced.
        ours: Patterns of the names of results that not every run has.
        refused: Names of what a refused run leaves; a folder that holds nothing else counts as
            empty.

    Raises:
        DesignError: The folder holds something, now or when the results are moved, and nobody
            asked to replace it, or it cannot be written to.
    """
    out = Path(out)
    if out.exists() and not out.is_dir():
        raise DesignError(f"{out}: is a file, expected a folder or a name that is free")
    if not force and _holds_results(out, refused):
        raise DesignError(f"{out}: already exists; choose another folder or give --force")
    shown, out = out, Path(os.path.realpath(out))  # beside a folder that is "." or a link
    _remove_abandoned(out)
    place = out.parent / f".{out.name}-{secrets.token_hex(4)}"
    WORKING.add(place)
    try:  # from before the folder is made: an interrupt can come at any moment
        work = place / "results"
        try:
            work.mkdir(parents=True)
        except OSError as error:  # whatever it is, nothing was written yet
            raise DesignError(f"{shown}: cannot be made ({error.strerror or error})") from error
        with locked(place):
            yield work
            with in_turn(out):
                if not force and _holds_results(out, refused):
                    kept = free_name(out)
                    work.rename(kept)
                    raise written_meanwhile(shown, kept)
                _move(work, out, [*ours, *refused])
    except OSError as error:
        if error.errno not in NOT_WRITABLE:
            raise
        raise DesignError(f"{shown}: cannot be written ({error.strerror or error})") from error
    finally:
        shutil.rmtree(place, ignore_errors=True)
        WORKING.discard(place)


def _holds_results(out: Path, refused: Sequence[str]) -> bool:
    """Whether a folder holds anything but what a refused run leaves."""
    return out.exists() and any(p.name not in refused for p in out.iterdir())


def _move(work: Path, out: Path, ours: Sequence[str]) -> None:
    """Results to where they shall stand, those of an earlier run away; all of it or nothing."""
    if not os.path.lexists(out):
        work.rename(out)  # at once: a run that is killed here leaves the whole or nothing
        return
    before, done = work.parent / "before", list[tuple[Path, Path]]()
    files = sorted(p for p in work.rglob("*") if p.is_file())
    goals = [out / file.relative_to(work) for file in files]
    stale = {old for pattern in ours for old in out.glob(pattern)}
    old = sorted(stale | {goal for goal in goals if goal.exists()})
    away = [(file, before / file.relative_to(out)) for file in old]
    try:
        for file, goal in [*away, *zip(files, goals, strict=True)]:
            goal.parent.mkdir(parents=True, exist_ok=True)
            file.replace(goal)
            done.append((file, goal))
    except BaseException:  # a file that is open elsewhere, say
        for file, goal in reversed(done):
            goal.replace(file)
        raise


def _remove_abandoned(out: Path) -> None:
    """Remove what killed runs for the same results have left beside them, and nothing else."""
    ours = re.compile(rf"\.{re.escape(out.name)}-[0-9a-f]{{8}}")
    if out.parent.is_dir():
        for place in out.parent.iterdir():
            if ours.fullmatch(place.name) and is_abandoned(place):
                shutil.rmtree(place, ignore_errors=True)
