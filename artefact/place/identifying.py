"""Balls with faces between them, and the touches on the balls by which they identify.

The balls are those of the best rival; faces are drawn beside them, again where they cost more than
a little of the balls' information, and at last balls and table poses are chosen anew beside the
faces that were found.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import DatumSphere, Standard
from matstd.artefact.brief import PlacementOptions
from matstd.artefact.compare import Rival
from matstd.artefact.layout import with_spheres
from matstd.artefact.place.body_choice import BodyChoice
from matstd.artefact.place.proving import touches_on_faces
from matstd.artefact.reach import Mask, ProbeReach, Requests
from matstd.artefact.worth import (
    BallPlaces,
    Criterion,
    TouchOptions,
    chosen_poses,
    chosen_touches_on,
    mended_touches,
    touches_to_choose_from,
)
from matstd.information.selection import Certificate
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array

_BASES = 3  # sets of balls, at most
_AGAIN, _LITTLE = 5, 1.01  # further draws of faces while they cost more than half a percent in µm
_NEXT_TO_NOTHING = 1.005  # times what the balls alone leave


@dataclass(frozen=True, eq=False)
class Base:
    """Balls to build on, touches on them, and the value of these where no face is in the way."""

    balls: tuple[DatumSphere, ...]
    touches: Requests
    value: float


@dataclass(frozen=True, eq=False)
class _Draw:
    """A standard, the touches that can be made on its balls, a quick choice and its value."""

    standard: Standard
    poses: Array
    tried: Requests
    chosen: Mask
    value: float


@dataclass(frozen=True, eq=False)
class Identifying:
    """A standard with the touches that identify by it: those that can be made, the choice."""

    standard: Standard
    poses: Array
    tried: Requests
    chosen: Mask
    nearness: Certificate


def ball_bases(
    criterion: Criterion,
    rivals: tuple[Rival, ...],
    places: BallPlaces,
    all_poses: Array,
    options: PlacementOptions,
) -> list[Base]:
    """Those of the rivals, the best first, or as many balls as find room."""
    of_balls = [
        r
        for r in rivals
        if r.body is not None and not r.body.patches and len(r.body.spheres) <= options.balls
    ]
    if of_balls:
        return [
            Base(r.body.spheres, r.touches, r.value)
            for r in sorted(of_balls, key=lambda r: r.value)
            if r.body is not None
        ]
    balls = places.best(options.balls, options.choice.touches)
    body = with_spheres(places.blank, [b.centre for b in balls])
    poses = chosen_poses(criterion.on(body), body, body.spheres, all_poses, options.choice)
    tried = touches_to_choose_from(
        criterion.reach, body, body.spheres, poses, options.choice.touches
    )
    return [Base(body.spheres, tried, 0.0)]


def identifying(
    criterion: Criterion, bodies: BodyChoice, bases: list[Base], options: PlacementOptions
) -> Identifying:
    """Balls with faces between them, of some draws those that cost least, and their touches.

    What faces cost is first estimated by what they leave of the touches that were chosen on the
    balls alone, filled up and exchanged: within half a percent of the whole search, in a tenth of
    its time.
    """
    found = _drawn(criterion, bodies, bases, options)
    here = criterion.on(replace(found.standard, patches=()))
    chosen, nearness = chosen_touches_on(here, found.tried, options.choice, begin=found.chosen)
    return Identifying(
        standard=found.standard,
        poses=found.poses,
        tried=found.tried,
        chosen=chosen,
        nearness=nearness,
    )


def _drawn(
    criterion: Criterion, bodies: BodyChoice, bases: list[Base], options: PlacementOptions
) -> _Draw:
    """The best of a few draws; one where it costs little or none compares."""
    best, alone = _draw(criterion, bodies, bases, options), bases[0].value
    for _ in range(_AGAIN if alone else 0):
        if best.value <= _LITTLE * alone:
            break
        with suppress(NotBuildable, NotReachable):  # what the first draw found stays
            again = _draw(criterion, bodies, bases, options)
            best = min(best, again, key=lambda draw: draw.value)
    return best


def _draw(
    criterion: Criterion, bodies: BodyChoice, bases: list[Base], options: PlacementOptions
) -> _Draw:
    """The best balls that leave room for the faces, and the touches that are left on them.

    Where every ball of a base stays nothing better is looked for; where some had to go, the next
    base is tried as well.
    """
    best: _Draw | None = None
    choice, refused = options.choice, NotReachable("no ball")
    for base in bases[:_BASES]:
        poses = np.unique(base.touches.rotary, axis=0)
        standard = bodies.standard(
            options.name, options.serial, base.balls, base.touches, options.patches, choice.proof
        )
        here, reach = criterion.on(replace(standard, patches=())), criterion.reach
        tried = touches_to_choose_from(reach, standard, standard.spheres, poses, choice.touches)
        try:
            chosen, value = mended_touches(here, tried, base.touches, choice)
        except NotReachable as error:
            refused = error
            continue
        if best is None or value < best.value:
            best = _Draw(standard=standard, poses=poses, tried=tried, chosen=chosen, value=value)
        if len(standard.spheres) == len(base.balls):
            break
    if best is None:
        raise refused
    return best


def rearranged(
    criterion: Criterion,
    bodies: BodyChoice,
    places: BallPlaces,
    found: Identifying,
    alone: float,
    all_poses: Array,
    choice: TouchOptions,
) -> Identifying:
    """The same faces with balls and table poses chosen anew beside them, if that is better.

    Nothing is tried where the faces cost next to nothing of what the balls alone are worth.
    """
    if found.nearness.value <= _NEXT_TO_NOTHING * alone:
        return found
    standard = bodies.rearranged(found.standard, places, choice.touches)
    if standard is None:
        return found
    bare = replace(standard, patches=())
    plain, here = criterion.plain.on(bare), criterion.on(bare)
    try:
        poses = chosen_poses(plain, standard, standard.spheres, all_poses, choice)
        tried = touches_to_choose_from(
            here.reach, standard, standard.spheres, poses, choice.touches
        )
        chosen, nearness = chosen_touches_on(here, tried, choice)
    except NotReachable:
        return found
    if nearness.value >= found.nearness.value:
        return found
    return Identifying(
        standard=standard, poses=poses, tried=tried, chosen=chosen, nearness=nearness
    )


def with_proof(
    choices: list[Identifying], reach: ProbeReach, count: int
) -> tuple[Identifying, Requests]:
    """The first choice on whose faces touches enough can be made, or the last; those touches."""
    for found in choices:
        on_faces = touches_on_faces(reach, found.standard, found.poses, count)
        if len(on_faces) >= count:
            break
    return found, on_faces
