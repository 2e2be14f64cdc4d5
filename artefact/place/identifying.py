"""Balls with faces between them, and the touches on the balls by which they identify.

The balls are those of the best rival. Faces are drawn beside them, and drawn again while they cost
more than 1 % of the criterion. Finally balls and table poses are chosen anew beside the faces.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.artefact.body import DatumSphere, Standard
from matstd.artefact.brief import Brief, PlacementOptions
from matstd.artefact.compare import Rival
from matstd.artefact.hidden import possible_places
from matstd.artefact.layout import with_spheres
from matstd.artefact.place.body_choice import BodyChoice, balls_beside
from matstd.artefact.place.proving import touches_on_faces
from matstd.artefact.reach import ProbeReach, Requests
from matstd.artefact.worth import (
    BallPlaces,
    Criterion,
    TouchOptions,
    chosen_poses,
    chosen_touches_on,
    repaired_touches,
    touches_to_choose_from,
)
from matstd.information.selection import Certificate
from matstd.twin.compute import Progress
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array, Mask

_MAX_BASES = 3  # sets of balls, at most
_MAX_REDRAWS, _GOOD_ENOUGH = (
    5,
    1.01,
)  # further draws of faces, while they cost more (half a percent in µm)
_NEGLIGIBLE_COST = 1.005  # of the value of the balls alone, up to which nothing more is tried


@dataclass(frozen=True, eq=False)
class Base:
    """Balls to build on, touches on them, and the value of these without any face."""

    balls: tuple[DatumSphere, ...]
    touches: Requests
    value: float


@dataclass(frozen=True, eq=False)
class Identifying:
    """A standard with the possible touches on its balls, and the chosen ones."""

    standard: Standard
    poses: Array
    tried: Requests
    chosen: Mask
    nearness: Certificate  # how near the choice is to the best one; a quick choice has no bound

    @property
    def value(self) -> float:
        """Of the criterion, smaller is better."""
        return self.nearness.value

    def searched(self, criterion: Criterion, options: TouchOptions) -> "Identifying":
        """The same standard after the whole search; its choice stays where none is better."""
        here = criterion.on(replace(self.standard, patches=()))
        chosen, nearness = chosen_touches_on(here, self.tried, options, begin=self.chosen)
        return replace(self, chosen=chosen, nearness=nearness)


@dataclass(frozen=True, eq=False)
class Site:
    """What all families of one design share: candidates, criterion, rivals."""

    brief: Brief
    criterion: Criterion
    places: BallPlaces
    bodies: BodyChoice | None  # candidate small faces; None where none is wanted or none fits
    rivals: tuple[Rival, ...]
    all_poses: Array  # candidate table poses, (K, R), rad
    progress: Progress

    @property
    def options(self) -> PlacementOptions:
        """Wishes of the project."""
        return self.brief.options

    @cached_property
    def bases(self) -> list[Base]:
        """Balls to build on, the best first."""
        return _ball_bases(self)

    @cached_property
    def effects_at(self) -> Array:
        """Where bumps may be, readings of the linear axes, (K, 3), mm."""
        rng, volume = np.random.default_rng(0), self.criterion.volume
        return possible_places(self.brief.reach, volume, self.all_poses, rng)

    @property
    def best_balls(self) -> float:
        """Error over the workspace that the best balls alone leave, mm; infinite without any."""
        alone = [r.rms_user for r in self.rivals if r.body is not None and not r.body.patches]
        return min(alone, default=np.inf)


def _ball_bases(site: Site) -> list[Base]:
    """Balls of the rivals, the best first, or as many balls as fit."""
    criterion, places, options = site.criterion.plain, site.places, site.options
    of_balls = [
        r
        for r in site.rivals
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
    poses = chosen_poses(criterion.on(body), body, body.spheres, site.all_poses, options.choice)
    tried = touches_to_choose_from(
        criterion.reach, body, body.spheres, poses, options.choice.touches
    )
    return [Base(body.spheres, tried, 0.0)]


def identifying_choices(site: Site, bodies: BodyChoice) -> list[Identifying]:
    """Balls with the faces that cost least of some draws, and their touches; the best first.

    The cost of faces is first estimated from the touches on the balls alone that remain possible,
    completed and exchanged: within half a percent of the whole search, in a tenth of its time. Then
    balls and table poses are also chosen anew beside the same faces, unless the faces cost a
    negligible part of the value of the balls alone.
    """
    drawn = _best_draw(site, bodies)
    site.progress("faces", _MAX_REDRAWS + 1, _MAX_REDRAWS + 2)
    first = drawn.searched(site.criterion, site.options.choice)
    if first.value <= _NEGLIGIBLE_COST * site.bases[0].value:
        return [first]
    other = _with_moved_balls(site, drawn.standard)
    if other is None or other.value >= first.value:
        return [first]
    return [other, first]


def _best_draw(site: Site, bodies: BodyChoice) -> Identifying:
    """The best of a few draws; a single one where it costs little or nothing compares."""
    site.progress("faces", 0, _MAX_REDRAWS + 2)
    best, alone = _draw(site, bodies), site.bases[0].value
    for k in range(_MAX_REDRAWS if alone else 0):
        site.progress("faces", k + 1, _MAX_REDRAWS + 2)
        if best.value <= _GOOD_ENOUGH * alone:
            break
        with suppress(NotBuildable, NotReachable):  # the first draw stays
            again = _draw(site, bodies)
            best = min(best, again, key=lambda draw: draw.value)
    return best


def _draw(site: Site, bodies: BodyChoice) -> Identifying:
    """The best balls that leave room for the faces, and the touches that remain on them.

    The next base is tried only where some balls had to be dropped.
    """
    best: Identifying | None = None
    options, criterion, refused = site.options, site.criterion, NotReachable("no ball")
    choice = options.choice
    for base in site.bases[:_MAX_BASES]:
        poses = np.unique(base.touches.rotary, axis=0)
        standard = bodies.standard(
            options.name, options.serial, base.balls, base.touches, options.patches, choice.proof
        )
        here, reach = criterion.on(replace(standard, patches=())), criterion.reach
        tried = touches_to_choose_from(reach, standard, standard.spheres, poses, choice.touches)
        try:
            chosen, nearness = repaired_touches(here, tried, base.touches, choice)
        except NotReachable as error:
            refused = error
            continue
        if best is None or nearness.value < best.value:
            best = Identifying(
                standard=standard, poses=poses, tried=tried, chosen=chosen, nearness=nearness
            )
        if len(standard.spheres) == len(base.balls):
            break
    if best is None:
        raise refused
    return best


def _with_moved_balls(site: Site, standard: Standard) -> Identifying | None:
    """The same faces with balls and table poses chosen anew; None where a limit is violated.

    The faces were placed to hide few touches on the balls; now the balls move to where fewest of
    theirs are hidden.
    """
    touches = site.options.choice.touches
    again = balls_beside(standard.patches, len(standard.spheres), site.places, touches)
    if again is None:
        return None
    standard = replace(again, name=standard.name, serial=standard.serial)
    try:
        return identifying_on(site, standard)
    except NotReachable:
        return None


def identifying_on(site: Site, standard: Standard) -> Identifying:
    """Table poses and touches on the balls of a standard."""
    bare, balls = replace(standard, patches=()), standard.spheres
    criterion, choice = site.criterion, site.options.choice
    poses = chosen_poses(criterion.plain.on(bare), standard, balls, site.all_poses, choice)
    tried = touches_to_choose_from(criterion.reach, standard, balls, poses, choice.touches)
    chosen, nearness = chosen_touches_on(criterion.on(bare), tried, choice)
    return Identifying(
        standard=standard, poses=poses, tried=tried, chosen=chosen, nearness=nearness
    )


def left_unknown(criterion: Criterion, standard: Standard, touches: Requests) -> Array:
    """Error of the tool point at poses of the workspace after touches on balls, (M,), mm."""
    here = criterion.on(replace(standard, patches=()))
    return here.after(touches).predicted_sd(here.tip_user)


def with_proof(
    choices: list[Identifying], reach: ProbeReach, count: int
) -> tuple[Identifying, Requests]:
    """The first choice with enough possible touches on its faces, or the last; those touches."""
    for found in choices:
        on_faces = touches_on_faces(reach, found.standard, found.poses, count)
        if len(on_faces) >= count:
            break
    return found, on_faces
