"""Balls and faces of a standard: which of all candidates stand on the blank together.

The balls come first, because they identify; faces are drawn all over the room between them, and of
those that hide nothing of the balls the most informative are taken. A body that breaks a limit
is chosen again without the faces that are to blame.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from matstd.artefact.body import DatumSphere, FreeformPatch, MountingHole, Standard, constraints
from matstd.artefact.feasibility import (
    FEWEST_BALLS,
    Room,
    check_room,
    in_the_way,
    is_from_side,
    light_enough,
    mutually_probeable,
    room_among,
    share_of_mass,
    touches_on,
    untouched,
)
from matstd.artefact.layout import (
    Blank,
    faces_beside,
    faces_fit,
    freeform_faces,
    holes_on,
    least_gap,
    most_side_by_side,
)
from matstd.artefact.reach import Requests, spread_poses
from matstd.artefact.worth import BallPlaces, Criterion
from matstd.information.selection import best_groups
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array

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


@dataclass(frozen=True)
class _Asked:
    """What is asked of faces beyond room, once a body without it was refused.

    Attributes:
        light: That they leave the standard within its mass.
        seen: That the probe can touch them beside each other.
    """

    light: bool = False
    seen: bool = False

    def fewer(self, balls: list[DatumSphere]) -> list[DatumSphere]:
        """The balls without the least informative: one, or half where each look takes seconds."""
        return balls[: max(FEWEST_BALLS, len(balls) // 2)] if self.seen else balls[:-1]


_REBUILDS = 8  # choices of faces tried before giving up
_STARTS = 80  # of the search for faces side by side

_HIDDEN = (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 1.0)  # of the touches, that a face may hide
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
            balls: The most informative first; as many of them as leave room.
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
            # where the most informative balls leave no room, those that are known to leave some
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
        limits, asked = self.blank.limits, _Asked()
        standing, holes = self._screwed(balls)
        there, standing = self._beside(standing, holes, touches, count, asked)
        refused, binding = "", list[str]()
        for _ in range(_REBUILDS):
            chosen = self._chosen(there, count, take)
            while len(chosen) < count and len(standing) > FEWEST_BALLS:
                there, standing = self._beside(asked.fewer(standing), holes, touches, count, asked)
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
            blamed = [c.features for c in broken]
            blamed = blamed or [(f,) for f in untouched(self.criterion.reach, made, there.poses)]
            if not blamed:
                return made
            what = broken[0] if broken else f"no touch can be made on {blamed[0][0]}"
            refused, binding = f"; {what}", [c.name for c in broken]
            if "mass" in binding and not asked.light:
                asked = replace(asked, light=True)
                there, standing = self._beside(standing, holes, touches, count, asked)
                continue
            if not broken and not asked.seen:
                asked = replace(asked, seen=True)
                there.fits[:] &= self._seen(there.faces, standing, there.poses)
            in_order = [int(face.name) for face in faces]
            for features in blamed:
                _blame(there.fits, features, [p.name for p in made.patches], in_order)
        raise NotBuildable(
            f"no choice of {count} patches meets every limit{refused}", binding=binding
        )

    def _seen(self, faces: list[FreeformPatch], balls: list[DatumSphere], poses: Array) -> Which:
        return mutually_probeable(self.criterion.reach, self.blank, faces, balls, poses).beside

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
        asked: "_Asked",
    ) -> tuple["_Beside", list[DatumSphere]]:
        """Faces between some balls, and the balls: the last goes until so many faces fit."""
        poses = spread_poses(np.unique(touches.rotary, axis=0), _POSES)
        while True:
            heaviest = share_of_mass(self.blank, balls, holes, count) if asked.light else np.inf
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
                fits &= self._seen(faces, balls, poses)
            if (
                len(balls) <= FEWEST_BALLS
                or len(most_side_by_side(fits, count, starts=_STARTS)) == count
            ):
                reach = self.criterion.reach
                hides = in_the_way(reach, self.blank, faces, touches).mean(axis=1)
                return _Beside(faces, fits, hides, poses), balls
            balls = asked.fewer(balls)

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
        """The same faces with the most informative balls beside them; None where a limit is broken.

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
        clear &= ~in_the_way(self.criterion.reach, self.blank, faces, places.touches).any(axis=0)
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

    def _worth_most(
        self, faces: list[FreeformPatch], fits: Which, poses: Array, count: int, take: int
    ) -> list[int]:
        """The faces worth most; if their neighbours run out, begun from some that all fit."""
        wanted = touches_on(faces, poses)
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
    from_side = is_from_side(criterion.reach, few)
    all_faces = freeform_faces(blank, faces, tried, rng, from_side=from_side)
    room = room_among(all_faces, places.balls, faces, blank)
    room = light_enough(room, all_faces, places.balls)
    check_room(room)
    if not criterion.reach.is_reachable(touches_on(all_faces, few)).any():
        raise NotReachable(
            f"no face at any of {len(all_faces)} places can be touched at a table pose with every "
            "axis within its travel"
        )
    return BodyChoice(
        criterion=criterion, blank=blank, tried=tried, rng=rng, room=room, from_side=from_side
    )


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
