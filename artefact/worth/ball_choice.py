"""Where balls go: the places whose touches together say most of the machine.

One optimiser for all: the balls of the standard and those of its rivals are chosen by the same
criterion from the same places. Every touch that machine and probe can make on them at some table
poses is a row of information.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch
from matstd.artefact.layout import Blank, balls_fit, balls_on_posts, faces_beside
from matstd.artefact.reach import Requests, joined, spread_poses
from matstd.artefact.worth.touch_choice import each_at, sphere_grid
from matstd.artefact.worth.touch_criterion import Criterion
from matstd.information.selection import best_groups
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, IntArray, Mask

_PLACES = 500  # that are tried; a third of them is barred beside freeform faces
_OVERDRAW = 12  # times as many are drawn where faces bar most of the base
_DIRECTIONS = 9  # touches tried on each, at each of the poses
_POSES = 20  # table poses, spread over the user's


@dataclass(frozen=True, eq=False)
class BallPlaces:
    """Balls of which some are chosen."""

    balls: list[DatumSphere]
    criterion: Criterion
    blank: Blank
    touches: Requests
    W: Array  # their rows, (N, R)
    group: IntArray  # ball of every row, (N,)
    fits: Mask  # which of them stand beside each other, (B, B)

    def best(self, count: int, touches: int, clear: Mask | None = None) -> list[DatumSphere]:
        """At most `count` balls whose clear touches together say most, the first the most."""
        rows = slice(None) if clear is None else clear
        take = max(4, touches // count)
        chosen = best_groups(
            self.criterion.objective, self.W[rows], self.group[rows], count, take, apart=self.fits
        )
        return [self.balls[k] for k in chosen]


def ball_places(
    criterion: Criterion,
    blank: Blank,
    poses: Array,
    rng: np.random.Generator,
    beside: Sequence[FreeformPatch] = (),
) -> BallPlaces:
    """Balls all over a blank.

    Args:
        criterion: What they are chosen for, without potential terms.
        poses: Table poses to choose from, (K, R), rad.
        beside: Faces beside which they leave room for cutter and probe.

    Raises:
        NotReachable: The faces leave room for none, or the machine reaches no touch on any.
    """
    balls = balls_on_posts(blank, _PLACES * (_OVERDRAW if beside else 1), rng)
    if beside:
        free = [ball for ball in balls if faces_beside(beside, [ball], blank).all()]
        balls = [replace(ball, name=f"{i}") for i, ball in enumerate(free[:_PLACES])]
    if not balls:
        raise NotReachable("no ball has room beside the faces")
    some, grid = spread_poses(poses, _POSES), sphere_grid(_DIRECTIONS)
    wanted = joined([each_at(ball, grid, some) for ball in balls])
    wanted = wanted[criterion.reach.is_reachable(wanted)]
    if not len(wanted):
        raise NotReachable(f"no ball at any of {len(balls)} places can be touched")
    return BallPlaces(
        balls=balls,
        criterion=criterion,
        blank=blank,
        touches=wanted,
        W=criterion.rows(wanted),
        group=wanted.feature.astype(np.int64),
        fits=balls_fit(balls, blank),
    )
