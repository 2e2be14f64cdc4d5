"""The error falling, effect by effect: sizes beside uncertainties, and what falls for them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.answer.ambiguity import ConfusionClass
from matstd.diagnosis.answer.reported_set import ReportedSet, reported_set, without
from matstd.diagnosis.answer.sizes import sizes
from matstd.diagnosis.evidence import MIN_OWN_SHARE, ResidualSpace, ScaledEffect
from matstd.diagnosis.fit import Fit, Reported, Role, explained_rms
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors, f_probability
from matstd.diagnosis.remarks import Noticed, What, noticed
from matstd.diagnosis.search import DiagnosisTask, SearchState
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.model import Effect

EXPANSION = "um_per_m_K"  # unit of a coefficient of expansion, as it is reported


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """The model with one effect more than the step before; the first has none."""

    effect: Effect | None  # what was added, with its inner parameters; None for the starting model
    fit: Fit
    p_value: float  # probability by chance, grid and number of candidates paid for; 1 for the first
    reported: tuple[Reported, ...]  # its parameters as a user reads them, from the last fit
    # what it cannot be distinguished from; None for the first, and for effects that were named by
    # the user
    confusion: ConfusionClass | None

    @property
    def name(self) -> str:
        """Of the effect; empty for the starting model."""
        return "" if self.effect is None else self.effect.name

    @property
    def is_named(self) -> bool:
        """Whether the user named the effect; else the diagnosis found it."""
        return self.effect is not None and self.confusion is None

    @property
    def size(self) -> Reported | None:
        """The clearest of the numbers that say how large the effect is: a screw has two ends."""
        return max((n for n in self.reported if n.role is Role.SIZE), key=_clarity, default=None)

    @property
    def worth(self) -> float:
        """Size over its standard uncertainty; infinite where there is no such number."""
        return np.inf if self.size is None else _clarity(self.size)

    @property
    def is_certain(self) -> bool:
        """Whether chance is so improbable that the uncertainty of the size says nothing."""
        is_sized = self.effect is None or len(self.effect.parameters) <= POLICY.sized_parameters
        return self.p_value < (POLICY.certain_p if is_sized else POLICY.close_p)


def _clarity(number: Reported) -> float:
    return abs(number.value) / number.u if number.u else np.inf


def significant_effects(
    task: DiagnosisTask, final: SearchState
) -> tuple[ReportedSet, tuple[Step, ...]]:
    """The reported set: every member beyond chance and its size beyond its uncertainty.

    A search weighs an effect beside a machine as it is expected to be; a size that rests on the
    touches alone may be nothing, and such an effect is not reported. The weakest goes first. The
    last one stays where chance did not make it: then the run does not decide between it and errors
    of the machine that are larger than expected.
    """
    while True:
        tested = reported_set(final)
        steps = _steps(task, tested, final.base.gross)
        found = steps[1 + len(task.added) :]
        weak = tested.open_driver or weakest(found, final.is_weighed)
        is_open = tested.open_driver is None and len(found) == 1 and _is_beyond_chance(found[0])
        if weak is None or is_open:
            return tested, tuple(_determined(step) for step in steps)
        final = without(tested.state, weak)


def _steps(task: DiagnosisTask, tested: ReportedSet, gross: GrossErrors) -> tuple[Step, ...]:
    """The error falling: the starting model, named effects, found effects by their worth."""
    state, first = tested.state, task.fit((), gross)
    # the reported inner parameters are those that are drawn and saved
    numbers, effects = sizes(task, (*task.added, *state.effects), gross, task.space(first))
    classes = (*(None for _ in task.added), *tested.classes)
    out = [Step(effect=None, fit=first, p_value=1.0, reported=(), confusion=None)]
    for k, (confusion, found) in enumerate(zip(classes, numbers, strict=True)):
        # among periods that look alike, the uncertainty of one holds for none
        alike = confusion.alike if confusion is not None else None
        is_open = alike is not None and alike.pitch is None
        reported = tuple(
            replace(n, u=None) if is_open and n.role is Role.INNER else n for n in found
        )
        effect, fit = effects[k].effect, task.fit(effects[: k + 1], gross)
        if confusion is None:
            p = named_probability(out[-1].fit, fit)
        else:
            p = state.chances.get(effect.name, tested.tests[effect.name].p_value)
        out.append(Step(effect=effect, fit=fit, p_value=p, reported=reported, confusion=confusion))
    return tuple(out)


def _determined(step: Step) -> Step:
    """The step with a size that the run determines, where chance cannot have made the effect.

    Three touches after a slip show that the standard moved, and not whether it shifted or turned:
    5 ± 43 µm. How far it moved these touches they determine.
    """
    effect = step.effect
    if effect is None or step.worth >= POLICY.significant_ratio or not step.is_certain:
        return step
    place = step.fit.of_effect(effect.name)
    covariance = step.fit.covariance[place, place]
    known = explained_rms(step.fit, effect, step.fit.theta[place], covariance)
    others = (
        replace(n, role=Role.COEFFICIENT) if n.role is Role.SIZE else n for n in step.reported
    )
    return replace(step, reported=(known, *others))


def named_probability(before: Fit, after: Fit) -> float:
    """Probability by chance of the fall that a named effect brings: no scan is paid for."""
    k = max(after.solution.effective_parameters - before.solution.effective_parameters, 0.5)
    scale = (before.noise.factor / after.noise.factor) ** 2
    drop = before.solution.objective * scale - after.solution.objective
    return float(f_probability(drop, k, after.solution.objective, after.solution.dof))


def left_by(C: Array, others: Array) -> float:
    """Share of the square of some columns (N, K) that other columns (N, L) cannot imitate."""
    whole = float((C**2).sum())
    if not others.shape[1] or whole == 0.0:
        return 1.0
    fitted = others @ np.linalg.lstsq(others, C, rcond=None)[0]
    return float(((C - fitted) ** 2).sum()) / whole


def check_distinct(complement: ResidualSpace, added: Sequence[ScaledEffect]) -> None:
    """Refuse effects of which a run determines only a sum.

    Raises:
        DesignError: Two names, and how much of the one the other imitates; or one name and the
            others, where only several together imitate it.
    """
    columns = [complement.project(complement.columns([s.effect])) for s in added]
    for i, C in enumerate(columns):
        earlier = columns[:i]
        alone = [left_by(C, other) for other in earlier]
        if min(alone, default=1.0) < MIN_OWN_SHARE:
            _refuse(added[i], [added[int(np.argmin(alone))]], min(alone))
        if earlier and (left := left_by(C, np.hstack(earlier))) < MIN_OWN_SHARE:
            _refuse(added[i], added[:i], left)


def _refuse(one: ScaledEffect, others: Sequence[ScaledEffect], left: float) -> None:
    names = " and ".join(s.effect.name for s in others)
    verb = "imitates" if len(others) == 1 else "together imitate"
    raise DesignError(
        f"{one.effect.name} beside {names}: at these touches the latter {verb} all but "
        f"{100.0 * left:.2g} % of it, so that only a sum of their sizes is known; expected the one "
        "without the other"
    )


def not_significant(steps: Sequence[Step]) -> tuple[Noticed, ...]:
    """Effects added by name whose size is within its own uncertainty."""
    out = []
    for step in steps:
        size = step.size
        if step.is_named and size is not None and step.worth < POLICY.significant_ratio:
            numbers = {"value": size.value, "u": size.u, "unit": size.unit}
            what = What.NOT_SIGNIFICANT
            out.append(noticed(what, effect=step.name, quantity=size.quantity, **numbers))
    return tuple(out)


def weakest(steps: Sequence[Step], is_weighed: bool) -> str | None:
    """Name of the found effect with the least support, if chance or its uncertainty explains it.

    Args:
        is_weighed: Whether the set was chosen by what it predicts: then its members stand together,
            and one falls only if neither its size nor its probability speaks for it.
    """
    out, least = None, POLICY.significant_ratio
    for step in steps:
        worth = step.worth
        if not _is_possible(step) or (not is_weighed and step.p_value >= POLICY.false_alarm):
            worth = 0.0
        elif step.p_value <= POLICY.chance_of_member if is_weighed else step.is_certain:
            continue
        if worth < least:
            out, least = step.name, worth
    return out


def _is_beyond_chance(step: Step) -> bool:
    """Whether something acts, be it this effect or not."""
    return step.p_value < POLICY.false_alarm and _is_possible(step)


def _is_possible(step: Step) -> bool:
    """Whether no coefficient of expansion is of a body that shrinks when it warms."""
    return all(
        n.value >= POLICY.expansion_least / n.factor - POLICY.impossible_ratio * (n.u or 0.0)
        for n in step.reported
        if n.unit == EXPANSION
    )
