"""Which mistake in the description makes a run fit.

Every suspect is one mistake undone. Each is fitted with the machine's errors held to what such a
machine is expected to have, never widened: a wrong description asks for errors that no machine has,
and undoing the mistake makes them usual again. The measure is the evidence with the size of the
noise integrated out, over an even choice of touches without the farthest twentieth, so that chips
decide nothing. What is named is then undone exactly, and the whole run is fitted anew: the figures
reported are those of that fit.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from matstd.diagnosis.evidence import Progress, log_evidence, quiet
from matstd.diagnosis.faults.suspects import (
    Fault,
    Suspect,
    corrected,
    free_sd,
    has_minutes_for_seconds,
    suspects,
    with_setups_placed,
)
from matstd.diagnosis.fit import Fit, fit_run, unit_mistake
from matstd.diagnosis.geometry import SETUP_FACTOR, FoundNumber
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import PRIOR_DOF, solve
from matstd.twin.effects import SHIFT_SD, TURN_SD, body_errors, placing_errors
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.library import ordinary_model
from matstd.twin.model import Effect, Model, columns, traits
from matstd.twin.record import Run, Setup, Touches, computed_deviation

MAX_TOUCHES = 400
"""Most touches that suspects are tried on. More change no answer, and thirty suspects take
seconds."""

TRIMMED_SHARE = 0.05  # share of the touches, farthest from a first fit, that do not count


MAX_SETUP_COST = 30.0
"""Most log odds that a set-up costs which stands elsewhere than stated by many times its freedom:
with the standard turned about, one axis the other way looks like another."""

MAX_STEPS = 3
"""Turns in which a number is found and moved exactly: a zero wrong by a degree needs two."""


@dataclass(frozen=True, slots=True, eq=False)
class DescriptionFault:
    """A mistake in the description that makes the run fit once it is undone."""

    fault: Fault
    axes: tuple[str, ...]
    numbers: tuple[FoundNumber, ...]  # what was found where the mistake is a number
    notation: str  # chain with which the run fits, "" where it stays
    log_odds: float  # evidence for it against the description as it is
    rms: tuple[float, float]  # residual as described and without the mistake, mm
    test_rms: tuple[float, float]  # held-out error as described and without the mistake, mm
    # errors of the machine over the expected ones, as described and without the mistake
    widened: tuple[float, float]
    alike: tuple["DescriptionFault", ...] = ()  # other mistakes that explain the run as well


@dataclass(frozen=True, slots=True, eq=False)
class _Trial:
    """A suspect with its index, the numbers found and its evidence."""

    index: int
    suspect: Suspect
    theta: Array
    u: Array
    evidence: float


def description_faults(
    before: Fit, progress: Progress = quiet, beside: Sequence[Effect] = (), after: Fit | None = None
) -> tuple[DescriptionFault, ...]:
    """Mistakes in the description of a run or its machine that make it fit; usually none.

    Args:
        before: The fit of the ordinary model.
        beside: Effects that were found, free in every trial: what a backlash explains is no zero.
        after: The fit with them: where it is an ordinary one, no axis runs the other way.
    """
    run = before.run
    named = [_clock(before)] if has_minutes_for_seconds(run) else []
    excess = min(max(fit.widened, fit.noise.factor) for fit in (before, after or before))
    is_absurd = excess > POLICY.mistake_suspected or unit_mistake(before) is not None
    few = with_setups_placed(_few(run))
    right = _evidence(few, (), np.zeros(0), beside)[0] - _moved_setups(
        run.touches.setups, few.touches
    )
    trials = []
    for i, suspect in enumerate(suspects(few, is_absurd)):
        moved = _moved_setups(run.touches.setups, suspect.run.touches)
        trials.append(_trial(i, suspect, moved, right, beside))
        progress(0.5, "mistakes in the description")
    trials = sorted(trials, key=lambda t: -t.evidence)
    close = [
        t
        for t in trials
        if t.evidence
        > max(right + POLICY.log_odds_mistake, trials[0].evidence - POLICY.log_odds_alike)
    ]
    was = fit_run(run, _model(run, beside)) if beside and close else before
    faults = [_description_fault(was, t, right, is_absurd, beside) for t in close]
    # an axis has many places on the other side that differ in nothing
    kept = list({(t.fault, t.axes): t for t in reversed(faults) if t is not None}.values())[::-1]
    if kept:
        named.append(replace(kept[0], alike=tuple(kept[1:])))
    return tuple(named)


def faults_of_refused(run: Run) -> tuple[DescriptionFault, ...]:
    """The same for a run that its reader has refused; nothing where not even that can be fitted.

    Of a touching ball the readings are looked at: they may contradict stated deviations.
    """
    if run.touches.instrument.is_ball_on_standard:
        run = replace(run, deviation=computed_deviation(run.touches))
    try:
        return description_faults(fit_run(run, ordinary_model(run.touches.chain)))
    except (NotEnoughData, np.linalg.LinAlgError):
        return ()


def _clock(fit: Fit) -> DescriptionFault:
    """Minutes in a column of seconds: seen from the pace alone, no residual shows it."""
    return DescriptionFault(
        fault=Fault.MINUTES,
        axes=(),
        numbers=(),
        notation="",
        log_odds=0.0,
        rms=(fit.rms, fit.rms),
        test_rms=(fit.test_rms, fit.test_rms),
        widened=(fit.widened, fit.widened),
    )


def _few(run: Run) -> Run:
    """An even choice of the rows that a fit uses."""
    rows = np.flatnonzero(run.split != "test")
    pick = np.unique(np.linspace(0, len(rows) - 1, min(MAX_TOUCHES, len(rows))).astype(np.int64))
    return run[rows[pick]]


def _usual_size(suspect: Suspect) -> Iterator[Effect]:
    """The free numbers as effects with their usual standard deviations."""
    ordinary = {e.name: e for e in ordinary_model(suspect.run.touches.chain).effects}
    for effect in suspect.free:
        yield ordinary.get(effect.name, effect)


def _moved_setups(stated: Sequence[Setup], touches: Touches) -> float:
    """Log odds against set-ups that had to be moved so far from where they are stated to stand."""
    cost = 0.0
    for before, after in zip(stated, touches.setups, strict=True):
        step = after.T_table_artefact @ inverse(before.T_table_artefact)
        middle = apply(before.T_table_artefact, touches.point.mean(axis=0))
        shift = float(np.linalg.norm(apply(step, middle) - middle)) / (SETUP_FACTOR * SHIFT_SD)
        turn = float(np.linalg.norm(step[:3, :3] - np.eye(3))) / (SETUP_FACTOR * TURN_SD)
        cost += min(0.5 * (shift**2 + turn**2), MAX_SETUP_COST)
    return cost


def _model(run: Run, beside: Sequence[Effect]) -> Model:
    """The ordinary model with effects that were found."""
    ordinary = ordinary_model(run.touches.chain).effects
    names = {e.name for e in ordinary}
    return Model(run.touches.chain, (*ordinary, *(e for e in beside if e.name not in names)))


def _trial(
    index: int, suspect: Suspect, moved: float, right: float, beside: Sequence[Effect]
) -> _Trial:
    """Numbers of a suspect, found and moved exactly in turns, and its evidence at the end.

    Args:
        index: The how manyth it is.
        moved: Log odds against where it puts the set-ups.
        right: Evidence for the description as it is: a suspect that gains nothing in its first turn
            is far from being named, and has no further one.
    """
    total = np.zeros(sum(len(e.parameters) for e in suspect.free))
    at = suspect
    for remaining in reversed(range(MAX_STEPS)):
        evidence, theta, u = _evidence(at.run, at.free, total, beside)
        if not suspect.free or not remaining or evidence - moved < right:
            break
        total = total + theta
        at = corrected(suspect, total)
    return _Trial(index=index, suspect=suspect, theta=total, u=u, evidence=evidence - moved)


def _evidence(
    run: Run, free: Sequence[Effect], at: Array, beside: Sequence[Effect]
) -> tuple[float, Array, Array]:
    """Log evidence of a run up to a constant, with the free numbers and their uncertainties.

    Args:
        free: Numbers of the description that are left free.
        at: By how much they have been moved already, (K,).
        beside: Effects that were found.
    """
    touches = run.touches
    machine, setups = _model(run, beside).effects, placing_errors(touches)
    bodies = body_errors(touches)
    usual = (*machine, *setups, *bodies)
    count = sum(len(e.parameters) for e in free)
    sd_free = np.concatenate([free_sd(e) for e in free]) if free else np.zeros(0)
    sd_machine = [p.sd for e in machine for p in e.parameters]
    sd_setups = [SETUP_FACTOR * p.sd for e in setups for p in e.parameters]
    sd_bodies = [p.sd for e in bodies for p in e.parameters]
    sd = np.concatenate([sd_machine, sd_setups, sd_bodies, sd_free])
    X = columns((*usual, *free), touches) * sd / run.u[:, None]
    y = run.deviation / run.u
    first = solve(X, y)
    z = np.abs(first.residual) / np.sqrt(np.maximum(1.0 - first.leverage, 1e-6))
    kept = z <= np.quantile(z, 1.0 - TRIMMED_SHARE)
    solution = solve(X[kept], y[kept])
    n = len(y)
    objective = solution.objective * n / int(kept.sum())
    if count:  # what was moved before is part of the departure from what is stated
        phi = solution.phi[-count:]
        objective += float(((phi + at / sd_free) ** 2 - phi**2).sum())
    log_det = 2.0 * float(np.log(np.abs(np.diag(solution.R))).sum())
    evidence = float(log_evidence(objective, log_det, n, PRIOR_DOF))
    u = sd_free * np.sqrt((solution.root[-count:] ** 2).sum(axis=1)) if count else np.zeros(0)
    theta = sd_free * solution.phi[-count:] if count else np.zeros(0)
    return evidence, theta, u


def _description_fault(
    before: Fit, trial: _Trial, right: float, is_absurd: bool, beside: Sequence[Effect]
) -> DescriptionFault | None:
    """A mistake with the figures of the whole run; None where undoing it does not mend the fit.

    A number is named for what it gains beside the usual errors of the machine, where it predicts
    better or leaves a machine less odd. An axis or a sign is wrong altogether: without the mistake
    the run must fit, or it was not that.
    """
    suspect = trial.suspect
    usual = [p.sd for e in _usual_size(suspect) for p in e.parameters]
    if suspect.free and (np.abs(trial.theta) < POLICY.far_line * np.array(usual)).all():
        return None
    suspect = next(islice(suspects(before.run, is_absurd), trial.index, None))  # on all touches
    undone = corrected(suspect, trial.theta) if suspect.free else suspect
    chain = undone.run.touches.chain
    after = fit_run(undone.run, _model(undone.run, beside))
    falls = (
        before.test_rms > POLICY.mistake_improvement * after.test_rms
        or before.widened > POLICY.mistake_improvement * after.widened
    )
    if not suspect.free and (not falls or unit_mistake(after) is not None):
        return None
    is_odder = after.widened >= before.widened
    if suspect.free and is_odder and after.test_rms > before.test_rms:
        return None
    changed = chain.notation != before.model.chain.notation
    return DescriptionFault(
        fault=suspect.fault,
        axes=suspect.axes,
        numbers=tuple(_numbers(trial)),
        notation=chain.notation if changed else "",
        log_odds=trial.evidence - right,
        rms=(before.rms, after.rms),
        test_rms=(before.test_rms, after.test_rms),
        widened=(before.widened, after.widened),
    )


def _numbers(trial: _Trial) -> Iterator[FoundNumber]:
    """What has to be added to the numbers of the description."""
    values = zip(trial.suspect.free, trial.theta, trial.u, strict=True)
    for effect, value, u in values:
        own = traits(effect)
        name = own.symbol.name if own.symbol is not None else own.stated_number
        if name == "EZ0t":  # the ball higher up is a shorter tool
            yield FoundNumber("length", -float(value), float(u))
        else:
            yield FoundNumber(name, float(value), float(u))
