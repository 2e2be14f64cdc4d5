"""The kind of effect that replays a saved law of a drift; the room that has it is loaded on use."""

from collections.abc import Sequence

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
