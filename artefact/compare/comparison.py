"""A standard compared with artefacts in use, at equal numbers of touches and table poses.

Every artefact is given its best table poses and touches by the criterion of the standard, so that
the difference in predicted error is due to the bodies alone.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.layout import Blank, rivals, with_spheres
from matstd.artefact.reach import Requests, joined, spread_poses
from matstd.artefact.worth import (
    BallPlaces,
    Criterion,
    TouchOptions,
    Visibility,
    chosen_poses,
    chosen_touches_on,
    pose_quota,
    random_touches,
    some_touches,
    touches_to_choose_from,
)
from matstd.information.criteria import DesignCriterion, prior_sd_of_tip
from matstd.information.selection import Selection, exchange, fill
from matstd.twin.beside import beside
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

_SCATTER_SIZE = 3000  # candidate touches of the ideal scatter
_DRAWS = 5  # of random touches, averaged
COUNTS = (4, 5, 7, 13)  # numbers of spheres of the rivals


@dataclass(frozen=True)
class Rival:
    """One artefact at the same number of touches and of table poses, under the same rules."""

    name: str
    # predicted root mean square of the unknown tool point deviation over the probed volume after
    # chosen touches, mm
    rms: float
    p95: float  # 95 % of the poses stay below this, mm
    rms_user: float  # the same as `rms` over the user's workspace, mm
    p95_user: float  # the same as `p95` over the user's workspace, mm
    rms_random: float  # as `rms`, after random touches on the same artefact, mm
    estimable: float  # effective degrees of freedom: combinations of parameters that are determined
    visible: int  # number of the effects in `could_be_visible` that these touches show
    could_be_visible: int  # number of effects that any touches could show
    value: float  # of the criterion that chose the touches
    touches: Requests
    # number of different candidate touches; if it is smaller than the number of touches, some are
    # repeated
    available: int
    body: Standard | None = None  # the artefact; None for ideal scatter


def evaluate_rival(
    name: str,
    criterion: Criterion,
    chosen: Requests,
    random: list[Requests],
    library: Visibility,
    available: int,
    body: Standard | None = None,
) -> Rival:
    """Figures of an artefact after its touches and random ones; no body is ideal scatter."""
    after, rows = criterion.after(chosen), criterion.rows(chosen)
    over = after.predicted_sd(criterion.tip_volume)
    of_user = after.predicted_sd(criterion.tip_user)
    by_chance = [rms(criterion.after(lot).predicted_sd(criterion.tip_volume)) for lot in random]
    return Rival(
        name=name,
        rms=rms(over),
        p95=float(np.quantile(over, 0.95)),
        rms_user=rms(of_user),
        p95_user=float(np.quantile(of_user, 0.95)),
        rms_random=rms(np.array(by_chance)),
        estimable=after.degrees_of_freedom,
        visible=library.shown(criterion, chosen),
        could_be_visible=len(library.effects),
        value=criterion.objective.value(rows.T @ rows),
        touches=chosen,
        available=available,
        body=body,
    )


def prior_rms(criterion: Criterion) -> tuple[float, float]:
    """Root mean square of the expected deviation before any touch, mm: probed volume, user's.

    The set-up counts with its error range, not as unknown.
    """
    return (
        rms(prior_sd_of_tip(criterion.tip_volume, criterion.model.prior_sd)),
        rms(prior_sd_of_tip(criterion.tip_user, criterion.model.prior_sd)),
    )


@dataclass(frozen=True, eq=False)
class Compared:
    """Other artefacts at as many touches."""

    of_balls: tuple[Rival, ...]  # those of balls alone, on which a standard is built
    # names of those without room on the blank or with too few possible touches
    unreachable: tuple[str, ...]
    # waits for every artefact, in the order in which they are reported
    all: Callable[[], tuple[Rival, ...]]


@contextmanager
def compared(
    criterion: Criterion,
    places: BallPlaces | None,
    all_poses: Array,
    blank: Blank,
    options: TouchOptions,
    library: Visibility,
    rng: np.random.Generator,
    balls: int = COUNTS[-1],
) -> Iterator[Compared]:
    """Other artefacts at as many touches: bodies in use, and ideal scatter.

    Spheres, their table poses and touches are chosen as those of the standard; touches on block and
    face are chosen from random candidates. Angle, travels, clearance and calibration are the same
    for all. The ideal scatter has any points and normals in the volume and no obstacles.

    Two cores share the artefacts of balls; all others are judged by the second one while the first
    goes on.

    Args:
        places: Candidate balls; None where the machine touches none.
        all_poses: Candidate table poses, (K, R), rad.
        balls: Number of balls that the standard may have, one more of the `COUNTS`.
    """
    jobs, unreachable = _jobs(criterion, places, all_poses, blank, options, rng, balls)
    # nothing is drawn from here on
    first = sum(job.is_relaxed for job in jobs)  # artefacts of balls come first
    with beside(_judged, jobs[1:first:2], options, library) as theirs:
        mine, odd = _judged(jobs[:first:2], options, library), theirs()
    of_balls = tuple((odd if k % 2 else mine)[k // 2] for k in range(first))
    with beside(_judged, jobs[first:], options, library) as others:
        yield Compared(of_balls, unreachable, lambda: (*of_balls, *others()))


def _jobs(
    criterion: Criterion,
    places: BallPlaces | None,
    all_poses: Array,
    blank: Blank,
    options: TouchOptions,
    rng: np.random.Generator,
    most: int,
) -> tuple[list["_Job"], tuple[str, ...]]:
    """What is to be judged, with all that is drawn; and the names of what cannot be."""
    jobs, unreachable = list[_Job](), list[str]()
    counts = sorted({*COUNTS, most})
    given = criterion, places, all_poses, blank, options
    with beside(_on_balls, counts[1::2], *given) as theirs:
        on_balls = _on_balls(counts[::2], *given)
        on_balls |= theirs()
    bodies = rivals(criterion.volume, blank, rng)
    for count in counts:
        name = f"{count} spheres"
        if count not in on_balls:
            unreachable.append(name)
            continue
        body, tried = on_balls[count]
        lots = random_lots(tried, options.touches, rng)
        here = criterion.on(body)
        jobs.append(
            _Job(name=name, here=here, tried=tried, lots=lots, by=here.name, is_relaxed=True)
        )
    for name, body in bodies.items():
        try:
            here = criterion.on(body)
            own = chosen_poses(criterion.plain.on(body), body, body.patches, all_poses, options)
            tried = some_touches(here, body, own, options, rng)
        except NotReachable:
            unreachable.append(name)
            continue
        lots = random_lots(tried, options.touches, rng)
        jobs.append(_Job(name=name, here=here, tried=tried, lots=lots, by=here.name))
    tried = _scatter(criterion, spread_poses(all_poses, options.poses), rng)
    lots = random_lots(tried, options.touches, rng)
    for name, by in (("chosen by I", "I"), ("chosen by D", "D"), ("at random", "")):
        jobs.append(
            _Job(name=f"ideal scatter, {name}", here=criterion, tried=tried, lots=lots, by=by)
        )
    return jobs, tuple(unreachable)


def _on_balls(
    counts: Sequence[int],
    criterion: Criterion,
    places: BallPlaces | None,
    all_poses: Array,
    blank: Blank,
    options: TouchOptions,
) -> dict[int, tuple[Standard, Requests]]:
    """The best balls by their number, and the touches on them at the best table poses.

    None of a number for which the blank has no room or too few touches are possible.
    """
    out: dict[int, tuple[Standard, Requests]] = {}
    for count in counts:
        balls = places.best(count, options.touches) if places is not None else []
        if len(balls) != count:
            continue
        body = with_spheres(blank, [b.centre for b in balls])
        with suppress(NotReachable):
            own = chosen_poses(criterion.plain.on(body), body, body.spheres, all_poses, options)
            tried = touches_to_choose_from(
                criterion.reach, body, body.spheres, own, options.touches
            )
            if len(tried) >= options.touches:
                out[count] = body, tried
    return out


@dataclass(frozen=True, eq=False)
class _Job:
    """An artefact whose touches are to be chosen."""

    name: str
    here: Criterion  # criterion on the artefact, or on none
    tried: Requests  # touches that can be made
    lots: list[Requests]  # some of them at random
    by: str  # what they are chosen for, a name in `CRITERIA`; empty for the first lot
    is_relaxed: bool = False  # whether they are chosen as those of the standard


def _judged(jobs: Sequence[_Job], options: TouchOptions, library: Visibility) -> list[Rival]:
    """Figures of artefacts after their chosen touches."""
    out = []
    for job in jobs:
        here, tried, chosen = job.here, job.tried, job.lots[0]
        if job.is_relaxed:
            chosen = tried[chosen_touches_on(here, tried, options)[0]]
        elif job.by:
            chosen = chosen_touches(here, here.objectives[job.by], tried, options)
        available = len(tried)
        if here.body is not None:  # some may be there several times
            available = len(np.unique(np.column_stack([tried.point, tried.rotary]), axis=0))
        out.append(evaluate_rival(job.name, here, chosen, job.lots, library, available, here.body))
    return out


def random_lots(tried: Requests, count: int, rng: np.random.Generator) -> list[Requests]:
    """A few random lots of the possible touches."""
    size = min(count, len(tried))
    return [tried[rng.choice(len(tried), size, replace=False)] for _ in range(_DRAWS)]


def chosen_touches(
    criterion: Criterion, objective: DesignCriterion, tried: Requests, options: TouchOptions
) -> Requests:
    """Touches chosen greedily and improved by exchange, under the quota of the poses alone."""
    count = min(options.touches, len(tried))
    quotas = (pose_quota(tried, options.touches),)
    selection = Selection(objective, criterion.rows(tried))
    fill(selection, count, quotas)
    exchange(selection, quotas, most=count // 4)
    return tried[selection.chosen]


def _scatter(criterion: Criterion, poses: Array, rng: np.random.Generator) -> Requests:
    """Random points and normals in the volume: the upper bound for any artefact."""
    reach, volume, each = criterion.reach, criterion.volume, _SCATTER_SIZE // len(poses)
    parts = []
    for pose in poses:
        with suppress(NotReachable):  # at some poses a swivelling head reaches no touch
            parts.append(random_touches(reach, volume, np.stack([pose, pose], axis=-1), each, rng))
    return joined(parts or [random_touches(reach, volume, criterion.rotary, _SCATTER_SIZE, rng)])
