"""Effects that a saved model has of another run than the one it is applied to."""

from collections.abc import Mapping
from dataclasses import dataclass

from matstd.twin.model import Effect


@dataclass(frozen=True, slots=True)
class EffectOfOtherRun:
    """An effect that a saved model has of another run, and that is not applied as a rule."""

    effect: Effect
    owner: str  # what it belongs to, as its kind says: "machine", "probe" or "run"
    inner: Mapping[str, float]  # its inner parameters, as in the file
    run: str
    share: float  # what it made there, rms, mm, beside where the standard stood; 0 where unknown
    # whether the touches of this run show a law of that one, too: it is applied
    is_repeated: bool = False
    # whether they speak against a law of the machine: it is not expected here
    is_refuted: bool = False
