"""Balls and faces of a standard: which of all candidates stand on the blank together.

The balls come first, because they identify; faces are drawn all over the room between them, and of
those that hide nothing of the balls the ones are taken that tell most. A body that breaks a limit
is chosen again without the faces that are to blame.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from artefact.body import DatumSphere, FreeformPatch, MountingHole, Standard, constraints
from artefact.layout import (
    Blank,
    faces_beside,
    faces_fit,
    freeform_faces,
    holes_on,
    least_gap,
    most_side_by_side,
    with_spheres,
)
from artefact.place.room import FEWEST_BALLS, Room, check_room, room_among
from artefact.reach import ProbeReach, Requests, joined, spread_poses
from artefact.worth import BallPlaces, Criterion, each_at, face_grid
from information.selection import best_groups
from twin.errors import NotBuildable, NotReachable
from twin.frames import Array, inverse, turn
from twin.machine import table_to_tool

Which = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Beside:
    """Faces that stand beside some balls, named by their numbers: F.

    Attributes:
        faces: The faces.
        fits: Which of them can stand beside each other, (F, F).
        hides: Share of the touches on the balls that each stands in the way of, (F,).
        poses: Table poses of these touches, (K, R), rad.
    """

    faces: list[FreeformPatch]
    fits: Which
    hides: Array
    poses: Array


_REBUILDS = 8  # choices of faces tried before giving up
_STARTS = 80  # of the search for faces side by side

_ROUNDS, _MORE = 4, 150  # of faces drawn where those drawn first hide touches; so many in each
_HIDDEN = (0.0, 0.005, 0.01, 0.015, 0.02, 0.03, 0.05, 0.1, 1.0)  # of the touches, by a face
_WAY, _SAMPLES = 160.0, 8.0  # mm of the probe above its ball that is looked at, in steps
_POSES = 20  # at which touches on faces are looked at


@dataclass(frozen=True, eq=False)
class BodyChoice:
    """What bodies are chosen from.

    Attributes:
        criterion: What faces are chosen for, without potential terms.
        blank: On which they stand.
        tried: Number of random faces beside each choice of balls.
        rng: Draws them.
        room: Some faces and balls that stand side by side.
        from_side: Whether the probe comes from the side at every table pose.
    """

    criterion: Criterion
    blank: Blank
    tried: int
    rng: np.random.Generator
    room: Room
    from_side: bool

    def standard(
        self,
        name: str,
        serial: str,
        balls: Sequence[DatumSphere],
        touches: Requests,
        count: int,
        proving: int,
    ) -> Standard:
        """The best body of some balls with faces between them that meets every limit.

        Of the faces those are taken first that stand in the way of fewest touches on the balls.

        Args:
            name: Type of the standard.
            serial: Of the piece.
            balls: The first tells most; as many of them as leave room.
            touches: On the balls, that shall stay possible.
            count: Of the faces.
            proving: Touches on all faces together.

        Raises:
            NotBuildable: No such body; what binds.
        """
        wanted = name, serial, touches, count, max(4, proving // count)
        try:
            return self._built(list(balls), *wanted)
        except NotBuildable:
            # where the balls that tell most leave no room, those of which it is known that they do
            return self._built(list(self.room.balls), *wanted)

    def _built(
        self,
        balls: list[DatumSphere],
        name: str,
        serial: str,
        touches: Requests,
        count: int,
        take: int,
    ) -> Standard:
        """A body of some balls with faces between them, chosen again until no limit is broken."""
        limits = self.blank.limits
        standing, holes = self._screwed(balls)
        there, standing = self._beside(standing, holes, touches, count)
        refused, binding = "", list[str]()
        for _ in range(_REBUILDS):
            chosen = self._chosen(there, count, take)
            while len(chosen) < count and len(standing) > FEWEST_BALLS:
                there, standing = self._beside(standing[:-1], holes, touches, count)
                chosen = self._chosen(there, count, take)
            if len(chosen) < count:
                raise NotBuildable(
                    f"only {len(chosen)} of {count} patches fit on the blank beside "
                    f"{len(standing)} balls; between two of them cutter and probe need "
                    f"{least_gap(limits):g} mm{refused}",
                    fitting=len(chosen),
                )
            faces = sorted((there.faces[k] for k in chosen), key=_azimuth_of_face)
            made = self._put_together(name, serial, faces, standing, holes)
            broken = [c for c in constraints(made, limits) if c.slack < 0.0]
            blamed = [c.features for c in broken] or self._untouched(made, there.poses)
            if not blamed:
                return made
            if not broken and not refused:
                self._bar_untouched(there, standing)
            what = broken[0] if broken else f"no touch can be made on {blamed[0][0]}"
            refused, binding = f"; {what}", [c.name for c in broken]
            in_order = [int(face.name) for face in faces]
            for features in blamed:
                _blame(there.fits, features, [p.name for p in made.patches], in_order)
        raise NotBuildable(
            f"no choice of {count} patches meets every limit{refused}", binding=binding
        )

    def _untouched(self, made: Standard, poses: Array) -> list[tuple[str, ...]]:
        """Faces on which the probe finds no way to any of a few touches."""
        reach, tried = self.criterion.reach, _touches_on(list(made.patches), poses)
        tried = tried[reach.is_reachable(tried)]
        there = set(tried[reach.is_clear(made, tried)].feature.tolist())
        return [(patch.name,) for patch in made.patches if patch.name not in there]

    def _bar_untouched(self, there: "_Beside", balls: list[DatumSphere]) -> None:
        """Keep the faces on which no touch can be made beside the balls from being chosen."""
        for k, face in enumerate(there.faces):
            if self._untouched(self._put_together("", "", [face], balls, ()), there.poses):
                there.fits[k, :] = there.fits[:, k] = False

    def _screwed(
        self, balls: list[DatumSphere]
    ) -> tuple[list[DatumSphere], tuple[MountingHole, ...]]:
        """Balls with screw holes beside them; the last is left out until there is room."""
        while True:
            try:
                return balls, holes_on(self.blank, balls)
            except NotBuildable:
                if len(balls) <= FEWEST_BALLS:
                    raise
                balls = balls[:-1]

    def _beside(
        self,
        balls: list[DatumSphere],
        holes: tuple[MountingHole, ...],
        touches: Requests,
        count: int,
    ) -> tuple["_Beside", list[DatumSphere]]:
        """Faces between some balls, and the balls: the last goes until so many faces fit."""
        while True:
            faces = self._drawn(balls, holes, count, self.tried)
            fits = faces_fit(faces, holes, self.blank.limits)
            if (
                len(balls) <= FEWEST_BALLS
                or len(most_side_by_side(fits, count, starts=_STARTS)) == count
            ):
                return self._hiding_least(faces, balls, holes, touches, count), balls
            balls = balls[:-1]  # the last one chosen tells least

    def _drawn(
        self,
        balls: list[DatumSphere],
        holes: tuple[MountingHole, ...],
        count: int,
        tried: int,
    ) -> list[FreeformPatch]:
        """Random faces beside some balls."""
        return freeform_faces(self.blank, count, tried, self.rng, balls, holes, self.from_side)

    def _hiding_least(
        self,
        faces: list[FreeformPatch],
        balls: list[DatumSphere],
        holes: tuple[MountingHole, ...],
        touches: Requests,
        count: int,
    ) -> _Beside:
        """The faces, and some of further rounds that stand least in the way of the touches.

        Rounds follow until so many faces that hide nothing fit side by side.
        """
        poses = spread_poses(np.unique(touches.rotary, axis=0), _POSES)
        first, hides = len(faces), self._in_the_way(faces, touches).mean(axis=1)
        for _ in range(_ROUNDS):
            fits = faces_fit(faces, holes, self.blank.limits)
            free = np.flatnonzero(hides <= _HIDDEN[0])
            if len(most_side_by_side(fits[np.ix_(free, free)], count, starts=_STARTS)) == count:
                break
            more = self._drawn(balls, holes, count, min(self.tried, _MORE))
            hides = np.concatenate([hides, self._in_the_way(more, touches).mean(axis=1)])
            best = first + np.argsort(hides[first:], kind="stable")[: self.tried]
            kept = np.concatenate([np.arange(first), best])
            faces, hides = [(faces + more)[k] for k in kept], hides[kept]
            faces = [replace(face, name=f"{k}") for k, face in enumerate(faces)]
        return _Beside(faces, faces_fit(faces, holes, self.blank.limits), hides, poses)

    def _chosen(self, there: "_Beside", count: int, take: int) -> list[int]:
        """Of the faces that hide fewest touches those worth most; fewer where no other fits."""
        longest = list[int]()
        for most in _HIDDEN:
            free = np.flatnonzero(there.hides <= most)
            fits = there.fits[np.ix_(free, free)]
            found = most_side_by_side(fits, count, starts=_STARTS)
            if len(found) == count:
                some = [there.faces[k] for k in free]
                found = self._worth_most(some, fits, there.poses, count, take)
            if len(found) > len(longest):
                longest = [int(free[i]) for i in found]
            if len(longest) == count:
                break
        return longest

    def rearranged(self, made: Standard, places: BallPlaces, touches: int) -> Standard | None:
        """The same faces with the balls that tell most beside them; None where a limit is broken.

        The faces were put where they hide few touches on the balls; now the balls move to where
        fewest of theirs are hidden.

        Args:
            made: Standard with faces and balls.
            places: That balls may have.
            touches: That will be made on all balls together.
        """
        faces = list(made.patches)
        free = [bool(faces_beside(faces, [ball], self.blank).all()) for ball in places.balls]
        clear = np.array(free)[places.group]
        clear &= ~self._in_the_way(faces, places.touches).any(axis=0)
        if not clear.any():
            return None
        balls = places.best(len(made.spheres), touches, clear)
        try:
            holes = holes_on(self.blank, balls)
        except NotBuildable:
            return None
        again = self._put_together(made.name, made.serial, faces, balls, holes)
        is_whole = len(balls) == len(made.spheres)
        broken = any(c.slack < 0.0 for c in constraints(again, self.blank.limits))
        return again if is_whole and not broken else None

    def _in_the_way(self, faces: list[FreeformPatch], touches: Requests) -> Which:
        """Whether a face stands in the way of the probe at a touch, (F, N)."""
        reach = self.criterion.reach
        frames = table_to_tool(reach.chain, reach.readings(touches))
        axis = turn(inverse(reach.setup.T_table_artefact), frames[:, :3, 2])
        ball = touches.point + reach.radius * touches.normal
        begin, points, radii = 0.0, list[Array](), list[Array]()
        for end, radius in reach.shape.cylinders:
            for at in np.arange(begin, min(end, _WAY), _SAMPLES):
                points.append(ball + at * axis)
                radii.append(np.full(len(ball), radius + reach.room))
            begin = end
        where, least = np.concatenate(points), np.concatenate(radii)
        bare = replace(with_spheres(self.blank, []), patches=tuple(faces))
        near = [column.distance(where) < least for column in bare.columns.values()]
        return np.array([n.reshape(-1, len(ball)).any(axis=0) for n in near])

    def _worth_most(
        self, faces: list[FreeformPatch], fits: Which, poses: Array, count: int, take: int
    ) -> list[int]:
        """The faces worth most; if their neighbours run out, begun from some that all fit."""
        wanted = _touches_on(faces, poses)
        wanted = wanted[self.criterion.reach.is_reachable(wanted)]
        if not len(wanted):
            return []
        W, objective = self.criterion.rows(wanted), self.criterion.objective
        group = np.searchsorted([int(p.name) for p in faces], wanted.feature.astype(np.int64))
        chosen = best_groups(objective, W, group, count, take, apart=fits)
        if len(chosen) < count:
            touched = np.isin(np.arange(len(fits)), group)
            begin = most_side_by_side(fits & touched & touched[:, None], count)
            if len(begin) > len(chosen) and touched[begin].all():
                chosen = best_groups(objective, W, group, count, take, None, fits, begin)
        return chosen

    def _put_together(
        self,
        name: str,
        serial: str,
        faces: list[FreeformPatch],
        balls: list[DatumSphere],
        holes: tuple[MountingHole, ...],
    ) -> Standard:
        """A standard of some faces and balls, each kind named around its middle."""
        balls = sorted(balls, key=lambda b: _azimuth(b.centre))
        return Standard(
            name=name,
            serial=serial,
            material=self.blank.material,
            base=self.blank.base,
            core=None,
            patches=tuple(replace(p, name=f"FF{i}") for i, p in enumerate(faces, 1)),
            spheres=tuple(replace(b, name=f"SPH{i}") for i, b in enumerate(balls, 1)),
            holes=holes,
            blank_height=self.blank.height,
        )


def body_choice(
    places: BallPlaces, poses: Array, faces: int, tried: int, rng: np.random.Generator
) -> BodyChoice:
    """Candidates all over a blank.

    Args:
        places: That balls may have, on the same blank and for the same criterion.
        poses: Table poses to choose from, (K, R), rad.
        faces: How many will be chosen: the more, the smaller they are.
        tried: Number of random faces.
        rng: Draws them.

    Raises:
        NotBuildable: No room for so many faces beside the fewest balls (fact `fitting`).
        NotReachable: No face can be touched.
    """
    criterion, blank = places.criterion, places.blank
    few = spread_poses(poses, _POSES)
    from_side = _is_from_side(criterion.reach, few)
    all_faces = freeform_faces(blank, faces, tried, rng, from_side=from_side)
    room = room_among(all_faces, places.balls, faces, blank)
    check_room(room)
    if not criterion.reach.is_reachable(_touches_on(all_faces, few)).any():
        raise NotReachable(
            f"no face at any of {len(all_faces)} places can be touched at a table pose with every "
            "axis within its travel"
        )
    return BodyChoice(
        criterion=criterion, blank=blank, tried=tried, rng=rng, room=room, from_side=from_side
    )


def _is_from_side(reach: ProbeReach, poses: Array) -> bool:
    """Whether the tool axis never comes within half a right angle of the standard's z."""
    up = np.tile([0.0, 0.0, 1.0], (len(poses), 1))
    at = Requests(np.full(len(poses), "FF1"), np.zeros_like(up), up, poses)
    axis = table_to_tool(reach.chain, reach.readings(at))[:, :3, 2]
    return bool((turn(inverse(reach.setup.T_table_artefact), axis)[:, 2] < np.sqrt(0.5)).all())


def _touches_on(faces: list[FreeformPatch], poses: Array) -> Requests:
    """A few touches on every face."""
    return joined([each_at(p, face_grid(p.half_size, 3)[::2], poses) for p in faces])


def _azimuth_of_face(face: FreeformPatch) -> float:
    return _azimuth(face.T_artefact_patch[:3, 3])


def _azimuth(place: Array) -> float:
    return float(np.arctan2(place[1], place[0]))


def _blame(fits: Which, features: tuple[str, ...], names: list[str], chosen: list[int]) -> None:
    """Keep the faces that violate a limit from being chosen so again."""
    guilty = [chosen[names.index(name)] for name in features if name in names]
    if len(guilty) == 2 and guilty[0] != guilty[1]:
        fits[guilty[0], guilty[1]] = fits[guilty[1], guilty[0]] = False
    else:
        out = guilty or [chosen[-1]]
        fits[out, :] = fits[:, out] = False
