"""Touches that a next measurement could make: known points, in poses that a run has used."""

from dataclasses import replace

import numpy as np

from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.machine import inverse_linear
from matstd.twin.record import Run, Touches, linear_approach
from matstd.twin.units import DEG

MAX_OFFERS = 600  # touches among which a plan is chosen
TARGET_DIGITS = 2  # targets are offered to a hundredth of a millimetre, or of a degree
DRAWS_PER_OFFER = 8  # combinations drawn for every touch offered; most are out of reach

APPROACH_CONE = 15.0 * DEG
"""A feature is approached within this angle of a direction in which the run touched it. Obstacles
elsewhere are known only to the standard's own model."""

MIN_FACING = 0.2
"""Least cosine between normal and spindle direction, unless the run itself touched steeper
faces."""


def candidate_touches(run: Run, rng: np.random.Generator) -> Touches:
    """Touches that could be made: known points of the standard, in poses and set-ups of the run.

    Every offer joins a touched point with rotary readings that the run has used, in the same or in
    another set-up, from either side of each rotary axis, at a later time; the linear axes follow.
    Offers beyond a travel, steeper to the stylus than the run's own touches, or from where the run
    has not touched that feature are left out.
    """
    n = len(run)
    count = DRAWS_PER_OFFER * MAX_OFFERS
    point, pose = rng.integers(n, size=count), rng.integers(n, size=count)
    sides = rng.choice([-1.0, 1.0], size=(count, len(run.touches.chain.rotary_axes)))
    picked, keep = _joined(run.touches, point, pose, sides)
    return picked[np.flatnonzero(keep)[:MAX_OFFERS]]


