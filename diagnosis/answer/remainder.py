"""What a residual depends on, and what would decide where nothing is named.

A pattern that no effect of the library describes well still has a nearest one, and a table of
positions of the axis that it depends on describes whatever repeats over that axis. Noise larger
than it is stated has only one witness: the same touch again.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from matstd.diagnosis.accuracy import Repeatability
from matstd.diagnosis.answer.candidates import Candidate
from matstd.diagnosis.answer.steps import named_probability
from matstd.diagnosis.answer.verdict import Dependence, Offer
from matstd.diagnosis.evidence import EffectSet, Progress, ScaledEffect, quiet
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.residual import Structure, find_structure
from matstd.diagnosis.search import (
    DiagnosisTask,
    SearchState,
    follows_driver,
    most_evident,
    refined_named,
    tables_along,
)
from matstd.twin.frames import IntArray
from matstd.twin.model import Effect

MAX_DEPENDENCES = 2  # most patterns that `depends_on` reports, one after the other
MAX_TRIED = 6  # library effects, the best ones by themselves, that are tried beside what was found
MAX_NAMED = 3  # effects that are named
MAX_REPEATED = 6  # touches to repeat: three times each they give twelve degrees of freedom


def nearest(
    task: DiagnosisTask,
    found: Sequence[ScaledEffect],
    gross: GrossErrors,
    last: Fit,
    candidates: Sequence[Candidate],
    library: Mapping[str, Effect],
    depends_on: Sequence[Dependence],
    is_driver_missing: bool,
) -> tuple[Offer, ...]:
    """Effects nearest to what is left, those that predict best first.

    Args:
        candidates: Library effects by themselves, best first.
        library: All of them by name.
        is_driver_missing: Whether what is left follows a driver that was not recorded: no law of
            another one is offered for it.
    """
    known = {sized.effect.name for sized in found}
    certain = {c.effect for c in candidates if c.p_value < POLICY.close_p} - known
    names = [c.effect for c in candidates if c.effect not in known][:MAX_TRIED]
    effects = [library[name] for name in names]
    if is_driver_missing:
        effects = [e for e in effects if not follows_driver(e)]
    tables = tables_along(last.run.touches, [d.variable for d in depends_on])
    effects += [e for e in tables if e.name not in known]
    offers = []
    for effect in effects:
        fit = task.fit([*found, *refined_named(task, [effect], quiet)], gross)
        p = min(1.0, len(effects) * named_probability(last, fit))
        offers.append(Offer(effect.name, p, float(fit.test_rms)))
    offers.sort(key=lambda offer: offer.test_rms)
    likely = [o for o in offers if o.p_value < POLICY.false_alarm and o.test_rms < last.test_rms]
    return tuple((likely or [o for o in offers if o.effect in certain])[:MAX_NAMED])


def to_repeat(fit: Fit, repeats: Repeatability) -> IntArray:
    """Rows to repeat where the noise would have to be doubtfully large; empty where it need not.

    Where repeats are known they have decided: what exceeds them is no noise.

    The largest residual of each of the worst poses: a fault of the model comes again there, noise
    does not.
    """
    if fit.noise.factor <= POLICY.credible_noise or repeats.known is not None:
        return np.zeros(0, dtype=np.int64)
    touches = fit.run.touches
    off = np.where(fit.used, np.abs(fit.residual) / fit.run.u, -1.0)
    worst = np.argsort(-off, kind="stable")
    places = np.column_stack([touches.setup, touches.pose])[worst]
    first = np.sort(np.unique(places, axis=0, return_index=True)[1])
    rows = [*worst[first], *np.delete(worst, first)]
    return np.array([row for row in rows if fit.used[row]][:MAX_REPEATED], dtype=np.int64)


def beyond_doubt(left: Sequence[Structure], fit: Fit) -> tuple[Structure, ...]:
    """Patterns that stand however the noise remembers, in a residual that exceeds what is stated.

    One well below the stated uncertainty is allowed for, whatever pattern it has.
    """
    if float(np.std(fit.residual[fit.used] / fit.run.u[fit.used])) < POLICY.noise_ratio_covered:
        return ()
    is_modelled = fit.memory is not None and fit.memory.is_filtered
    return tuple(s for s in left if not is_modelled or s.p_value < POLICY.p_beside_memory)


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
