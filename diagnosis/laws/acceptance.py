"""Whether a law is kept: it must predict what was left out, and explain more than its rivals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws.beginning import Beginning, log_odds
from matstd.diagnosis.laws.policy import LawPolicy
from matstd.diagnosis.policy import POLICY as DIAGNOSIS
from matstd.diagnosis.regression import Memory, left_out, likely_memory
from matstd.twin.frames import IntArray
from matstd.twin.laws import Law

TIME_BLOCKS, PLACE_BLOCKS = 10, 5
"""Blocks of time, and of the range of a variable, that are left out one after the other."""

CELLS = 2, 4
"""Parts of the range of either variable of a law of two: touches of a cell of both are left out."""

LARGEST = 50  # part of the touches, those that a formula moves most, which are left out together
MOST_SET_ASIDE = 2.0  # largest amount of a formula at a gross error, over that at all other touches

THIRDS, MIN_OTHERS = 3, 2
"""Parts of the readings of every other axis that are left out one after the other, and the least
number of such axes that refute a curve."""

MEMORY_PARAMETERS = 2  # of noise that remembers: its correlation, and its kind


class Refusal(Enum):
    """Why the best law of a search was not kept."""

    FEW = "so few touches distinguish no law from another"
    CHANCE = "its evidence is within chance"
    PREDICTION = "touches left out are not predicted better with it"
    MEMORY = "noise that remembers explains the run better"
    LIBRARY = "an effect of the library explains it better"


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Error of touches that were left out, without and with the laws."""

    what: str  # "poses", "times", or a variable whose range was cut into blocks
    before: float  # root mean square error with the model alone, mm
    after: float  # with the laws, mm


def memory_score(fit: Fit) -> float:
    """Log evidence that noise with memory gains over white noise, its parameters charged.

    White noise that is larger than stated needs no rival of its own: every evidence is that of a
    noise whose size the run determines.
    """
    _, gain = likely_memory(fit.run.touches, fit.u, fit.used, fit.X, fit.y)
    return gain - 0.5 * MEMORY_PARAMETERS * float(np.log(max(fit.solution.dof, 2.0)))


def stands_beside_memory(
    start: Beginning,
    laws: Sequence[Law],
    law: Law,
    charge: float,
    policy: LawPolicy,
) -> bool:
    """Whether a law explains more than noise does that remembers, where there is such noise."""
    if start.memory is None:
        return True
    after = start.fitted([*laws, law])
    return log_odds(after, start.fitted(laws, gross=after.gross), charge) > policy.min_score


def memory_left(fit: Fit, before: Memory) -> Memory | None:
    """What the noise still remembers with the laws in the model; most of it was the laws."""
    memory, gain = likely_memory(fit.run.touches, fit.u, fit.used, fit.X, fit.y)
    if gain < DIAGNOSIS.memory_gain:
        return None
    return replace(memory, is_filtered=before.is_filtered)


def predicts_better(before: Fit, after: Fit) -> bool:
    """Whether touches left out, by poses and by times, are predicted better with a law.

    Freed of the uncertainty of the prediction: where a block takes most of a set-up with it, plain
    errors are those of a set-up that is extrapolated, with and without a law.
    """
    for groups in (pose_groups(before), time_groups(before)):
        was, now = _own_error(before, groups), _own_error(after, _same(groups, after))
        if now > was:
            return False
    return True


def prediction_odds(one: Fit, other: Fit) -> float:
    """Log odds of a model against another by touches left out, by poses and by times: the lesser.

    ``log p = -1/2 (N log s^2 + log det V)``, V the covariance of the errors of all blocks and s^2
    what they are over it: an uncertain prediction is charged for its uncertainty. Both models use
    the same rows.
    """
    return min(
        _log_predictive(one, groups(one)) - _log_predictive(other, groups(other))
        for groups in (pose_groups, time_groups)
    )


def _log_predictive(fit: Fit, groups: Sequence[IntArray]) -> float:
    found = left_out(fit.solution.Q, fit.solution.residual, _within(fit, groups))
    return -0.5 * (len(found.error) * 2.0 * np.log(found.rms * fit.noise.factor) + found.log_det)


def holds_between(before: Fit, after: Fit, law: Law) -> bool:
    """Whether a law of two variables predicts where both have values that were left out together.

    A formula that grows towards an unseen corner raises errors at coarse and at fine cells alike. A
    law of one variable may act in one block alone, which says nothing of it. Errors count beyond
    what set-ups and geometry may make up for in the cell, as they do in another run: where a set-up
    was extrapolated by 0.1 mm, a right law with odds of exp(283) was refused.
    """
    if len(law.drivers) < 2:
        return True
    for parts in CELLS:
        groups = _same(_cells(before, law, parts), after)
        if _beyond_model(before, after, groups) <= _beyond_model(before, before, groups):
            return True
    return False


def _beyond_model(model: Fit, fit: Fit, groups: Sequence[IntArray]) -> float:
    """Sum of squares of errors of rows left out that another model cannot take up there."""
    inside = _within(fit, groups)
    error = left_out(fit.solution.Q, fit.solution.residual, inside).error * fit.noise.factor
    own = zip(inside, _within(model, groups), strict=True)
    each = [(error[rows], model.solution.Q[there]) for rows, there in own]
    return sum(float(e @ e - np.sum((e @ Q) ** 2)) for e, Q in each)


