"""A folder of results that appears whole or not at all."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from twin.errors import DesignError


@contextmanager
def results_folder(out: str | Path, force: bool = False) -> Iterator[Path]:
    """A neighbour folder to work in; its files move to `out` when the block ends well.

    Files of the same name are replaced, which is why a folder that is not empty needs `force`;
    whatever else lies in it stays.

    Args:
        out: Where the results shall stand.
        force: Whether results of an earlier run may be replaced.

    Raises:
        DesignError: The folder holds something and nobody asked to replace it, or it cannot be
            written to.
    """
    out = Path(out)
    if not force and out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise DesignError(f"{out}: is there already; choose another folder or give --force")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        work = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=out.parent))
    except OSError as error:
        raise DesignError(f"{out}: cannot be written ({error.strerror})") from error
    try:
        yield work
        for file in sorted(p for p in work.rglob("*") if p.is_file()):
            goal = out / file.relative_to(work)
            goal.parent.mkdir(parents=True, exist_ok=True)
            file.replace(goal)
        out.mkdir(exist_ok=True)
    finally:
        shutil.rmtree(work, ignore_errors=True)
