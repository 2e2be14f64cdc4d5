"""Effects that models may have beyond those of the library.

The room that replays a saved law of a drift is loaded on use.
"""

from collections.abc import Sequence
from pathlib import Path

from matstd.twin.library import load_installed_effects, load_user_effects, register
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, Kind


def _make(chain: Chain, arguments: Sequence[str]) -> Effect:
    """From the file of the law and what its columns move."""
    from matstd.diagnosis.drift import drift_law_of

    return drift_law_of(chain, arguments)


DRIFT_LAW = Kind(
    word="drift-law",
    arguments="thermal.json,column:EZZ,...",
    title="thermal drift by a saved law",
    synonyms="thermal displacement, ARX, growth, drift model, replay of a law, warm-up",
    formula="E = s (law(T, n, t) + w (root u + e)), the law of matstd thermal",
    units="law: 1; unknowns: standard deviations",
    typical="what the log showed; unknowns 1",
    source="D-MT paper, eq. (4); docs/thermal.md",
    make=_make,
    propose=lambda touches: (),
    about="A saved law of a drift (matstd thermal), replayed on temperatures and speeds.",
)


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
        ``register_effects("my_effects.py")`` returns the kinds of that file.
    """
    register(DRIFT_LAW)
    load_installed_effects()
    return tuple(kind for path in files for kind in load_user_effects(Path(path)))
