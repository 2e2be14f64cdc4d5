"""Whether the requested faces fit side by side on the blank, with the fewest balls that identify.

Checked before anything is chosen: room, access of the probe, and mass. The check draws as many
random candidates as the later choice: faces that do not fit among these rarely fit later.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import Base, DatumSphere, FreeformPatch, MountingHole, Standard
from matstd.artefact.feasibility.touched import is_from_side, mutually_probeable, untouchable_faces
from matstd.artefact.layout import (
    Blank,
    balls_on_posts,
    beside_balls,
    freeform_faces,
    holes_on,
    least_gap,
    least_mass,
    with_spheres,
)
from matstd.artefact.reach import ProbeReach, reach_of, spread_poses
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array, Mask

FEWEST_BALLS = 3
"""A set-up has six unknowns; a single ball leaves all rotations about it undetermined."""

_POSES = 20  # table poses, at one of which a place must be reached
_BALLS = 200  # places of balls that are tried
_ROUNDS = 8  # of a search for faces that can be touched
_SEARCH_WIDTH = 16  # resolution, in places, of the search for the lightest faces
_CELL = 6.0  # mm, cells for the mass of a standard
_MASS_SHARE = 0.97  # of the mass left for the faces: their shares are estimates


@dataclass(frozen=True, eq=False)
class Room:
    """The largest set of bodies found to fit side by side."""

    blank: Blank
    wanted: int
    tried: int
    reached: int  # number of these within angle and travels of the machine
    faces: tuple[FreeformPatch, ...]
    balls: tuple[DatumSphere, ...]
    unseen: str = ""  # obstacle that keeps the probe from more faces; empty where there is none
    # mass of the lightest such standard found, kg; 0 where these bodies are light enough
    least: float = 0.0

    @property
    def is_enough(self) -> bool:
        """Whether all faces fit together with the fewest balls."""
        return len(self.faces) >= self.wanted and len(self.balls) >= FEWEST_BALLS

    @property
    def is_hidden(self) -> bool:
        """Whether most of the faces are inaccessible to the probe."""
        return bool(self.unseen) or 2 * self.reached < self.tried

    @property
    def is_light(self) -> bool:
        """Whether such a standard is within the mass limit."""
        return self.least <= self.blank.limits.max_mass

    @property
    def standard(self) -> Standard:
        """The bodies on their plate."""
        return replace(
            _plate_and_balls(self.blank, self.balls, holes_on(self.blank)), patches=self.faces
        )


def check_room(room: Room) -> None:
    """Raise NotBuildable where fewer faces or balls fit than wanted (fact `fitting`)."""
    few, limits = len(room.faces) < room.wanted, room.blank.limits
    places = f"{room.tried} places tried"
    if room.reached < room.tried:
        places += f", {room.reached} of which are within the probe's angle and travels"
    if room.unseen:
        raise NotBuildable(
            f"only {len(room.faces)} of {room.wanted} patches can be touched where they stand side "
            f"by side, of {places}; {room.unseen}",
            fitting=len(room.faces),
            binding=["touch"],
        )
    if not room.is_enough:
        balls = "" if few else f" with {len(room.balls)} of {FEWEST_BALLS} balls"
        raise NotBuildable(
            f"only {len(room.faces)} of {room.wanted} patches{balls} fit on the blank side by "
            f"side, of {places}"
            + (
                ""
                if room.is_hidden
                else f"; between two bodies cutter and probe need {least_gap(limits):g} mm"
            ),
            fitting=len(room.faces),
        )
    if not room.is_light:
        plate = _plate_and_balls(room.blank, (), ()).mass(_CELL)
        raise NotBuildable(
            f"the lightest standard found weighs {room.least:.1f} kg, limit "
            f"{limits.max_mass:g} kg: its plate {plate:.1f} kg, {FEWEST_BALLS} balls on the "
            f"shortest posts and {room.wanted} of the smallest, lowest faces the rest",
            binding=["mass"],
            least=room.least,
        )


def room_among(
    faces: Sequence[FreeformPatch],
    balls: Sequence[DatumSphere],
    wanted: int,
    blank: Blank,
    seen: Mask | None = None,
) -> Room:
    """As many faces as wanted beside the fewest balls, or the largest set found.

    Args:
        seen: Pairs of faces that can both be probed, (F, F); None for all.

    Raises:
        NotBuildable: No screw holes on such a blank.
    """
    if not faces:
        return Room(blank=blank, wanted=wanted, tried=0, reached=0, faces=(), balls=())
    stand, beside = beside_balls(faces, balls, (wanted, FEWEST_BALLS), blank, seen)
    found, left = tuple(faces[i] for i in stand), tuple(balls[i] for i in beside)
    n = len(faces)
    return Room(blank=blank, wanted=wanted, tried=n, reached=n, faces=found, balls=left)


def room_for(
    patches: int, reach: ProbeReach, blank: Blank, poses: Array, count: int, seed: int
) -> Room:
    """Draw random places, keep those within reach and fit them side by side.

    Args:
        poses: Usable table poses, (K, R), rad.

    Raises:
        NotBuildable: No screw holes, or no face at all, on such a blank.
    """
    rng, few = np.random.default_rng(seed), spread_poses(poses, _POSES)
    faces = freeform_faces(blank, patches, count, rng, from_side=is_from_side(reach, few))
    middle = np.zeros((1, 2))
    points = np.concatenate([p.point(middle) for p in faces])
    normals = np.concatenate([p.normal(middle) for p in faces])
    tried = reach_of(reach, points, normals, few)
    reached = [faces[i] for i in np.flatnonzero(tried.reached.any(axis=1))]
    balls = balls_on_posts(blank, _BALLS, rng)
    room = room_among(reached, balls, patches, blank)
    if room.is_enough:
        room = _probeable_room(room, reached, balls, reach, few)
    room = replace(room, tried=len(faces), reached=len(reached))
    return lightest_room(room, reached, balls)


def lightest_room(room: Room, faces: Sequence[FreeformPatch], balls: Sequence[DatumSphere]) -> Room:
    """The room itself, or the lightest one found if it is too heavy, with its mass.

    Bisects the list of places, sorted by the mass of the lowest possible face there.
    """
    blank, wanted = room.blank, room.wanted
    if not room.is_enough or room.standard.mass(_CELL) <= blank.limits.max_mass:
        return room
    low = _lowest_third(balls)
    mass = np.array([least_mass(face, blank) for face in faces])
    order, found = np.argsort(mass, kind="stable"), room
    at_least, enough = wanted, len(faces)
    while enough - at_least > _SEARCH_WIDTH:
        middle = (at_least + enough) // 2
        trial = room_among([faces[k] for k in order[:middle]], low, wanted, blank)
        if trial.is_enough:
            enough, found = middle, trial
        else:
            at_least = middle + 1
    bare = _plate_and_balls(blank, found.balls, holes_on(blank)).mass(_CELL)
    heaviest = max(least_mass(face, blank) for face in found.faces)
    least = bare + wanted * heaviest / _MASS_SHARE
    return replace(room, faces=found.faces, balls=found.balls, least=least)


def mass_per_face(
    blank: Blank, balls: Sequence[DatumSphere], holes: Sequence[MountingHole], count: int
) -> float:
    """Allowed mass of each face beside the balls, kg; negative where these are too heavy."""
    left = blank.limits.max_mass - _plate_and_balls(blank, balls, holes).mass(_CELL)
    return _MASS_SHARE * left / count


def _probeable_room(
    room: Room,
    faces: Sequence[FreeformPatch],
    balls: Sequence[DatumSphere],
    reach: ProbeReach,
    poses: Array,
) -> Room:
    """The room itself if every face can be probed, or the largest set of faces that can."""
    if not untouchable_faces(reach, room.standard, poses):
        return room
    seen = mutually_probeable(reach, room.blank, faces, (), poses)
    most, beside, low = replace(room, faces=()), seen.beside.copy(), _lowest_third(balls)
    for _ in range(_ROUNDS):
        found = room_among(faces, low, room.wanted, room.blank, beside)
        out = set(untouchable_faces(reach, found.standard, poses))
        left = tuple(face for face in found.faces if face.name not in out)
        if len(left) > len(most.faces):
            most = replace(found, faces=left)
        if most.is_enough or not out:
            break
        barred = [face.name in out for face in faces]
        beside[barred, :] = beside[:, barred] = False
    if most.is_enough:
        return most
    unseen = f"the probe comes past plate and pillar to {seen.alone.sum()} of these places alone"
    return replace(most, unseen=unseen)


def _lowest_third(balls: Sequence[DatumSphere]) -> list[DatumSphere]:
    """The lower third of some balls, which weigh and hide least."""
    low = sorted(balls, key=lambda ball: float(ball.centre[2]))
    return low[: max(FEWEST_BALLS, len(low) // 3)]


def _plate_and_balls(
    blank: Blank, balls: Sequence[DatumSphere], holes: Sequence[MountingHole]
) -> Standard:
    """A standard of plate and balls."""
    return replace(with_spheres(blank, [b.centre for b in balls]), holes=tuple(holes))


def check_blank(base: Base, reach: ProbeReach) -> None:
    """Raise NotBuildable for a blank whose sides reach beyond the table; its corners may."""
    if max(base.half_size) > reach.table_radius:
        a, b = (2.0 * side for side in base.half_size)
        raise NotBuildable(
            f"a blank of {a:g} x {b:g} mm is larger than the table, diameter "
            f"{2.0 * reach.table_radius:g} mm"
        )
