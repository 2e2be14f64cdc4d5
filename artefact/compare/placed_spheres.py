"""Spheres placed as the standard's patches are: the rival that has to be beaten, or admitted.

Balls on upright stems are tried all over the base, at heights up to the top of the volume that the
standard fills. Every touch that machine and probe can make on them at some table poses is a row of
information, and so many balls are chosen that theirs together say most, as patches are chosen from
random sites.
"""

import numpy as np
from numpy.typing import NDArray

from artefact.body import DatumSphere, Standard
from artefact.layout import Blank, with_spheres
from artefact.reach import joined, spread_poses
from artefact.worth import Criterion, each_at, sphere_grid
from information.selection import best_groups
from sensitivity.first_order import Box
from twin.errors import NotReachable
from twin.frames import Array

COUNTS = (4, 5, 7, 13)
"""Numbers of spheres that the standard is compared with."""

_CANDIDATES = 300  # places that are tried
_DIRECTIONS = 9  # touches tried on each, at each of the poses
_POSES = 20  # table poses, spread over the user's
_LOWEST = 15.0  # mm between the base and a ball, for the probe to come beside it


def placed_spheres(
    criterion: Criterion,
    blank: Blank,
    poses: Array,
    touches: int,
    rng: np.random.Generator,
) -> dict[int, Standard | None]:
    """Bodies of `COUNTS` spheres each; None where the blank has no room for so many.

    Args:
        criterion: What they are placed for, without potential terms.
        blank: Base, balls, stems and limits.
        poses: Table poses to choose from, (K, R), rad.
        touches: That will be made on all spheres together.
        rng: Draws the places that are tried.

    Raises:
        NotReachable: The machine reaches no touch on any of them.
    """
    spheres = _candidates(blank, criterion.volume, rng)
    some, grid = spread_poses(poses, _POSES), sphere_grid(_DIRECTIONS)
    wanted = joined([each_at(s, grid, some) for s in spheres])
    wanted = wanted[criterion.reach.is_reachable(wanted)]
    if not len(wanted):
        raise NotReachable(f"no sphere at any of {len(spheres)} places can be touched")
    W, fits = criterion.rows(wanted), _apart(spheres, blank)
    found: dict[int, Standard | None] = {}
    for count in COUNTS:
        take = max(4, touches // count)
        group = wanted.feature.astype(np.int64) - 1
        chosen = best_groups(criterion.objective, W, group, count, take, apart=fits)
        found[count] = None
        if len(chosen) == count:
            found[count] = with_spheres(blank, [spheres[k].centre for k in sorted(chosen)])
    return found


def _candidates(blank: Blank, volume: Box, rng: np.random.Generator) -> list[DatumSphere]:
    """Balls named by their numbers, evenly over base and height."""
    fit, base = blank.fittings, blank.base
    half = np.array(base.half_size) - fit.foot_radius - 3.0
    low = base.thickness + _LOWEST + fit.sphere_radius
    across = rng.uniform(-half, half, (_CANDIDATES, 2))
    heights = rng.uniform(low, max(volume[1][2], low + 1.0), _CANDIDATES)
    inside = base.body.distance(np.column_stack([across, np.full(_CANDIDATES, 1.0)])) < 0.0
    centres = np.column_stack([across, heights])[inside]
    return list(with_spheres(blank, list(centres), name="{}".format).spheres)


def _apart(spheres: list[DatumSphere], blank: Blank) -> NDArray[np.bool_]:
    """Which balls leave room for the probe between them, whatever their heights."""
    across = np.stack([s.centre[:2] for s in spheres])
    fit, limits = blank.fittings, blank.limits
    least = 2.0 * (fit.sphere_radius + limits.ball_radius) + limits.gap
    fits: NDArray[np.bool_] = np.linalg.norm(across[:, None] - across, axis=-1) >= least
    return fits
