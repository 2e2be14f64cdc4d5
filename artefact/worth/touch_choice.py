"""The most informative table poses, and touches in them, on a given standard.

Table poses come from a grid of rotary readings: for each the best few touches on every face and
sphere are taken, and the poses are chosen one after the other by what theirs add. At the chosen
poses all touches on a grid of each face that machine and probe can make are candidates; the relaxed
problem, in which a touch may be made by halves, bounds what any choice of them can reach, and its
heaviest touches, exchanged until nothing is gained, are the choice.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth.touch_criterion import Criterion
from matstd.information.selection import (
    Certificate,
    Quota,
    Selection,
    best_groups,
    exchange,
    fill,
    heaviest,
    relaxed,
    rounded,
)
from matstd.twin.compute import blocks
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, Mask
from matstd.twin.machine import Chain
from matstd.twin.sampling import grid_points
from matstd.twin.units import DEG

Surfaces = Sequence[FreeformPatch | DatumSphere]

_PITCHES = (5, 9, 15)  # points each way on a face
_CANDIDATES_PER_TOUCH = 2.0
"""Touches that can be made, for each that is wanted, on the coarsest grid that will do."""
_TOUCHES_PER_BLOCK = 1000  # touches looked at together
_POSE_CROWDING = 1.6  # even shares of the touches that one table pose may have
_EDGE = 3.0  # mm a touch stays away from the trimmed edge of a face
_OVERSHOOT = 6.0 * DEG  # left at the ends of a rotary travel, to approach readings from both sides
_RELAXED_GAP = 5e-3  # relative gap to which the relaxed optimum is sought; whole touches cost 3 %
_SPHERE_LOWEST = -5.0 * DEG  # elevation of the lowest touches on a datum sphere


@dataclass(frozen=True)
class TouchOptions:
    """How many touches are chosen, at how many table poses."""

    touches: int = 480  # number of touches that identify
    poses: int = 30
    proof: int = 110  # number of touches that prove, on faces that identified nothing


def poses_within(chain: Chain, rotary: Array, wanted: int) -> Array:
    """Table poses to choose from: a grid of rotary readings in whole degrees, (K, R), rad.

    The values of each later axis are shifted from one value of the earlier ones to the next, so
    that the whole grid holds many different readings of each.

    Args:
        rotary: Smallest and largest readings of the rotary axes, (R, 2), rad.
        wanted: Number of poses that will be chosen; the grid has about six times as many.

    Raises:
        NotReachable: Limits without room to approach a reading from both sides.
    """
    limits = []
    for name, (low, high) in zip(chain.rotary_axes, rotary, strict=True):
        travel = chain.link(name).range
        limits.append((max(low, travel[0] + _OVERSHOOT), min(high, travel[1] - _OVERSHOOT)))
        if limits[-1][0] > limits[-1][1]:
            short = travel[1] - travel[0] < 2.0 * _OVERSHOOT
            raise NotReachable(
                f"readings of {name} from {low / DEG:g} to {high / DEG:g} leave no room: they are "
                f"approached from both sides, {_OVERSHOOT / DEG:g} degrees away, within the travel "
                f"from {travel[0] / DEG:g} to {travel[1] / DEG:g}"
                f"{' degrees; is it stated in radians?' if short else ''}"
            )
    if not limits:
        return np.zeros((1, 0))
    total = 6 * wanted
    spans = np.array([high - low for low, high in limits])
    weight = np.sqrt(np.maximum(spans, 1.0 * DEG))
    counts = np.maximum(np.round(weight * (total / weight.prod()) ** (1.0 / len(spans))), 1)
    rows: list[list[float]] = [[]]
    for (low, high), count in zip(limits, counts.astype(int), strict=True):
        step = (high - low) / max(count - 1, 1)
        grown = []
        for i, row in enumerate(rows):
            shift = ((i * 0.618034) % 1.0 - 0.5) * step if row else 0.0
            values = np.clip(np.linspace(low, high, count) + shift, low, high)
            inside = np.clip(np.round(values / DEG), np.ceil(low / DEG), np.floor(high / DEG))
            grown += [[*row, float(v) * DEG] for v in inside]
        rows = grown
    return np.unique(np.array(rows), axis=0)


def face_grid(half_size: tuple[float, float], count: int) -> Array:
    """Parameters of a regular grid over a face, away from its edges, (count^2, 2)."""
    axes = [np.linspace(-(half - _EDGE), half - _EDGE, count) for half in half_size]
    return grid_points(*axes)


def sphere_grid(count: int) -> Array:
    """Azimuth and elevation of directions spread evenly over the upper part of a sphere."""
    i = np.arange(count) + 0.5
    sine = np.sin(_SPHERE_LOWEST) + (1.0 - np.sin(_SPHERE_LOWEST)) * i / count
    return np.stack([(i * np.pi * (3.0 - np.sqrt(5.0))) % (2.0 * np.pi), np.arcsin(sine)], axis=-1)


def each_at(surface: FreeformPatch | DatumSphere, uv: Array, poses: Array) -> Requests:
    """Touches at parameters of a surface, each at every pose."""
    n, k = len(uv), len(poses)
    return Requests(
        np.full(n * k, surface.name),
        np.repeat(surface.point(uv), k, axis=0),
        np.repeat(surface.normal(uv), k, axis=0),
        np.tile(poses, (n, 1)),
    )


def touches_at(surfaces: Surfaces, poses: Array, pitch: int) -> Requests:
    """Candidate touches on faces and spheres, `pitch` each way, at every pose."""
    grids = [
        sphere_grid(pitch * pitch) if isinstance(s, DatumSphere) else face_grid(s.half_size, pitch)
        for s in surfaces
    ]
    return joined([each_at(s, uv, poses) for s, uv in zip(surfaces, grids, strict=True)])


def clear_touches(reach: ProbeReach, standard: Standard, wanted: Requests) -> Requests:
    """Those of the touches that machine and probe can make."""
    wanted = wanted[reach.is_reachable(wanted)]
    return wanted[reach.is_clear(standard, wanted)]


def chosen_poses(
    criterion: Criterion,
    standard: Standard,
    surfaces: Surfaces,
    poses: Array,
    options: TouchOptions,
) -> Array:
    """Most informative table poses for touches on some surfaces of a standard, (K, R)."""
    tried = touches_at(surfaces, poses, pitch=3)
    tried = tried[criterion.reach.is_reachable(tried)]
    reached = tried
    tried = tried[criterion.reach.has_room(standard, tried)]  # the way there is looked at later
    if not len(tried):
        raise NotReachable(
            "the machine reaches no touch on the standard at any table pose: "
            + criterion.reach.against(standard, reached)
        )
    seen, group = np.unique(np.round(tried.rotary, 9), axis=0, return_inverse=True)
    take = max(4, options.touches // options.poses)
    chosen = best_groups(
        criterion.objective, criterion.rows(tried), group.ravel(), options.poses, take
    )
    return seen[sorted(chosen)]


def touches_to_choose_from(
    reach: ProbeReach, standard: Standard, surfaces: Surfaces, poses: Array, count: int
) -> Requests:
    """Touches on some surfaces of a standard that can be made at some poses.

    The grids are as fine as a choice of `count` among them needs.
    """
    tried = clear_touches(reach, standard, touches_at(surfaces, poses, _PITCHES[0]))
    for pitch in _PITCHES[1:]:
        if len(tried) >= _CANDIDATES_PER_TOUCH * count:
            break
        tried = clear_touches(reach, standard, touches_at(surfaces, poses, pitch))
    return tried


def some_touches(
    criterion: Criterion,
    standard: Standard,
    poses: Array,
    options: TouchOptions,
    rng: np.random.Generator,
) -> Requests:
    """Touches that can be made, drawn from the finest grid until a choice has enough.

    Where fewer can be made than are wanted, each may be chosen more than once.

    Raises:
        NotReachable: None can be made.
    """
    tried = touches_at(standard.patches, poses, _PITCHES[-1])
    tried = tried[criterion.reach.is_reachable(tried)]
    tried = tried[rng.permutation(len(tried))]
    found: list[Requests] = []
    lot = min(
        _TOUCHES_PER_BLOCK, int(2.0 * _CANDIDATES_PER_TOUCH * options.touches)
    )  # about half of those drawn can be made
    for rows in blocks(len(tried), lot):
        found.append(tried[rows][criterion.reach.is_clear(standard, tried[rows])])
        if sum(map(len, found)) >= _CANDIDATES_PER_TOUCH * options.touches:
            break
    made = sum(map(len, found))
    if not made:
        raise NotReachable(f"no touch can be made on '{standard.name}'")
    return joined(found * -(-options.touches // made))


def pose_quota(tried: Requests, count: int) -> Quota:
    """No table pose may have much more than its even share of the touches, if all can be had."""
    pose = tried.pose
    there = np.bincount(pose)
    most = int(np.ceil(_POSE_CROWDING * count / len(there)))
    while np.minimum(there, most).sum() < min(count, len(tried)):
        most += 1
    return Quota(pose, np.full(len(there), most))


def chosen_touches_on(
    criterion: Criterion, tried: Requests, options: TouchOptions, begin: Mask | None = None
) -> tuple[Mask, Certificate]:
    """Single touches, and how near they are to the best that crowd no table pose.

    The relaxed optimum comes first; its heaviest touches are exchanged until nothing is gained.

    Args:
        begin: A choice that is known, (N,): it stays where nothing better is found; None for none.

    Returns:
        The choice, (N,), and its certificate.

    Raises:
        NotReachable: Too few touches can be made.
    """
    n, quotas = options.touches, _pose_quotas(tried, options)
    W = criterion.rows(tried)
    start = heaviest(np.linalg.norm(W, axis=1), n, quotas)
    best = relaxed(criterion.objective, W, n, start, _RELAXED_GAP, quotas)
    choice = rounded(criterion.objective, W, best.weight, n, most=n // 2, quotas=quotas)
    if begin is not None:
        choice = min(
            choice, Selection(criterion.objective, W, begin), key=lambda found: found.value
        )
    return choice.chosen, Certificate(
        candidates=len(W), count=n, value=choice.value, bound=best.bound, shares=True
    )


def repaired_touches(
    criterion: Criterion, tried: Requests, like: Requests, options: TouchOptions
) -> tuple[Mask, Certificate]:
    """A choice made where nothing stood in the way: what is left of it, filled up and exchanged.

    Args:
        like: That were chosen on the same features, whatever these were called.

    Returns:
        The choice, (N,), and its value; no bound is sought.

    Raises:
        NotReachable: Too few touches can be made.
    """
    n, quotas = options.touches, _pose_quotas(tried, options)
    left = np.isin(_places(tried), _places(like))
    choice = Selection(criterion.objective, criterion.rows(tried), left & (left.sum() <= n))
    fill(choice, n, quotas)
    exchange(choice, quotas, most=n // 2)
    return choice.chosen, Certificate(
        candidates=len(tried), count=n, value=choice.value, bound=0.0, shares=True
    )


def _pose_quotas(tried: Requests, options: TouchOptions) -> tuple[Quota, ...]:
    """The quota of the poses, where as many touches as are wanted can be made."""
    n = options.touches
    if len(tried) < n:
        raise NotReachable(f"{len(tried)} touches can be made on the standard, {n} are wanted")
    return (pose_quota(tried, n),)


def _places(touches: Requests) -> NDArray[np.str_]:
    """What distinguishes touches beside the name of the feature: point and table pose, (N,)."""
    rows = np.round(np.column_stack([touches.point, touches.rotary]), 6) + 0.0
    return np.array([row.tobytes().hex() for row in rows], dtype=np.str_)
