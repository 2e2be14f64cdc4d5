"""Whether the wanted faces stand side by side on the blank, before anything is chosen.

As many places are tried as the choice has later, with random shapes of their own: what does not fit
among these is not found later either, but for luck.
"""

from dataclasses import dataclass

import numpy as np

from artefact.body import FreeformPatch
from artefact.layout import Blank, faces_fit, freeform_faces, holes_on, most_side_by_side
from artefact.reach import ProbeReach, reach_of, spread_poses
from twin.frames import Array

_POSES = 20  # table poses at which a place has to be reached once


@dataclass(frozen=True, eq=False)
class Room:
    """The most faces that were found to stand side by side.

    Attributes:
        faces: Where they stand.
        tried: Number of places that were tried, all of them within reach.
    """

    faces: tuple[FreeformPatch, ...]
    tried: int


def room_for(
    patches: int, reach: ProbeReach, blank: Blank, poses: Array, count: int, seed: int
) -> Room:
    """Places that stand side by side, as many as wanted or the most that are found.

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
    faces = freeform_faces(blank, patches, count, np.random.default_rng(seed))
    middle = np.zeros((1, 2))
    points = np.concatenate([p.point(middle) for p in faces])
    normals = np.concatenate([p.normal(middle) for p in faces])
    tried = reach_of(reach, points, normals, spread_poses(poses, _POSES))
    faces = [faces[i] for i in np.flatnonzero(tried.reached.any(axis=1))]
    if not faces:
        return Room((), 0)
    found = most_side_by_side(faces_fit(faces, holes_on(blank), blank.limits), patches)
    return Room(tuple(faces[i] for i in found), len(faces))
