"""Variables on which a residual depends, and whether time may stand for one that is recorded."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.answer.ambiguity import arguments
from matstd.diagnosis.answer.verdict import Dependence
from matstd.diagnosis.evidence import EffectSet, Progress
from matstd.diagnosis.residual import Shape, Structure, find_structure
from matstd.diagnosis.search import SearchState, most_evident
from matstd.twin.model import Effect
from matstd.twin.record import Touches

CLOCK = "time_s"

MAX_DEPENDENCES = 2
"""Most patterns that `depends_on` reports, one after the other."""


def structures(final: SearchState, progress: Progress) -> tuple[Structure, ...]:
    """What the residual varies with at the start, each pattern freed of those before."""
    complement = final.smooth.complement
    out: list[Structure] = []
    A = np.zeros((len(complement.residual), 0))
    found: Sequence[Structure] = final.at_start
    while found:
        if not any(s.columns is not None for s in found):
            return (*out, found[0])
        best = most_evident(found)
        out.append(best)
        if len(out) == MAX_DEPENDENCES or best.columns is None:
            break
        A = np.hstack([A, best.columns])
        found = find_structure(EffectSet(complement, A), progress, final.smooth)
    return tuple(out)


def dependences(found: Sequence[Structure]) -> tuple[Dependence, ...]:
    """Variables of some structures, each once, with the smallest probability."""
    out: dict[str, Dependence] = {}
    for structure in found:
        for variable in structure.variables:
            known = out.get(variable)
            if known is None or structure.p_value < known.p_value:
                out[variable] = Dependence(variable, structure.p_value, structure)
    return tuple(out.values())


def odds_against_drift(state: SearchState) -> dict[str, float]:
    """Log odds for every effect that follows a sensor against a drift in time, by its name.

    All temperatures of a workshop rise in the morning: a law of one of them may describe what
    another, unrecorded one did.
    """
    touches = state.pool.complement.touches
    members, whole = state.chosen.members, state.chosen.effects
    out = {}
    for i, member in enumerate(members):
        if _follows_sensor(member.effect, touches):
            others = state.search.evaluate(members[:i] + members[i + 1 :]).effects
            left = find_structure(others, smooth=state.smooth)
            drifts = [
                s.evidence for s in left if s.shape is Shape.SMOOTH and s.variables == (CLOCK,)
            ]
            if drifts:
                out[member.effect.name] = whole.evidence - others.evidence - max(drifts)
    return out


def _follows_sensor(effect: Effect, touches: Touches) -> bool:
    """Whether a temperature or the spindle speed drives an effect."""
    drivers = {*touches.temperature, "spindle_rpm"}
    return any(word in drivers for word in arguments(effect))
