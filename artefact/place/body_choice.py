"""Choice of balls and faces of a standard among all candidates.

The balls come first, because they identify. Faces are drawn at random between them, and of those
that hide fewest touches on the balls the most informative are taken. A body that violates a limit
is chosen again without the faces that cause the violation.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, MountingHole, Standard, constraints
from matstd.artefact.feasibility import (
    FEWEST_BALLS,
    Room,
    check_room,
    in_the_way,
    is_from_side,
    lightest_room,
    mass_per_face,
    mutually_probeable,
    room_among,
    touches_on,
    untouchable_faces,
)
from matstd.artefact.layout import (
    Blank,
    faces_beside,
    faces_fit,
    freeform_faces,
    holes_on,
    least_gap,
    most_side_by_side,
    with_spheres,
)
from matstd.artefact.reach import Requests, spread_poses
from matstd.artefact.worth import BallPlaces, Criterion
from matstd.information.selection import best_groups
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array, Mask


@dataclass(frozen=True, eq=False)
class _FacePool:
    """Candidate faces beside some balls, named by their numbers: F."""

    faces: list[FreeformPatch]
    fits: Mask  # which of them fit beside each other, (F, F)
    hides: Array  # share of the touches on the balls that each face obstructs, (F,)
    poses: Array  # table poses of these touches, (K, R), rad


@dataclass(frozen=True)
class _Demands:
    """What is asked of faces; some of it only after a body was refused for lack of it."""

    count: int  # of faces
    take: int  # touches on each face by which its worth is judged
    touches: Requests  # on the balls, which faces may hide
    light: bool = False  # faces keep the standard within its mass limit
    seen: bool = False  # faces can be probed beside each other

    def fewer(self, balls: list[DatumSphere]) -> list[DatumSphere]:
        """The balls without the last one, or half of them where each trial takes seconds."""
        return balls[: max(FEWEST_BALLS, len(balls) // 2)] if self.seen else balls[:-1]


_REBUILDS = 8  # choices of faces before giving up
_STARTS = 80  # starts of the search for faces side by side

_HIDDEN_SHARES = (
    0.0,
    0.005,
    0.01,
    0.02,
    0.05,
    0.1,
    1.0,
)  # of the touches on balls that a face may hide, tried in this order
_POSES = 20  # table poses for touches on faces


@dataclass(frozen=True, eq=False)
class BodyChoice:
    """Candidates and criterion of the choice of bodies."""

    criterion: Criterion  # what faces are chosen for, without potential terms
    blank: Blank
    tried: int  # number of random faces beside each choice of balls
    rng: np.random.Generator
    room: Room  # faces and balls that are known to fit side by side
    from_side: bool  # whether the probe approaches from the side at every table pose

    def standard(
        self,
        name: str,
        serial: str,
        balls: Sequence[DatumSphere],
        touches: Requests,
        count: int,
        proving: int,
    ) -> Standard:
        """Choose faces between balls such that the body meets every limit.

        Args:
            balls: The most informative first; those that leave room for the faces are used.

        Raises:
            NotBuildable: No such body; names the binding limit.
        """
        asked = _Demands(count, max(4, proving // count), touches)
        try:
            return self._build(name, serial, list(balls), asked)
        except NotBuildable:
            # the most informative balls leave no room: use those that are known to fit
            return self._build(name, serial, list(self.room.balls), asked)

    def _build(self, name: str, serial: str, balls: list[DatumSphere], asked: _Demands) -> Standard:
        """A body with faces between the balls, chosen again until no limit is violated."""
        limits, count = self.blank.limits, asked.count
        standing, holes = self._with_holes(balls)
        there, standing = self._faces_between(standing, holes, asked)
        refused, binding = "", list[str]()
        for _ in range(_REBUILDS):
            chosen = self._choose_faces(there, asked)
            while len(chosen) < count and len(standing) > FEWEST_BALLS:
                there, standing = self._faces_between(asked.fewer(standing), holes, asked)
                chosen = self._choose_faces(there, asked)
            if len(chosen) < count:
                raise NotBuildable(
                    f"only {len(chosen)} of {count} patches fit on the blank beside "
                    f"{len(standing)} balls; between two of them cutter and probe need "
                    f"{least_gap(limits):g} mm{refused}",
                    fitting=len(chosen),
                )
            faces = [there.faces[k] for k in chosen]
            faces.sort(key=lambda face: _azimuth(face.T_artefact_patch[:3, 3]))
            made = assembled(self.blank, name, serial, faces, standing, holes)
            broken = [c for c in constraints(made, limits) if c.slack < 0.0]
            blamed = [c.features for c in broken]
            blamed = blamed or [
                (f,) for f in untouchable_faces(self.criterion.reach, made, there.poses)
            ]
            if not blamed:
                return made
            what = broken[0] if broken else f"no touch can be made on {blamed[0][0]}"
            refused, binding = f"; {what}", [c.name for c in broken]
            if "mass" in binding and not asked.light:
                asked = replace(asked, light=True)
                there, standing = self._faces_between(standing, holes, asked)
                continue
            if not broken and not asked.seen:
                asked = replace(asked, seen=True)
                there.fits[:] &= self._probeable(there.faces, standing, there.poses)
            in_order = [int(face.name) for face in faces]
            for features in blamed:
                _blame(there.fits, features, [p.name for p in made.patches], in_order)
        raise NotBuildable(
            f"no choice of {count} patches meets every limit{refused}", binding=binding
        )

    def _probeable(
        self, faces: list[FreeformPatch], balls: list[DatumSphere], poses: Array
    ) -> Mask:
        return mutually_probeable(self.criterion.reach, self.blank, faces, balls, poses).beside

    def _with_holes(
        self, balls: list[DatumSphere]
    ) -> tuple[list[DatumSphere], tuple[MountingHole, ...]]:
        """Balls and screw holes; balls are dropped from the end until the holes fit."""
        while True:
            try:
                return balls, holes_on(self.blank, balls)
            except NotBuildable:
                if len(balls) <= FEWEST_BALLS:
                    raise
                balls = balls[:-1]

    def _faces_between(
        self, balls: list[DatumSphere], holes: tuple[MountingHole, ...], asked: _Demands
    ) -> tuple[_FacePool, list[DatumSphere]]:
        """Candidate faces, and the balls: dropped from the end until enough faces fit."""
        count, touches = asked.count, asked.touches
        poses = spread_poses(np.unique(touches.rotary, axis=0), _POSES)
        while True:
            heaviest = mass_per_face(self.blank, balls, holes, count) if asked.light else np.inf
            try:
                faces = freeform_faces(
                    self.blank, count, self.tried, self.rng, balls, holes, self.from_side, heaviest
                )
            except NotBuildable:  # none is light enough
                if not asked.light or len(balls) <= FEWEST_BALLS:
                    raise
                balls = asked.fewer(balls)
                continue
            fits = faces_fit(faces, holes, self.blank.limits)
            if asked.seen:
                fits &= self._probeable(faces, balls, poses)
            if (
                len(balls) <= FEWEST_BALLS
                or len(most_side_by_side(fits, count, starts=_STARTS)) == count
            ):
                reach = self.criterion.reach
                hides = in_the_way(reach, self.blank, faces, touches).mean(axis=1)
                return _FacePool(faces, fits, hides, poses), balls
            balls = asked.fewer(balls)

    def _choose_faces(self, there: _FacePool, asked: _Demands) -> list[int]:
        """The most informative of the faces that hide fewest touches; fewer where no more fit."""
        longest, count = list[int](), asked.count
        for most in _HIDDEN_SHARES:
            free = np.flatnonzero(there.hides <= most)
            fits = there.fits[np.ix_(free, free)]
            found = most_side_by_side(fits, count, starts=_STARTS)
            if len(found) == count:
                some = [there.faces[k] for k in free]
                found = self._most_informative(some, fits, there.poses, asked)
            if len(found) > len(longest):
                longest = [int(free[i]) for i in found]
            if len(longest) == count:
                break
        return longest

    def _most_informative(
        self, faces: list[FreeformPatch], fits: Mask, poses: Array, asked: _Demands
    ) -> list[int]:
        """The most informative faces; if too few fit beside them, starting from a set that fits."""
        wanted = touches_on(faces, poses)
        wanted = wanted[self.criterion.reach.is_reachable(wanted)]
        if not len(wanted):
            return []
        W, objective = self.criterion.rows(wanted), self.criterion.objective
        count, take = asked.count, asked.take
        group = np.searchsorted([int(p.name) for p in faces], wanted.feature.astype(np.int64))
        chosen = best_groups(objective, W, group, count, take, apart=fits)
        if len(chosen) < count:
            touched = np.isin(np.arange(len(fits)), group)
            begin = most_side_by_side(fits & touched & touched[:, None], count)
            if len(begin) > len(chosen) and touched[begin].all():
                chosen = best_groups(objective, W, group, count, take, None, fits, begin)
        return chosen


def balls_beside(
    faces: Sequence[FreeformPatch], count: int, places: BallPlaces, touches: int
) -> Standard | None:
    """The most informative balls beside some faces; None where a limit is violated or few fit.

    Only balls count that leave room beside the faces, and touches that no face obstructs.

    Args:
        touches: Number that will be made on the balls.
    """
    blank, pillars = places.blank, list(faces)
    clear = np.ones(len(places.group), dtype=bool)
    if pillars:
        free = [bool(faces_beside(pillars, [ball], blank).all()) for ball in places.balls]
        clear = np.array(free)[places.group]
        reach = places.criterion.reach
        clear[clear] = ~in_the_way(reach, blank, pillars, places.touches[clear]).any(axis=0)
    if not clear.any():
        return None
    balls = places.best(count, touches, clear)
    try:
        holes = holes_on(blank, balls, pillars if len(pillars) == 1 else ())
    except NotBuildable:
        return None
    made = assembled(blank, "", "", pillars, balls, holes)
    broken = any(c.slack < 0.0 for c in constraints(made, blank.limits))
    return None if len(balls) < count or broken else made


def assembled(
    blank: Blank,
    name: str,
    serial: str,
    faces: list[FreeformPatch],
    balls: list[DatumSphere],
    holes: tuple[MountingHole, ...],
) -> Standard:
    """A standard of faces and balls, numbered by their azimuth; those that prove come last."""
    balls = sorted(balls, key=lambda b: (b.proves, _azimuth(b.centre)))
    return replace(
        with_spheres(blank, []),
        name=name,
        serial=serial,
        patches=tuple(replace(p, name=f"FF{i}") for i, p in enumerate(faces, 1)),
        spheres=tuple(replace(b, name=f"SPH{i}") for i, b in enumerate(balls, 1)),
        holes=holes,
    )


def body_choice(
    places: BallPlaces, poses: Array, faces: int, tried: int, rng: np.random.Generator
) -> BodyChoice:
    """Candidates on a whole blank.

    Args:
        places: Candidate balls on the same blank and for the same criterion.
        poses: Candidate table poses, (K, R), rad.
        faces: How many will be chosen: the more, the smaller they are.

    Raises:
        NotBuildable: No room for so many faces beside the fewest balls (fact `fitting`).
        NotReachable: No face can be touched.
    """
    criterion, blank = places.criterion, places.blank
    few = spread_poses(poses, _POSES)
    from_side = is_from_side(criterion.reach, few)
    all_faces = freeform_faces(blank, faces, tried, rng, from_side=from_side)
    room = room_among(all_faces, places.balls, faces, blank)
    room = lightest_room(room, all_faces, places.balls)
    check_room(room)
    if not criterion.reach.is_reachable(touches_on(all_faces, few)).any():
        raise NotReachable(
            f"no face at any of {len(all_faces)} places can be touched at a table pose with every "
            "axis within its travel"
        )
    return BodyChoice(
        criterion=criterion, blank=blank, tried=tried, rng=rng, room=room, from_side=from_side
    )


def _azimuth(place: Array) -> float:
    return float(np.arctan2(place[1], place[0]))


def _blame(fits: Mask, features: tuple[str, ...], names: list[str], chosen: list[int]) -> None:
    """Exclude the faces, or the pair of faces, that violate a limit."""
    guilty = [chosen[names.index(name)] for name in features if name in names]
    if len(guilty) == 2 and guilty[0] != guilty[1]:
        fits[guilty[0], guilty[1]] = fits[guilty[1], guilty[0]] = False
    else:
        out = guilty or [chosen[-1]]
        fits[out, :] = fits[:, out] = False
