"""Variables on which a residual depends, each pattern freed of the ones before it."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.answer.verdict import Dependence
from matstd.diagnosis.evidence import EffectSet, Progress
from matstd.diagnosis.residual import Structure, find_structure
from matstd.diagnosis.search import SearchState, most_evident

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
