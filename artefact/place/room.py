"""Whether the wanted faces stand side by side on the blank, beside the fewest balls that identify.

Looked at before anything is chosen. As many places are tried as the choice has later, with random
shapes of their own: what does not fit among these is not found later either, but for luck.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from artefact.body import Base, DatumSphere, FreeformPatch
from artefact.layout import Blank, balls_on_posts, beside_balls, freeform_faces, least_gap
from artefact.reach import ProbeReach, reach_of, spread_poses
from twin.errors import NotBuildable
from twin.frames import Array

FEWEST_BALLS = 3
"""A set-up has six unknowns, and a ball alone hides every turn about it."""

_POSES = 20  # table poses at which a place has to be reached once
_BALLS = 200  # places of balls that are tried


@dataclass(frozen=True, eq=False)
class Room:
    """The most bodies that were found to stand side by side.

    Attributes:
        blank: On which they stand.
        wanted: Number of faces.
        tried: Number of places of faces that were tried.
        faces: That fit.
        balls: That still stand beside them.
    """

    blank: Blank
    wanted: int
    tried: int
    faces: tuple[FreeformPatch, ...]
    balls: tuple[DatumSphere, ...]

    @property
    def is_enough(self) -> bool:
        """Whether all faces fit, and with them as many balls as a set-up needs."""
        return len(self.faces) >= self.wanted and len(self.balls) >= FEWEST_BALLS


def check_room(room: Room) -> None:
    """Refuse what does not fit, with how much does.

    Raises:
        NotBuildable: Fewer faces or balls than wanted (fact `fitting`).
    """
    if not room.is_enough:
        few = len(room.faces) < room.wanted
        balls = "" if few else f" with {len(room.balls)} of {FEWEST_BALLS} balls"
        raise NotBuildable(
            f"only {len(room.faces)} of {room.wanted} patches{balls} fit on the blank side by "
            f"side, of {room.tried} places tried; between two bodies cutter and probe need "
            f"{least_gap(room.blank.limits):g} mm",
            fitting=len(room.faces),
        )


def room_among(
    faces: Sequence[FreeformPatch], balls: Sequence[DatumSphere], wanted: int, blank: Blank
) -> Room:
    """As many faces as wanted that stand beside the fewest balls, or the most that are found.

    Args:
        faces: Where they may stand.
        balls: Where they may stand.
        wanted: Number of faces.
        blank: On which they stand.

    Raises:
        NotBuildable: No screw holes on such a blank.
    """
    if not faces:
        return Room(blank=blank, wanted=wanted, tried=0, faces=(), balls=())
    stand, beside = beside_balls(faces, balls, (wanted, FEWEST_BALLS), blank)
    found, left = tuple(faces[i] for i in stand), tuple(balls[i] for i in beside)
    return Room(blank=blank, wanted=wanted, tried=len(faces), faces=found, balls=left)


def room_for(
    patches: int, reach: ProbeReach, blank: Blank, poses: Array, count: int, seed: int
) -> Room:
    """Places that the machine reaches and that stand side by side.

    Args:
        patches: Number wanted.
        reach: Machine, probe, set-up.
        blank: Base, height and limits.
        poses: Table poses that can be used, (K, R), rad.
        count: Number of random places.
        seed: Of them.

    Raises:
        NotBuildable: No screw holes, or no face at all, on such a blank.
    """
    rng = np.random.default_rng(seed)
    faces = freeform_faces(blank, patches, count, rng)
    middle = np.zeros((1, 2))
    points = np.concatenate([p.point(middle) for p in faces])
    normals = np.concatenate([p.normal(middle) for p in faces])
    tried = reach_of(reach, points, normals, spread_poses(poses, _POSES))
    reached = [faces[i] for i in np.flatnonzero(tried.reached.any(axis=1))]
    return room_among(reached, balls_on_posts(blank, _BALLS, rng), patches, blank)


def check_blank(base: Base, reach: ProbeReach) -> None:
    """Refuse a blank whose sides reach beyond the table; its corners may.

    Raises:
        NotBuildable: With both sizes.
    """
    if max(base.half_size) > reach.table_radius:
        a, b = (2.0 * side for side in base.half_size)
        raise NotBuildable(
            f"a blank of {a:g} x {b:g} mm is larger than the table, diameter "
            f"{2.0 * reach.table_radius:g} mm"
        )