def visiting_touches(run: Run, visits: int, each: int, rng: np.random.Generator) -> Touches:
    """Touches of poses visited one after the other, more than a plan takes.

    Poses come in random order, set-ups one after the other, every rotary position from a random
    side. Every other one has rotary readings between those of the run. `pose` counts the visits. A
    run of another instrument than a ball on a standard is repeated reading by reading, in another
    order.

    Args:
        visits: Number of poses, over all set-ups.
        each: Most touches of a pose.
    """
    t = _clamped_anew(run.touches[run.touches.run == 0])
    if not (t.instrument.is_ball_on_standard and bool(np.any(t.radius > 0.0))):
        order = rng.permutation(len(t))[: visits * each]
        order = order[np.argsort(t.setup[order], kind="stable")]
        return replace(t[order], pose=np.arange(len(order)) * visits // len(order))
    rows = [np.flatnonzero(t.setup == s) for s in np.unique(t.setup)]
    share = np.array_split(np.arange(visits), len(rows))
    drawn = [r[rng.integers(len(r), size=len(k))] for r, k in zip(rows, share, strict=True)]
    pose = np.concatenate(drawn)
    turns = t.q[pose][:, t.chain.rotary_columns]
    turns[::2] = _between(turns, rng)[::2]
    sides = rng.choice([-1.0, 1.0], size=turns.shape)
    number = np.repeat(np.arange(visits), DRAWS_PER_OFFER * each)
    point = rng.integers(len(t), size=len(number))
    picked, keep = _joined(t, point, pose[number], sides[number], turns[number])
    kept = np.concatenate([np.flatnonzero(keep & (number == k))[:each] for k in range(visits)])
    return replace(picked[kept], pose=number[kept])


def _between(turns: Array, rng: np.random.Generator) -> Array:
    """As many rotary readings within the range of others, in steps that a program states, rad."""
    if not turns.size:
        return turns
    drawn = rng.uniform(turns.min(axis=0), turns.max(axis=0), turns.shape)
    return np.asarray(np.round(drawn / DEG, TARGET_DIGITS) * DEG)


def _clamped_anew(t: Touches) -> Touches:
    """Touches of the same places in set-ups of a visit, clamped where they stood."""
    used, setup = np.unique(t.setup, return_inverse=True)
    setups = tuple(replace(t.setups[k], start=0.0, run="") for k in used)
    return replace(t, setups=setups, setup=setup)


def _joined(
    t: Touches, point: IntArray, pose: IntArray, sides: Array, turns: Array | None = None
) -> tuple[Touches, Mask]:
    """Points of some rows at the rotary readings and in the set-up of others, and which are made.

    Args:
        sides: Sign of the last motion of every rotary axis, (N, R).
        turns: Rotary readings instead, (N, R), rad.
    """
    q = t.q[pose]
    if turns is not None:
        q[:, t.chain.rotary_columns] = turns
    picked = replace(t[point], q=q, commanded=None, setup=t.setup[pose], pose=t.pose[pose])
    target = picked.point_table + picked.radius[:, None] * picked.normal_table
    q = _with_linear(picked, target, q.copy())
    approach = linear_approach(t.chain, q, picked.normal_table)
    approach[:, t.chain.rotary_columns] = sides
    commanded = None if t.commanded is None else q
    picked = replace(picked, q=q, commanded=commanded, approach=approach)
    keep = _within(picked) & (_facing(picked) >= max(float(_facing(t).min()), MIN_FACING))
    return picked, keep & _known_side(t, picked)


def _with_linear(touches: Touches, target: Array, q: Array) -> Array:
    """Readings whose linear axes bring the ball to its target; as they are on other machines."""
    if len(touches.chain.linear_axes) != 3:
        return q
    return inverse_linear(touches.chain, target, q, touches.target)


def _within(touches: Touches) -> Mask:
    """Which touches lie within the travels of all axes."""
    limits = np.array([touches.chain.link(axis).range for axis in touches.chain.axes])
    inside = (touches.q >= limits[:, 0]) & (touches.q <= limits[:, 1])
    return np.asarray(inside.all(axis=1))


def _facing(touches: Touches) -> Array:
    """Cosine between the outward normal and the direction from the tip to the spindle, (N,)."""
    tool = touches.chain.link_index("t")
    return np.einsum("ni,ni->n", touches.reach.twist[:, tool, 2], touches.normal_table)


def _from_side(touches: Touches) -> Array:
    """Direction from the tip to the spindle as the standard sees it, (N, 3)."""
    tool = touches.chain.link_index("t")
    turns = np.array([s.T_table_artefact[:3, :3] for s in touches.setups])
    return np.einsum("nij,ni->nj", turns[touches.setup], touches.reach.twist[:, tool, 2])


def _known_side(known: Touches, offers: Touches) -> Mask:
    """Offers that come to their feature from about where it was touched before, (M,)."""
    before, now = _from_side(known), _from_side(offers)
    out = np.zeros(len(offers), dtype=bool)
    for feature in np.unique(offers.feature):
        rows = np.flatnonzero(offers.feature == feature)
        sides = np.unique(np.round(before[known.feature == feature], 6), axis=0)
        out[rows] = (now[rows] @ sides.T).max(axis=1) >= np.cos(APPROACH_CONE)
    return out


def candidate_targets(run: Run, axis: str, rng: np.random.Generator) -> Touches:
    """Touches at new readings of one axis, all else as in touches of the run.

    Args:
        run: Of an instrument that reads anywhere along the axis, or a ball on a standard: then only
            known points are offered.
        axis: Whose readings are drawn, over the travel that was measured.
    """
    t = run.touches
    if t.instrument.is_ball_on_standard and bool(np.any(t.radius > 0.0)):
        return candidate_touches(run, rng)
    picked = t[rng.integers(len(t), size=MAX_OFFERS)]
    q = picked.q.copy()
    reading = t.reading(axis)
    drawn = rng.uniform(reading.min(), reading.max(), len(q))
    unit = DEG if t.chain.link(axis).kind == "rotary" else 1.0
    q[:, t.chain.axis_index(axis)] = np.round(drawn / unit, TARGET_DIGITS) * unit
    moved = replace(picked, q=q)
    return replace(moved, point=picked.point + moved.ball_artefact - picked.ball_artefact)