def holds_where_largest(before: Fit, after: Fit, law: Law, policy: LawPolicy) -> bool:
    """Whether the touches that a formula moves most do not speak against it.

    Two exponentials that grow towards a corner imitated a step along the diagonal of two axes, and
    predicted a second run, which went farther into it, with 1.63 µm instead of 1.04 without a law.
    Touches that a formula moves most are therefore left out together. In another run they were
    gross errors beside the formula, six times as large there as at any other touch (5.55 µm instead
    of 2.66).
    """
    if law.is_curve_alone:
        return True
    amount = np.abs(np.stack(law.amounts(before.run.touches), axis=1)).max(axis=1)
    if amount.max() > MOST_SET_ASIDE * amount[after.used].max():
        return False
    rows = np.flatnonzero(before.used)
    largest = rows[np.argsort(-amount[rows], kind="stable")][: len(rows) // LARGEST + 1]
    groups = _same([largest], after)
    more = _beyond_model(before, after, groups) - _beyond_model(before, before, groups)
    return 0.5 * more < policy.min_score


def holds_elsewhere(before: Fit, after: Fit, law: Law) -> bool:
    """Whether a curve over a reading predicts where other axes had readings that were left out.

    A curve over X imitated a ring about a point of X and Y. It predicted poses and times that were
    left out, but a second run with 0.72 µm instead of 0.67 without it. With thirds of the readings
    of Y or of Z left out, its errors were half as large again as without it. Of a right curve the
    errors fall for one axis at least. Formulas have other tests: a right one of a short run failed
    this one.
    """
    if not law.is_curve_alone or any(d.nature not in ("linear", "rotary") for d in law.drivers):
        return True
    rows, worse = np.flatnonzero(before.used), list[bool]()
    for axis in set(before.run.touches.chain.programmed_axes) - {d.name for d in law.drivers}:
        x = before.run.touches.reading(axis)[rows]
        if len(np.unique(x)) > THIRDS:
            groups = list(np.array_split(rows[np.argsort(x, kind="stable")], THIRDS))
            worse.append(_error(after, _same(groups, after)) > _error(before, groups))
    return len(worse) < MIN_OTHERS or not all(worse)


def _cells(fit: Fit, law: Law, parts: int) -> list[IntArray]:
    """Rows of the run by parts of the range of every variable of a law, each as many touches."""
    rows = np.flatnonzero(fit.used)
    label = np.zeros(len(rows), dtype=int)
    for driver in law.drivers:
        x = driver.values(fit.run.touches)[rows]
        edges = np.quantile(x, np.arange(1, parts) / parts)
        label = label * parts + np.searchsorted(edges, x)
    return [rows[label == k] for k in np.unique(label)]


def pose_groups(fit: Fit) -> list[IntArray]:
    """Rows of the run, by table pose in every set-up, as the fit has them."""
    rows = np.flatnonzero(fit.used)
    return [rows[g] for g in fit.groups]


def time_groups(fit: Fit) -> list[IntArray]:
    """Rows of the run in blocks one after the other."""
    return list(np.array_split(np.flatnonzero(fit.used), TIME_BLOCKS))


def _same(groups: Sequence[IntArray], after: Fit) -> list[IntArray]:
    """The same blocks of rows, as far as another fit uses them."""
    return [g[after.used[g]] for g in groups]


def _own_error(fit: Fit, groups: Sequence[IntArray]) -> float:
    """Error of rows left out over what their uncertainty explains, in units of the stated noise."""
    inside = _within(fit, groups)
    return left_out(fit.solution.Q, fit.solution.residual, inside).rms * fit.noise.factor


def _within(fit: Fit, groups: Sequence[IntArray]) -> list[IntArray]:
    """Blocks as numbers within the rows that the fit uses."""
    place = np.full(len(fit.used), -1)
    place[fit.used] = np.arange(int(fit.used.sum()))
    inside = [place[g][place[g] >= 0] for g in groups]
    return [g for g in inside if len(g)]


def _error(fit: Fit, groups: Sequence[IntArray]) -> float:
    """Root mean square error of rows left out block by block, mm."""
    inside = _within(fit, groups)
    found = left_out(fit.solution.Q, fit.solution.residual, inside)
    rows = np.concatenate(inside)
    return float(np.sqrt(np.mean((found.error * fit.u[fit.used])[rows] ** 2)))


def held_out(before: Fit, after: Fit, laws: Sequence[Law]) -> list[HeldOut]:
    """Errors of touches left out: by poses, by times, and by blocks of every variable of a law."""
    blocks = {"poses": pose_groups(before), "times": time_groups(before)}
    touches = before.run.touches
    for driver in dict.fromkeys(driver for law in laws for driver in law.drivers):
        rows = np.flatnonzero(before.used)
        x = driver.values(touches)[rows]
        if len(np.unique(x)) > PLACE_BLOCKS:
            order = rows[np.argsort(x, kind="stable")]
            blocks[driver.name] = list(np.array_split(order, PLACE_BLOCKS))
    return [
        HeldOut(what, _error(before, groups), _error(after, _same(groups, after)))
        for what, groups in blocks.items()
    ]
