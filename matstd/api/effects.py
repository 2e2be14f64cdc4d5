"""Effects that models may have, beyond those of the library."""

from pathlib import Path

from matstd.drift_law import DRIFT_LAW
from matstd.twin.library import load_installed_effects, load_user_effects, register
from matstd.twin.model import Kind


def register_effects(*files: str | Path) -> tuple[Kind, ...]:
    """Make effects known: saved laws of a drift, those of installed packages, and your own files.

    From then on they can be named, are proposed and diagnosed like those of the library. Every
    function that reads names of effects calls this without files.

    Args:
        files: Python files with kinds of effects, as docs/own_effects.md describes them.

    Returns:
        The kinds of these files.

    Raises:
        BadFile: A file that cannot be loaded, or whose kind has a word that is taken.

    Example:
        >>> [kind.word for kind in register_effects("my_effects.py")]
        ['hose']
    """
    register(DRIFT_LAW)
    load_installed_effects()
    return tuple(kind for path in files for kind in load_user_effects(Path(path)))
