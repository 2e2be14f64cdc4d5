"""Shapes from wanted touches: what would tell most at a patch's place decides its surface.

On the plane of every patch touches are wanted in any normal that a face may have there; the relaxed
optimum over all patches and spheres together says which. The wanted normals are laid out over the
face as the slopes of a convex shape, which is the assignment of normals to places with the largest
sum of ``place . normal`` (Brenier's map of optimal transport: the slopes of a convex function are
such an assignment, and nearly the other way round). The control heights are those whose slopes come
nearest to them, a Poisson problem, kept smooth and scaled to the limits of cutter and stylus ball.

Reference:
    Brenier, Communications on Pure and Applied Mathematics 44 (1991) 375; Fried (1977) and Frankot
    and Chellappa (1988) for heights from slopes by least squares.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from artefact.body import OVERHANG, FreeformPatch, Limits, Standard, constraints, graph_patch, unit
from artefact.layout import CONTROL, STEEPEST, TALLEST, strength
from artefact.reach import Requests, joined
from artefact.worth import Criterion, TouchOptions, each_at, face_grid, sphere_grid
from information.selection import Mask, Quota, heaviest, relaxed
from twin.frames import Array, turn
from twin.units import DEG

_PLACES = 3  # each way on a face, where touches are wanted
_POSES = 4  # at which each of them is tried
_ON_SPHERE = 36  # directions on a sphere
_ON_SPHERE_POSES = 12  # more than on a face: a ball shows every normal, its poses decide
_LAID_OUT = 5  # wanted slopes each way on a face
_SMOOTH = 0.1  # weight of bending against slopes; a length of the patch makes it a pure number
_NEAR = 0.03  # gap of the relaxed optimum that will do


def with_optimised_shapes(
    criterion: Criterion,
    standard: Standard,
    poses: Array,
    limits: Limits,
    options: TouchOptions,
    rng: np.random.Generator,
) -> Standard:
    """A standard with the same sites, whose shapes serve the touches that are wanted there.

    Patches whose new shape breaks a limit keep the old one.

    Args:
        standard: Within its limits.
        poses: Table poses, (K, R), rad.
        limits: Of slope, curvature, room.
        options: Number of touches and shares of the spheres.
        rng: Draws the poses that are tried at each place.
    """
    slopes = wanted_slopes(criterion, standard, poses, options, rng)
    patches = tuple(_reshaped(p, slopes[p.name], limits) for p in standard.patches)
    made = replace(standard, patches=patches)
    broken = [c for c in constraints(made, limits) if c.slack < 0.0]
    if not broken:
        return made
    blamed = {name for c in broken for name in c.features}
    pairs = zip(standard.patches, patches, strict=True)
    kept = tuple(old if old.name in blamed else new for old, new in pairs)
    made = replace(standard, patches=kept)
    return standard if any(c.slack < 0.0 for c in constraints(made, limits)) else made


def wanted_slopes(
    criterion: Criterion,
    standard: Standard,
    poses: Array,
    options: TouchOptions,
    rng: np.random.Generator,
) -> dict[str, Array]:
    """Slopes (dh/du, dh/dv) that touches are wanted with on every patch, heaviest first, (M, 2).

    The relaxed optimum of all touches, with the spheres' share, over normals within the steepest
    slope around the direction of each patch.
    """
    slopes = _slopes()
    parts, slope = [], []
    for patch in standard.patches:
        point = patch.point(face_grid(patch.half_size, _PLACES))
        normal = turn(
            patch.T_artefact_patch, unit(np.column_stack([-slopes, np.ones(len(slopes))]))
        )
        count = len(point) * len(normal) * _POSES
        parts.append(
            Requests(
                np.full(count, patch.name),
                np.repeat(point, len(normal) * _POSES, axis=0),
                np.tile(np.repeat(normal, _POSES, axis=0), (len(point), 1)),
                poses[rng.integers(0, len(poses), count)],
            )
        )
        slope.append(np.tile(np.repeat(slopes, _POSES, axis=0), (len(point), 1)))
    some = poses[rng.permutation(len(poses))[:_ON_SPHERE_POSES]]
    spheres = [each_at(s, sphere_grid(_ON_SPHERE), some) for s in standard.spheres]
    tried = joined(parts + spheres)
    slope.append(np.zeros((sum(map(len, spheres)), 2)))
    good = criterion.reach.is_reachable(tried)
    weight = _weights(criterion, tried[good], [s.name for s in standard.spheres], options, rng)
    feature, all_slopes = tried.feature[good], np.concatenate(slope)[good]
    found = {}
    for patch in standard.patches:
        mine = np.flatnonzero((feature == patch.name) & (weight > 0.0))
        found[patch.name] = all_slopes[mine[np.argsort(-weight[mine], kind="stable")]]
    return found


def _slopes() -> Array:
    """Slopes spread evenly over the cone that a face may have, (K, 2)."""
    rows = [(0.0, 0.0)]
    for ring, count in ((1, 6), (2, 9), (3, 12)):
        slope = np.tan(ring / 3.0 * (STEEPEST - 2.0 * DEG))
        angle = 2.0 * np.pi * np.arange(count) / count
        rows += list(zip(slope * np.cos(angle), slope * np.sin(angle), strict=True))
    return np.array(rows)


def _weights(
    criterion: Criterion,
    tried: Requests,
    spheres: list[str],
    options: TouchOptions,
    rng: np.random.Generator,
) -> Array:
    """Fractions of touches that are nearly the best, (N,)."""
    on_sphere: Mask = np.isin(tried.feature, spheres)
    most = np.array([options.touches, round(options.sphere_share[1] * options.touches)])
    quotas = (Quota(on_sphere.astype(np.int64), most),)
    start = heaviest(rng.random(len(tried)), options.touches, quotas)
    return relaxed(
        criterion.objective, criterion.rows(tried), options.touches, start, _NEAR, quotas
    ).weight


def _reshaped(patch: FreeformPatch, slopes: Array, limits: Limits) -> FreeformPatch:
    """A patch with the shape for some slopes, or as it was where none is wanted."""
    if not len(slopes):
        return patch
    heights = heights_for(patch.half_size, slopes, limits)
    return graph_patch(
        patch.name, patch.T_artefact_patch, patch.half_size, heights, patch.degree, patch.depth
    )


def heights_for(half_size: tuple[float, float], slopes: Array, limits: Limits) -> Array:
    """Control heights of a dome whose slopes are nearly some wanted ones, as far as limits allow.

    Args:
        half_size: Half sides of the face, mm.
        slopes: Wanted slopes (dh/du, dh/dv) in any order, (M, 2), M > 0.
        limits: Of slope and concave radius.

    Returns:
        Shape (`CONTROL`, `CONTROL`), mm, with mean zero.
    """
    uv = face_grid(half_size, _LAID_OUT)
    wanted = slopes[np.arange(len(uv)) % len(slopes)]
    places, which = linear_sum_assignment((uv / np.array(half_size)) @ wanted.T)
    laid_out = np.empty_like(wanted)
    laid_out[places] = wanted[which]  # a dome falls away outwards: slopes against places
    units = np.eye(CONTROL * CONTROL).reshape(-1, CONTROL, CONTROL)
    trials = [graph_patch("trial", np.eye(4), half_size, h) for h in units]
    at = [trial.jet(uv) for trial in trials]
    # Beyond the trimmed face too: slopes are wanted on the face alone, and a net that is free to
    # swing in the overhang ran from -325 to +160 mm, which the CAD kernel needed minutes to trim.
    bent = [trial.jet(trial.grid(5.0, OVERHANG)) for trial in trials]
    slope = np.stack([np.concatenate([j.hu, j.hv]) for j in at], axis=1)
    size = _SMOOTH * float(np.mean(half_size))
    bend = np.stack([np.concatenate([j.huu, np.sqrt(2.0) * j.huv, j.hvv]) for j in bent], axis=1)
    level = np.full((1, len(trials)), 1e-3)  # slopes leave the height itself open
    A = np.concatenate([slope, size * bend, level])
    b = np.concatenate([laid_out.T.ravel(), np.zeros(len(bend) + 1)])
    h = np.linalg.lstsq(A, b, rcond=1e-9)[0].reshape(CONTROL, CONTROL)
    h -= h.mean()
    return np.round(h * min(1.0, strength(half_size, h, limits, TALLEST)), 6)
