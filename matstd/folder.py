"""A folder of results that appears whole or not at all."""

import secrets
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from twin.errors import DesignError
from twin.files import NOT_WRITABLE


@contextmanager
def results_folder(
    out: str | Path, force: bool = False, ours: Sequence[str] = ()
) -> Iterator[Path]:
    """A neighbour folder to work in; its files move to `out` when the block ends well.

    Files of the same name are replaced, which is why a folder that is not empty needs `force`;
    whatever else lies in it stays, but for results of an earlier run that this one does not have.

    Args:
        out: Where the results shall stand.
        force: Whether results of an earlier run may be replaced.
        ours: Patterns of the names of results that not every run has; a folder that holds nothing
            else counts as empty.

    Raises:
        DesignError: The folder holds something and nobody asked to replace it, or it cannot be
            written to.
    """
    out = Path(out)
    if out.exists() and not out.is_dir():
        raise DesignError(f"{out}: is a file, expected a folder or a name that is free")
    if not force and out.exists() and any(not _is_ours(p, ours) for p in out.iterdir()):
        raise DesignError(f"{out}: is there already; choose another folder or give --force")
    work = out.parent / f".{out.name}-{secrets.token_hex(4)}"
    try:  # from before the folder is made: an interrupt can come at any moment
        work.mkdir(parents=True)
        yield work
        for old in (file for pattern in ours for file in out.glob(pattern)):
            old.unlink()
        for file in sorted(p for p in work.rglob("*") if p.is_file()):
            goal = out / file.relative_to(work)
            goal.parent.mkdir(parents=True, exist_ok=True)
            file.replace(goal)
        out.mkdir(exist_ok=True)
    except OSError as error:
        if error.errno not in NOT_WRITABLE:
            raise
        raise DesignError(f"{out}: cannot be written ({error.strerror or error})") from error
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _is_ours(path: Path, ours: Sequence[str]) -> bool:
    return any(path.match(pattern) for pattern in ours)
