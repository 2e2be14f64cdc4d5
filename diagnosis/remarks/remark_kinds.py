"""A remark whose sentence is a text with its numbers: what was noticed, and the numbers by name."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any


class What(Enum):
    """What was noticed; the values are the names of the numbers, lengths in mm."""

    READER = "text"
    FEW_TOUCHES = "touches, parameters"
    FEW_DEGREES_OF_FREEDOM = "dof"
    HELD_OUT_IN_DOUBT = "ratio"
    FEW_POSES = "poses, has_rotary"
    JOINTS_STOOD = "names"
    WORSE_THAN_REPLICATES = "ratio, dof"
    NOISE_MISSTATED = "found, stated"
    OUTLIERS_KEPT = ""
    OUTLIERS_LEFT_OUT = "lines, largest, runs"
    """Lines of the run file, what stands out most first; largest distance from what the other
    touches predict, outwards positive; names of the runs, one a line, empty for a single run."""
    MANY_STOOD_OUT = "touches, of, left_out, without, whole"
    """So many that the held-out error is stated without them and with all touches."""
    PRIOR_WIDENED = "factor"
    SEARCH_ENDED = "sets"
    NOISE_REMEMBERS = "correlation, step, by_place, rows, independent, is_noise"
    """Correlation over a step in s, 0 from touch to touch; whether it is a property of the noise,
    rather than something slow that is left."""
    CHOSEN_BY_PREDICTION = "chosen, blocks, tried, is_empty"
    """Ways that were tried with their errors of blocks left out; whether no effect came of it."""
    FIELD_SHARES = "axis, sizes"
    """What drives of a field explain, rms, the largest first."""
    NOT_SIGNIFICANT = "effect, quantity, value, u, unit"
    SHORT_BEAM = "effect, slenderness"
    LOAD_TOO_SMALL = "effect, load"
    FIXING_NOT_STATED = "effect"
    """An expansion of a standard of which the run does not state where it is held."""


@dataclass(frozen=True, slots=True)
class Noticed:
    """Something that was noticed, with its numbers as attributes."""

    what: What
    numbers: Mapping[str, Any]

    def __getattr__(self, name: str) -> Any:
        """One of the numbers."""
        if name == "numbers" or name not in self.numbers:  # it may not be there yet in a copy
            raise AttributeError(name)
        return self.numbers[name]


def noticed(what: What, **numbers: Any) -> Noticed:
    """A remark with exactly the numbers that its sentence needs."""
    assert ", ".join(numbers) == what.value, f"{what.name}: {numbers}"
    return Noticed(what, numbers)


def short_beam(effect: str, slenderness: float) -> Noticed:
    """A beam so few times as long as deep that the theory of beams is doubtful."""
    return noticed(What.SHORT_BEAM, effect=effect, slenderness=slenderness)
