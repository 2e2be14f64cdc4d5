"""What a standard buys over the artefacts that people have, at equal touches and table poses."""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.layout import Blank, rivals, with_spheres
from matstd.artefact.reach import Requests, joined, spread_poses
from matstd.artefact.worth import (
    BallPlaces,
    Criterion,
    Surfaces,
    TouchOptions,
    Visibility,
    chosen_poses,
    chosen_touches_on,
    pose_quota,
    random_touches,
    some_touches,
    touches_to_choose_from,
)
from matstd.information.criteria import DesignCriterion, Posterior, prior_sd_of_tip
from matstd.information.selection import Selection, exchange, fill
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

_TRIED = 3000  # touches that the ideal scatter may choose from
_DRAWS = 5  # of random touches, averaged

COUNTS = (4, 5, 7, 13)
"""Numbers of spheres that the standard is compared with."""

RIVAL_ROUNDS = 20
"""Looks at all candidates on the way to a rival's relaxed optimum: its exchanges mend the rest, and
a hundred took half a minute a body."""


@dataclass(frozen=True)
class Rival:
    """One artefact at the same number of touches and of table poses, under the same rules.

    Attributes:
        name: What it is.
        rms: Predicted root mean square of the unknown tool point deviation over the probed volume
            after chosen touches, mm.
        p95: 95 % of the poses stay below this, mm.
        rms_user: The same as `rms` over the user's workspace, mm.
        p95_user: The same as `p95` over the user's workspace, mm.
        rms_random: As `rms`, after touches taken at random on the same artefact, mm.
        estimable: Combinations of parameters that are determined (effective degrees of freedom).
        visible: Effects of the library, of those that any touches could show, that these show.
        could_be_visible: Number of effects that any touches could show.
        value: Of the criterion that the touches were chosen by.
        touches: What it is judged by.
        available: Number of different touches among which they were chosen; with fewer than are
            compared, some are made more than once.
        body: What is touched; None for scatter that no body has.
    """

    name: str
    rms: float
    p95: float
    rms_user: float
    p95_user: float
    rms_random: float
    estimable: float
    visible: int
    could_be_visible: int
    value: float
    touches: Requests
    available: int
    body: Standard | None = None


def evaluated(
    name: str,
    criterion: Criterion,
    chosen: Requests,
    random: list[Requests],
    library: Visibility,
    available: int,
    body: Standard | None = None,
) -> Rival:
    """Figures of one artefact after its touches.

    Args:
        name: What it is.
        chosen: Its touches.
        random: Lots of touches taken at random on it, as many in each.
        library: Effects of the library that touches could show.
        available: Number of different touches among which they were chosen.
        body: What is touched; None for scatter that no body has.
    """
    after, rows = _posterior(criterion, chosen), criterion.rows(chosen)
    over = after.predicted_sd(criterion.tip_volume)
    of_user = after.predicted_sd(criterion.tip_user)
    by_chance = [
        rms(_posterior(criterion, lot).predicted_sd(criterion.tip_volume)) for lot in random
    ]
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


def _different(tried: Requests) -> int:
    return len(np.unique(np.column_stack([tried.point, tried.rotary]), axis=0))


def _posterior(criterion: Criterion, touches: Requests) -> Posterior:
    return Posterior(criterion.known_rows(touches), criterion.prior_sd, criterion.model.names)


def prior_rms(criterion: Criterion) -> tuple[float, float]:
    """Root mean square of the expected deviation before any touch, mm: probed volume, user's.

    The set-up counts with what the machine's error ranges say of it, not as unknown.
    """
    return (
        rms(prior_sd_of_tip(criterion.tip_volume, criterion.model.prior_sd)),
        rms(prior_sd_of_tip(criterion.tip_user, criterion.model.prior_sd)),
    )


