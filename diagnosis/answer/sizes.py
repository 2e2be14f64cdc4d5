"""Reported sizes of found effects: from the touches alone, inner parameters included.

The fit that predicts leans on the distributions that a machine's ordinary errors are expected to
have, and an effect that the machine can partly imitate is drawn by them. A reported size shall
rest on the touches: here the machine is left nearly free, every inner parameter is moved to where
the whole model fits best, and its uncertainty is in that of the size.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, addition, projected
from matstd.diagnosis.fit import (
    Fit,
    Reported,
    continuous_inner,
    fit_run,
    reported,
    shifted,
    spacing,
)
from matstd.diagnosis.regression import PRIOR_DOF, GrossErrors
from matstd.diagnosis.search import DiagnosisTask
from matstd.twin.frames import Array
from matstd.twin.model import Effect, Inner, Model, Tunable, is_tunable, traits

PRIOR_FACTOR = 10.0
"""Factor on the stated distributions of the machine's ordinary errors: at the tenth of the stated
weight no error of a machine within them, or a few times beyond, draws a size noticeably."""

MAX_STEPS = 4  # most steps of Gauss and Newton; the inner parameters come refined
SETTLED_STEP = 0.02  # step over standard uncertainty from which an inner parameter is settled
MAX_GRID_STEP = 0.5  # in distances of the grid's points: the tangent holds no farther
MAX_INSTANTS = 60  # instants to either side that are weighed for an effect that begins at one


def sizes(
    task: DiagnosisTask,
    effects: Sequence[ScaledEffect],
    gross: GrossErrors,
    complement: ResidualSpace,
) -> tuple[tuple[tuple[Reported, ...], ...], tuple[ScaledEffect, ...]]:
    """Parameters of every effect as reported, and the effects at their inner parameters."""
    if not effects:
        return (), ()
    fit, at = _settled(task, effects, gross)
    dof = fit.solution.dof + PRIOR_DOF
    # the scale of the noise is itself found: Student's distribution is a little wider
    wider = float(np.sqrt(dof / max(dof - 2.0, 0.5)))
    moved = tuple(ScaledEffect(e, s.scale) for e, s in zip(at, effects, strict=True))
    out = []
    whole = [traits(e).is_reported_whole for e in at]
    # what the machine can do alike, if it were free to, leaves nothing of the whole of an effect
    expected = task.fit(moved, gross) if any(whole) else fit
    for i, effect in enumerate(at):
        by = expected if whole[i] else fit
        out.append(reported(by, effect, wider, _instants(complement, moved, i)))
    return tuple(out), moved


def _settled(
    task: DiagnosisTask, effects: Sequence[ScaledEffect], gross: GrossErrors
) -> tuple[Fit, tuple[Effect, ...]]:
    """The fit with tangents at the inner parameters that suit it best, and the effects there."""
    at = [s.effect for s in effects]
    prior = task.prior if task.is_known else task.prior.widened(PRIOR_FACTOR)
    for sized in effects:
        prior = prior.joined(task.found_prior(sized))
    for remaining in reversed(range(MAX_STEPS)):
        model = Model(task.model.chain, (*task.model.effects, *at))
        theta = fit_run(task.run, model, prior, None, gross, task.memory).theta
        theta = theta[: len(model.parameters)]
        fit = fit_run(task.run, model, prior, theta, gross, task.memory)
        moved = _stepped(fit, at)
        if moved is None or not remaining:
            break
        at = moved
    return fit, tuple(at)


def _stepped(fit: Fit, effects: Sequence[Effect]) -> list[Effect] | None:
    """Effects with their inner parameters a step further, or None where they are settled."""
    out = list(effects)
    names = [e.name for e in effects]
    farthest = 0.0
    for tangent in fit.tangents:
        if tangent.effect.name not in names:
            continue
        place, i = fit.of_effect(tangent.name), names.index(tangent.effect.name)
        effect = out[i]
        assert is_tunable(effect)
        inner = effect.inner(fit.run.touches)[tangent.index]
        value = list(effect.tuning.values())[tangent.index]
        step = float(fit.theta[place][0])
        farthest = max(farthest, abs(step) / float(np.sqrt(fit.covariance[place, place][0, 0])))
        longest = MAX_GRID_STEP * spacing(inner, value)
        target = value + float(np.clip(step, -longest, longest))
        target = float(np.clip(target, np.min(inner.grid), np.max(inner.grid)))
        out[i] = shifted(effect, tangent.index, target - value)
    return out if farthest > SETTLED_STEP else None


def _instants(
    complement: ResidualSpace, effects: Sequence[ScaledEffect], which: int
) -> Mapping[int, tuple[float, float]]:
    """Mean and standard deviation of inner parameters that act by jumps, by their index.

    Between two touches every instant is as good as every other; each such interval is weighed by
    its evidence and its length.
    """
    effect = effects[which].effect
    out: dict[int, tuple[float, float]] = {}
    if not is_tunable(effect):
        return out
    others = [s for k, s in enumerate(effects) if k != which]
    base: EffectSet | None = None
    for index, inner, value in continuous_inner(effect, complement.touches):
        if inner.acts != "at an instant":
            continue
        base = base or EffectSet(complement, projected(complement, others))
        out[index] = _weighed(base, effect, index, _jumps(complement, inner, value))
    return out


def _jumps(complement: ResidualSpace, inner: Inner, value: float) -> Array:
    """Times of touches around an instant, ascending, within the grid."""
    times = np.unique(inner.clocked(complement.touches)[complement.used])
    first = int(np.searchsorted(times, value)) - MAX_INSTANTS
    near = times[max(first, 0) : first + 2 * MAX_INSTANTS]
    low, high = float(np.min(inner.grid)), float(np.max(inner.grid))
    inside = near[(near >= low) & (near <= high)]
    return np.concatenate([[low], inside, [high]]) if len(inside) < len(near) else inside


def _weighed(base: EffectSet, effect: Tunable, index: int, edges: Array) -> tuple[float, float]:
    """Mean and deviation of an instant over the intervals between some edges."""
    middle, length = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    value = list(effect.tuning.values())[index]
    evidence = np.array([addition(base, shifted(effect, index, t - value))[0] for t in middle])
    weight = length * np.exp(evidence - evidence.max())
    weight /= weight.sum()
    mean = float(weight @ middle)
    variance = float(weight @ ((middle - mean) ** 2 + length**2 / 12.0))
    return mean, float(np.sqrt(variance))
