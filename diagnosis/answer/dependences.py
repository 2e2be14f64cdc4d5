"""Variables on which a residual depends, and odds against a driver that was not recorded."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.answer.verdict import Dependence
from matstd.diagnosis.evidence import EffectSet, Grid, Progress, score_all, signatures
from matstd.diagnosis.residual import Structure, find_structure
from matstd.diagnosis.search import SearchState, follows_driver, most_evident, unrecorded

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
    """Log odds for every effect that follows a driver against one that was not recorded, by name.

    The most likely law of such a driver stands in its place, with any smooth course in time.
    """
    complement, members = state.pool.complement, state.chosen.members
    led = [m for m in members if follows_driver(m.effect)]
    rivals = unrecorded(complement.touches) if led else []
    if not rivals:
        return {}
    drifts = signatures(complement, [Grid(one, (one,), 1) for one in rivals], 1)
    out = {}
    for member in led:
        others = state.search.evaluate(state.chosen.others(member)).effects
        best = float(score_all(others, drifts).evidence.max())
        out[member.effect.name] = state.chosen.effects.evidence - best
    return out