def compare(
    criterion: Criterion,
    places: BallPlaces | None,
    all_poses: Array,
    blank: Blank,
    options: TouchOptions,
    library: Visibility,
    rng: np.random.Generator,
) -> tuple[tuple[Rival, ...], tuple[str, ...]]:
    """Other artefacts at as many touches: bodies in use, and scatter that no body has.

    Spheres are placed, and table poses and touches on them chosen, as those of the standard are;
    block and face choose theirs from touches drawn at random. The probe needs the same angle,
    travel, room and free way on all, and calibration knows all alike.
    The ideal scatter has points anywhere in the volume and any normal, and nothing is in its way.

    Args:
        places: That balls may have; None where the machine touches none.
        all_poses: Table poses that bodies choose from, (K, R), rad.
        blank: Base, blank and limits of the standard.
        options: Numbers of touches and poses.
        library: Effects of the library that touches could show.

    Returns:
        The artefacts, and the names of those that the blank has no room for, or that this
        machine can make too few touches on.
    """
    out, unreachable = [], []
    for name, body in _bodies(criterion, places, blank, options, rng).items():
        try:
            if body is None:
                raise NotReachable("no room")
            here = criterion.on(body)
            surfaces: Surfaces = (*body.patches, *body.spheres)
            own = chosen_poses(criterion.plain.on(body), body, surfaces, all_poses, options)
            if body.patches:
                tried = some_touches(here, body, own, options, rng)
                chosen = chosen_touches(here, here.objective, tried, options)
            else:
                tried = touches_to_choose_from(here.reach, body, surfaces, own, options.touches)
                mask, _ = chosen_touches_on(here, tried, options, RIVAL_ROUNDS)
                chosen = tried[mask]
        except NotReachable:
            unreachable.append(name)
            continue
        lots = random_lots(tried, options.touches, rng)
        out.append(evaluated(name, here, chosen, lots, library, _different(tried), body))
    tried = _scatter(criterion, spread_poses(all_poses, options.poses), rng)
    lots = random_lots(tried, options.touches, rng)
    for name, objective in (("I", criterion.objectives["I"]), ("D", criterion.objectives["D"])):
        chosen = chosen_touches(criterion, objective, tried, options)
        out.append(
            evaluated(
                f"ideal scatter, chosen by {name}", criterion, chosen, lots, library, len(tried)
            )
        )
    out.append(evaluated("ideal scatter, at random", criterion, lots[0], lots, library, len(tried)))
    return tuple(out), tuple(unreachable)


def _bodies(
    criterion: Criterion,
    places: BallPlaces | None,
    blank: Blank,
    options: TouchOptions,
    rng: np.random.Generator,
) -> dict[str, Standard | None]:
    """Artefacts by name; None for one that the blank has no room for."""
    named: dict[str, Standard | None] = {}
    for count in COUNTS:
        balls = places.best(count, options.touches) if places is not None else []
        there = len(balls) == count
        centres = [ball.centre for ball in balls]
        named[f"{count} spheres"] = with_spheres(blank, centres) if there else None
    return named | rivals(criterion.volume, blank, rng)


def random_lots(tried: Requests, count: int, rng: np.random.Generator) -> list[Requests]:
    """A few lots of touches taken at random from those that could be made."""
    size = min(count, len(tried))
    return [tried[rng.choice(len(tried), size, replace=False)] for _ in range(_DRAWS)]


def chosen_touches(
    criterion: Criterion, objective: DesignCriterion, tried: Requests, options: TouchOptions
) -> Requests:
    """Touches chosen greedily and mended by exchange, with no quota but that of the poses."""
    count = min(options.touches, len(tried))
    quotas = (pose_quota(tried, options.touches),)
    selection = Selection(objective, criterion.rows(tried))
    fill(selection, count, quotas)
    exchange(selection, quotas, most=count // 4)
    return tried[selection.chosen]


def _scatter(criterion: Criterion, poses: Array, rng: np.random.Generator) -> Requests:
    """Points anywhere in the volume with any normal: no artefact, but what one could hope for."""
    reach, volume, each = criterion.reach, criterion.volume, _TRIED // len(poses)
    parts = []
    for pose in poses:
        with suppress(NotReachable):  # at some poses a head reaches none of what it swings above
            parts.append(random_touches(reach, volume, np.stack([pose, pose], axis=-1), each, rng))
    return joined(parts or [random_touches(reach, volume, criterion.rotary, _TRIED, rng)])
