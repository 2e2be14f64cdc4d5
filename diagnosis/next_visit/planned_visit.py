"""Plans the visit that decides between a law and its rivals, and says how well it would."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from matstd.diagnosis.laws import Learning
from matstd.diagnosis.next_visit.course import SCHEDULES, Course, Schedule, courses
from matstd.diagnosis.next_visit.discrimination import (
    Predicted,
    greedy,
    log_odds_drawn,
    separation,
)
from matstd.diagnosis.next_visit.hypotheses import (
    DECIDED,
    Hypothesis,
    hypotheses,
    predictions,
    unseen,
)
from matstd.diagnosis.next_visit.offers import visiting_touches
from matstd.twin.compute import one_blas_thread
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.model import Effect
from matstd.twin.record import Run, Touches

SIZES = (128, 256, 512)
"""Touches of the plans that are tried: half an hour to two hours of a machine that takes 15 s for a
touch. The first one that decides is taken."""

ENOUGH = 0.8  # power from which no longer visit is tried

POSES, OFFERED_EACH = 48, 32
"""Poses that are offered, and touches at each. Twelve poses of two lots, from which a visit was
chosen whole, separated the same rivals by about half."""

SPREAD_SHARE, UNSEEN_SHARE = 0.25, 0.15
"""Shares of the touches that are spread over all poses whatever the rivals predict (new set-ups are
located by them, and a law that is none of the rivals shows there), and that show the law where the
run does not."""

LEAST_SEPARATION = 3.0
"""Standard deviations below which a rival is not distinguished: noise would decide."""

ALIKE_BELOW = 0.1
"""Standard deviations by all touches that are offered, below which two explanations are one class:
some thousand such visits would be needed to distinguish them."""

WEATHERS, DRAWS = 6, 40
"""Courses of the sensors, and runs of each, by which the odds after a visit are simulated."""

USUAL_PACE = 15.0  # time from touch to touch where a run states no times, s


class NoPlan(Enum):
    """Why no visit is planned."""

    NO_LAW = "no law was learnt"
    DECIDED = "the run decides already: odds of 20 : 1 or more against every other explanation"
    SAME = (
        "the explanations that the run leaves open do the same at every touch that can be made; "
        "every other one has odds of 20 : 1 or more against it"
    )
    FEW = "too few of the touched points can be touched again from a known side"
    ALIKE = "no visit that was tried separates the rivals by three standard deviations"


@dataclass(frozen=True, slots=True, eq=False)
class RivalPower:
    """What a planned visit does against one rival."""

    effect: Effect
    log_odds: float  # against it before the visit
    separation: float  # of its prediction from that of the law, standard deviations
    # root mean square by which both differ at a touch of the visit, beyond what uncertain
    # parameters and clamping make up for, mm
    difference: float
    expected: float  # log odds against it after the visit, on average where the law holds
    # probability of odds of 20 : 1 at least, by simulated visits; None where the rival is not
    # distinguished
    power: float | None
    is_unseen: bool  # whether it is the law, but not at readings where no touch shows it

    @property
    def is_distinguished(self) -> bool:
        """Whether more than noise decides."""
        return self.separation >= LEAST_SEPARATION


@dataclass(frozen=True, slots=True, eq=False)
class VisitPlan:
    """The visit that decides best between a law and its rivals."""

    # that the visit distinguishes from its rivals; None where none was learnt
    law: Effect | None = None
    # in the order of probing, from time 0 on, sensors as they are expected; None where no plan is
    # made
    touches: Touches | None = None
    schedule: Schedule = SCHEDULES[0]
    # explanations that the run has not decided against and a visit could
    rivals: tuple[RivalPower, ...] = ()
    # those that do the same at every touch that was offered: one class with the law
    alike: tuple[Effect, ...] = ()
    # probability that the true one of all explanations that are distinguished gets odds of 20 : 1
    # against each other one, each weighed by its odds before the visit; None where nothing is
    # distinguished
    power: float | None = None
    refusal: NoPlan | None = None  # why there are no touches

    @property
    def is_enough(self) -> bool:
        """Whether it distinguishes all rivals, and decides often enough."""
        return not self.indistinct and (self.power or 0.0) >= ENOUGH

    @property
    def indistinct(self) -> tuple[RivalPower, ...]:
        """Rivals that no visit which was tried distinguishes from the law."""
        left = (one for one in self.rivals if not one.is_unseen)
        return tuple(one for one in left if not one.is_distinguished)

    @property
    def pause_after(self) -> int | None:
        """Number of touches before the machine stands still; None without a pause."""
        if self.touches is None or not self.schedule.pause:
            return None
        return int(np.argmax(np.diff(self.touches.time))) + 1


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """Touches that are offered with one schedule, and what every explanation predicts there."""

    schedule: Schedule
    offers: Touches
    predicted: Sequence[Predicted]
    apart: Array

    def of(self, rivals: IntArray) -> "_Tried":
        """The same with some of the rivals."""
        predicted = [self.predicted[0], *(self.predicted[int(k) + 1] for k in rivals)]
        return replace(self, predicted=predicted, apart=self.apart[rivals])


@one_blas_thread()
def plan_visit(learning: Learning, rng: np.random.Generator) -> VisitPlan:
    """The visit after which the odds between a law and its rivals are largest.

    Sequences of poses are drawn and combined with every schedule; rivals are separated by what they
    predict there, parameters and set-ups uncertain, sensors as they will be. Of the visit that
    separates them best, the touches are chosen; its power is simulated with other weather.
    """
    found = (*hypotheses(learning), *unseen(learning))
    return _planned(found, learning.before.run, rng)


def _planned(found: Sequence[Hypothesis], run: Run, rng: np.random.Generator) -> VisitPlan:
    if not found:
        return VisitPlan(refusal=NoPlan.NO_LAW)
    law = found[0].law
    if len(found) < 2:
        return VisitPlan(law, refusal=NoPlan.DECIDED)
    visits = _Visits.of(run)
    drawn = visiting_touches(run, POSES, OFFERED_EACH, rng)
    plans = []
    for touches in (n for n in SIZES if n <= len(drawn)):
        plans.append(_of_size(found, visits, drawn, touches, rng))
        if plans[-1].refusal is NoPlan.SAME or plans[-1].is_enough:
            break
    if not plans:
        return VisitPlan(law, refusal=NoPlan.FEW)
    # a rival that the longest visit does not distinguish either asks for no long one
    *shorter, last = plans
    if last.power is None:
        return last
    enough, most = min(ENOUGH, last.power), len(last.indistinct)
    good = (p for p in shorter if len(p.indistinct) <= most and (p.power or 0.0) >= enough)
    return next(good, last)


def _of_size(
    found: Sequence[Hypothesis],
    visits: "_Visits",
    drawn: Touches,
    count: int,
    rng: np.random.Generator,
) -> VisitPlan:
    """The best visit of so many of the touches that were drawn."""
    law = found[0].law
    tried = [_tried(found, visits, drawn, s, count / len(drawn)) for s in SCHEDULES]
    most = np.max([one.apart for one in tried], axis=0)
    is_alike, is_unseen = most < ALIKE_BELOW, np.array([one.is_unseen for one in found[1:]])
    alike = tuple(found[int(k) + 1].law for k in np.flatnonzero(is_alike & ~is_unseen))
    differ = np.flatnonzero(most >= np.where(is_unseen, LEAST_SEPARATION, ALIKE_BELOW))
    if is_unseen[differ].all():
        return VisitPlan(law, alike=alike, refusal=NoPlan.SAME if alike else NoPlan.DECIDED)
    found, is_unseen = [found[0], *(found[int(k) + 1] for k in differ)], is_unseen[differ]
    served = (most[differ] >= LEAST_SEPARATION) & ~is_unseen
    best = max((one.of(differ) for one in tried), key=lambda one: _worst(one.apart, served))
    picked = _picked(best.predicted, served, is_unseen, count)
    touches = visits.at(best.offers[picked], best.schedule)
    rivals, power = _power(found, visits, touches, rng)
    known = VisitPlan(law, schedule=best.schedule, rivals=rivals, alike=alike)
    if power is None:
        return replace(known, refusal=NoPlan.ALIKE)
    return replace(known, touches=touches, power=power)


def _tried(
    found: Sequence[Hypothesis],
    visits: "_Visits",
    drawn: Touches,
    schedule: Schedule,
    share: float,
) -> _Tried:
    """What every explanation predicts of touches with a schedule."""
    offers = visits.at(drawn, schedule, share)
    predicted = predictions(found, offers)
    apart = np.array([separation(predicted[0], other) for other in predicted[1:]])
    return _Tried(schedule, offers, predicted, apart)


def _worst(apart: Array, seen: Mask) -> float:
    """Of the rivals that some visit distinguishes the least separation."""
    return float(np.min(apart[seen])) if seen.any() else float(np.max(apart))


def _picked(
    predicted: Sequence[Predicted], served: Mask, is_unseen: Mask, touches: int
) -> IntArray:
    """Rows of the plan in their order: those that separate rivals, some at every pose, and others.

    Args:
        served: Rivals that some visit distinguishes.
        is_unseen: Laws that differ from the own one at readings where no touch shows it.
    """
    own, *others = predicted
    groups = [
        [one for one, is_one in zip(others, mask, strict=True) if is_one]
        for mask in (served, is_unseen)
    ]
    beside = int(UNSEEN_SHARE * touches) if groups[1] else 0
    picked = set(np.linspace(0, len(own[0]) - 1, int(SPREAD_SHARE * touches)).astype(int).tolist())
    for group, count in zip(groups, (touches - len(picked) - beside, beside), strict=True):
        picked.update(greedy(own, group or others, count))
    return np.array(sorted(picked), dtype=np.int64)


def _power(
    found: Sequence[Hypothesis],
    visits: "_Visits",
    touches: Touches,
    rng: np.random.Generator,
) -> tuple[tuple[RivalPower, ...], float | None]:
    """What the plan does against every rival, and how often the true explanation is decided."""
    predicted, noise = predictions(found, touches), float(np.median(found[0].fit.u))
    apart = np.array([np.inf, *(separation(predicted[0], other) for other in predicted[1:])])
    prior = np.array([one.log_odds for one in found])
    weight = np.exp(-np.maximum(prior, 0.0))
    is_seen = apart >= LEAST_SEPARATION
    decided, odds = 0.0, []
    for _ in range(WEATHERS):
        predicted = predictions(found, visits.with_weather(touches, rng))
        for true in np.flatnonzero(is_seen):
            drawn = log_odds_drawn(predicted, int(true), DRAWS, rng) + prior - prior[true]
            if true == 0:
                odds.append(drawn)
            beside = is_seen & (np.arange(len(found)) != true)
            right = (drawn[:, beside] >= DECIDED).all(axis=1).mean()
            decided += weight[true] * right / WEATHERS / weight[is_seen].sum()
    of_law = np.concatenate(odds)
    rivals = tuple(
        RivalPower(
            effect=one.law,
            log_odds=one.log_odds,
            separation=float(apart[k]),
            difference=float(apart[k] * noise / np.sqrt(len(touches))),
            expected=float(of_law[:, k].mean()),
            power=float((of_law[:, k] >= DECIDED).mean()) if is_seen[k] else None,
            is_unseen=one.is_unseen,
        )
        for k, one in enumerate(found)
        if k
    )
    return rivals, float(decided) if is_seen[1:].any() else None


@dataclass(frozen=True, eq=False)
class _Visits:
    """What a visit of this machine would record besides its touches."""

    run: Run
    sensors: dict[str, Course]  # course of every temperature sensor
    pace: float  # usual time from touch to touch, s

    @classmethod
    def of(cls, run: Run) -> "_Visits":
        t = run.touches
        steps = np.diff(np.sort(t.since_start[t.run == 0]))
        pace = float(np.median(steps)) if np.any(steps > 0.0) else USUAL_PACE
        return cls(run, dict(courses(t)), pace or USUAL_PACE)

    def at(self, touches: Touches, schedule: Schedule, share: float = 1.0) -> Touches:
        """Touches in their order with times and sensors as a schedule makes them.

        Args:
            share: Of the touches that the plan will keep.
        """
        pace = share * self.pace
        time = schedule.times(touches.pose, pace)
        stop = schedule.pause_start(touches.pose, pace)
        warm = {name: c.at(time, schedule, stop) for name, c in self.sensors.items()}
        t = self.run.touches
        rows = self._rows_at(time)
        return replace(
            touches,
            time=time,
            temperature=warm,
            value={name: value[rows] for name, value in t.value.items()},
            spindle_rpm=None if t.spindle_rpm is None else t.spindle_rpm[rows],
            force=None if t.force is None else t.force[rows],
        )

    def _rows_at(self, time: Array) -> IntArray:
        """Rows of the run at these times, for columns of the user's own, speed and load."""
        since = self.run.touches.since_start
        order = np.argsort(since, kind="stable")
        at = np.searchsorted(since[order], np.mod(time, max(float(np.ptp(since)), 1.0)))
        return np.asarray(order[np.minimum(at, len(order) - 1)], dtype=np.int64)

    def with_weather(self, touches: Touches, rng: np.random.Generator) -> Touches:
        """The same visit on another day."""
        shift = float(rng.uniform(0.0, np.ptp(self.run.touches.since_start) or 1.0))
        warm = {
            name: touches.temperature[name] + c.weather_at(touches.time, shift)
            for name, c in self.sensors.items()
        }
        return replace(touches, temperature=warm)
