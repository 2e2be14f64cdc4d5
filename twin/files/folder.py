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

WORKING: set[Path] = set()  # working folders of this process; they are removed when it is ended


@contextmanager
def results_folder(
    out: str | Path, force: bool = False, ours: Sequence[str] = (), refused: Sequence[str] = ()
) -> Iterator[Path]:
    """A neighbour folder to work in; its files move to `out` when the block ends well.

    Files of the same name are replaced, so a folder that is not empty needs `force`. Other files
    stay, except results of an earlier run that this run does not have. The folder is checked again,
    under a lock, when the files are moved: if another run was faster, these results are kept under
    a free name beside it. Neighbour folders of killed runs are removed.

    Args:
        force: Whether results of an earlier run may be replaced.
        ours: Name patterns of results that not every run has.
        refused: Names of files that a refused run leaves; a folder with only these counts as empty.

    Raises:
        DesignError: The folder is not empty, now or when the results are moved, and `force` is not
            given, or it cannot be written to.
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
    """Whether a folder holds other files than those of a refused run."""
    return out.exists() and any(p.name not in refused for p in out.iterdir())


def _move(work: Path, out: Path, ours: Sequence[str]) -> None:
    """Move results to their folder and remove those of an earlier run: all or nothing."""
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
    """Remove the working folders that killed runs left for the same results."""
    ours = re.compile(rf"\.{re.escape(out.name)}-[0-9a-f]{{8}}")
    if out.parent.is_dir():
        for place in out.parent.iterdir():
            if ours.fullmatch(place.name) and is_abandoned(place):
                shutil.rmtree(place, ignore_errors=True)
