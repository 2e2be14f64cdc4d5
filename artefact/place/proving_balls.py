"""Balls alone: those that identify best, and further balls between them that prove.

A touch on a ball that identifies shares the calibration of that ball with the model. Balls that
prove are of their own, as far from all others as the base allows: they show what the machine does
between the balls that its model rests on.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.artefact.body import DatumSphere, Standard, check
from matstd.artefact.brief import PlacementOptions
from matstd.artefact.layout import Blank, balls_fit, holes_on
from matstd.artefact.place.body_choice import assembled
from matstd.artefact.place.identifying import Base, Identifying, Site
from matstd.artefact.reach import Requests
from matstd.artefact.worth import BallPlaces, Criterion, repaired_touches, touches_to_choose_from
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array

_MOST_COST = 1.02  # of a mean variance: 1 % of an error
CANDIDATES_PER_TOUCH = 4  # touches on the balls that prove from which each is chosen


def balls_alone(site: Site) -> Identifying:
    """The best balls with as many that prove as faces are wanted, or fit, or hide few touches.

    The largest number is taken that costs the criterion no more than `_MOST_COST` by a quick
    choice of touches; of one set of balls at least one that proves, whatever it costs.

    Raises:
        NotBuildable: No ball that proves fits beside those that identify.
    """
    refused: list[str] = []
    for base in site.bases:
        beside = _most_apart(base.balls, site.places, site.options.patches)
        for count in range(len(beside), 0, -1):
            try:
                made = _standing([*base.balls, *beside[:count]], site.places.blank, site.options)
                found = _quick_choice(site, made, base)
            except (NotBuildable, NotReachable) as error:
                refused.append(str(error))
                continue
            if count == 1 or not base.value or found.value <= _MOST_COST * base.value:
                return found.searched(site.criterion, site.options.choice)
    why = refused[-1] if refused else "no place is left"
    raise NotBuildable(f"no balls that prove beside those that identify: {why}")


def proving_on_balls(
    criterion: Criterion, standard: Standard, poses: Array, count: int
) -> Requests:
    """Possible touches on the balls that prove; raises NotReachable for fewer than `count`."""
    balls = tuple(ball for ball in standard.spheres if ball.proves)
    wanted = CANDIDATES_PER_TOUCH * count
    tried = touches_to_choose_from(criterion.reach, standard, balls, poses, wanted)
    if len(tried) < count:
        raise NotReachable(
            f"{len(tried)} touches can be made on the balls that prove, {count} are wanted"
        )
    return tried


def _standing(balls: list[DatumSphere], blank: Blank, options: PlacementOptions) -> Standard:
    """A standard of balls with its screws; raises NotBuildable without room, or beyond a limit."""
    made = assembled(blank, options.name, options.serial, [], balls, holes_on(blank, balls))
    check(made, blank.limits)
    return made


def _most_apart(balls: Sequence[DatumSphere], places: BallPlaces, count: int) -> list[DatumSphere]:
    """Candidate balls that can be touched, each as far as possible from all before it.

    Only the lower half: a high post between the others hides their touches.
    """
    free = [places.balls[k] for k in np.unique(places.group)]
    highest = np.median([ball.centre[2] for ball in free])
    there = [*balls, *(ball for ball in free if ball.centre[2] <= highest)]
    centre, fits = np.stack([ball.centre for ball in there]), balls_fit(there, places.blank)
    chosen = list(range(len(balls)))
    for _ in range(count):
        apart = np.linalg.norm(centre[:, None] - centre[chosen], axis=-1).min(axis=1)
        apart[~fits[:, chosen].all(axis=1)] = -np.inf
        apart[chosen] = -np.inf
        best = int(np.argmax(apart))
        if not np.isfinite(apart[best]):
            break
        chosen.append(best)
    return [replace(there[k], proves=True) for k in chosen[len(balls) :]]


def _quick_choice(site: Site, made: Standard, base: Base) -> Identifying:
    """Touches on the best balls that the new ones leave, and a quick choice of them."""
    own = tuple(ball for ball in made.spheres if not ball.proves)
    poses, choice = np.unique(base.touches.rotary, axis=0), site.options.choice
    criterion = site.criterion
    tried = touches_to_choose_from(criterion.reach, made, own, poses, choice.touches)
    chosen, nearness = repaired_touches(criterion.on(made), tried, base.touches, choice)
    return Identifying(standard=made, poses=poses, tried=tried, chosen=chosen, nearness=nearness)
