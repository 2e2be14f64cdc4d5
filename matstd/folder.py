"""A folder of results that appears whole or not at all."""

import re
import secrets
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.lock import is_abandoned, locked
from twin.errors import DesignError
from twin.files import NOT_WRITABLE

if TYPE_CHECKING:
    from diagnosis.fit import Fit

FOUND = "machine_found.toml"
"""Machine file of a serial arm with the lines of all joints as found."""

WORKING: set[Path] = set()
"""Folders in which this process works; whoever ends it at once removes them."""


@contextmanager
def results_folder(
    out: str | Path, force: bool = False, ours: Sequence[str] = (), refused: Sequence[str] = ()
) -> Iterator[Path]:
    """A neighbour folder to work in; its files move to `out` when the block ends well.

    Files of the same name are replaced, which is why a folder that is not empty needs `force`;
    whatever else lies in it stays, but for results of an earlier run that this one does not have.
    Neighbours that killed runs have left are removed.

    Args:
        out: Where the results shall stand.
        force: Whether results of an earlier run may be replaced.
        ours: Patterns of the names of results that not every run has.
        refused: Names of what a refused run leaves; a folder that holds nothing else counts as
            empty.

    Raises:
        DesignError: The folder holds something and nobody asked to replace it, or it cannot be
            written to.
    """
    out = Path(out)
    if out.exists() and not out.is_dir():
        raise DesignError(f"{out}: is a file, expected a folder or a name that is free")
    if not force and out.exists() and any(p.name not in refused for p in out.iterdir()):
        raise DesignError(f"{out}: already exists; choose another folder or give --force")
    _remove_abandoned(out)
    place = out.parent / f".{out.name}-{secrets.token_hex(4)}"
    WORKING.add(place)
    try:  # from before the folder is made: an interrupt can come at any moment
        work = place / "results"
        try:
            work.mkdir(parents=True)
        except OSError as error:  # whatever it is, nothing was written yet
            raise DesignError(f"{out}: cannot be made ({error.strerror or error})") from error
        with locked(place):
            yield work
            _move(work, out, [*ours, *refused])
    except OSError as error:
        if error.errno not in NOT_WRITABLE:
            raise
        raise DesignError(f"{out}: cannot be written ({error.strerror or error})") from error
    finally:
        shutil.rmtree(place, ignore_errors=True)
        WORKING.discard(place)


def _move(work: Path, out: Path, ours: Sequence[str]) -> None:
    """Results to where they shall stand, those of an earlier run away."""
    for old in (file for pattern in ours for file in out.glob(pattern)):
        old.unlink()
    for file in sorted(p for p in work.rglob("*") if p.is_file()):
        goal = out / file.relative_to(work)
        goal.parent.mkdir(parents=True, exist_ok=True)
        file.replace(goal)
    out.mkdir(exist_ok=True)


def _remove_abandoned(out: Path) -> None:
    """Remove what killed runs for the same results have left beside them, and nothing else."""
    ours = re.compile(rf"\.{re.escape(out.name)}-[0-9a-f]{{8}}")
    if out.parent.is_dir():
        for place in out.parent.iterdir():
            if ours.fullmatch(place.name) and is_abandoned(place):
                shutil.rmtree(place, ignore_errors=True)


def write_found_arm(folder: Path, fit: "Fit", title: str) -> str:
    """Write it, and say what it is good for; nothing, and "", where the machine is no arm."""
    from diagnosis.geometry import found_arm
    from report.words import microns
    from twin.files import write_whole
    from twin.foreign import machine_text

    arm = found_arm(fit)
    if arm is None:
        return ""
    write_whole(folder / FOUND, machine_text(arm.chain, title, is_known=True))
    return (
        f"{FOUND} has the lines of all joints as found, to put in the machine file's place: with "
        f"nothing but the set-up {microns(arm.after)} are left then, {microns(arm.before)} now; "
        "take all of them or none, and import again, which finds the reflector anew"
    )
