"""What to measure next: the touches that would distinguish two effects, as a run plan."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import BoolArray
from matstd.twin.frames import Array
from matstd.twin.machine import inverse_linear
from matstd.twin.model import columns
from matstd.twin.record import Run, Touches, linear_approach
from matstd.twin.units import DEG

PLANNED_TOUCHES = 24
"""Touches of a plan."""

MAX_OFFERS = 600
"""Touches among which a plan is chosen."""

DEFAULT_PACE = 15.0
"""Time from touch to touch where the run does not state times, s."""

MIN_SEPARATION = 1.0
"""Least separation of a useful plan, standard deviations."""

TARGET_DIGITS = 2
"""Targets are offered to a hundredth of a millimetre, or of a degree."""

DRAWS_PER_OFFER = 8
"""Combinations drawn for every touch offered; most are out of reach."""

APPROACH_CONE = 15.0 * DEG
"""A feature is approached within this angle of a direction in which the run touched it. Obstacles
elsewhere are known only to the standard's own model."""

MIN_FACING = 0.2
"""Least cosine between normal and spindle direction, unless the run itself touched steeper
faces."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Touches that distinguish effects.

    Attributes:
        touches: What to touch, in the order of probing.
        separation: Expected difference of the two explanations after these touches, in standard
            deviations; before them it was nearly none.
        periods_of: The effect whose periods are distinguished; empty for two effects.
    """

    distinguishes: tuple[str, str]
    touches: Touches
    separation: float
    periods_of: str = ""


def candidate_touches(run: Run, rng: np.random.Generator) -> Touches:
    """Touches that could be made: known points of the standard, in poses and set-ups of the run.

    Every offer joins a touched point with rotary readings that the run has used, in the same or in
    another set-up, from either side of each rotary axis, at a later time; the linear axes follow.
    Offers beyond a travel, steeper to the stylus than the run's own touches, or from where the run
    has not touched that feature are left out.
    """
    t = run.touches
    n = len(t)
    count = DRAWS_PER_OFFER * MAX_OFFERS
    point, pose = rng.integers(n, size=count), rng.integers(n, size=count)
    q = t.q[pose].copy()
    picked = replace(t[point], q=q, setup=t.setup[pose], pose=t.pose[pose])
    target = picked.point_table + t.radius[point][:, None] * picked.normal_table
    q = _with_linear(picked, target, q)
    approach = linear_approach(t.chain, q, picked.normal_table)
    for axis in t.chain.rotary_axes:
        approach[:, t.chain.axis_index(axis)] = rng.choice([-1.0, 1.0], size=count)
    picked = replace(picked, q=q, approach=approach)
    keep = _within(picked) & (_facing(picked) >= max(float(_facing(t).min()), MIN_FACING))
    keep &= _known_side(t, picked)
    return picked[np.flatnonzero(keep)[:MAX_OFFERS]]


def _with_linear(touches: Touches, target: Array, q: Array) -> Array:
    """Readings whose linear axes bring the ball to its target; as they are on other machines."""
    if len(touches.chain.linear_axes) != 3:
        return q
    return inverse_linear(touches.chain, target, q, touches.target)


def _within(touches: Touches) -> BoolArray:
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


def _known_side(known: Touches, offers: Touches) -> BoolArray:
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


def plan(
    first: Fit,
    rivals: Sequence[Fit],
    names: tuple[str, str],
    offers: Touches,
) -> Plan | None:
    """The touches that would separate explanations of a run best.

    Greedy: the next touch is the one at which the two fitted models differ most, measured against
    noise and against what the uncertainty of the first could make up for; it then learns from it.
    Of several rivals it serves the one distinguished least so far.

    Returns:
        None where the run gives no touches to choose from, or they all agree.
    """
    run = first.run
    if len(offers) < PLANNED_TOUCHES:
        return None
    offers = _later(run.touches, offers)
    whole = _joined(run.touches, offers)
    u = float(np.median(first.u))
    own = columns(first.effects, whole)[len(run) :]
    others = [columns(f.effects, whole)[len(run) :] @ f.theta for f in rivals]
    difference = (own @ first.theta - np.array(others)) / u
    chosen, gained = _greedy(difference, own @ first.spread / u)
    if gained <= MIN_SEPARATION**2:
        return None
    ordered = np.array(sorted(chosen, key=lambda i: (offers.setup[i], offers.pose[i])))
    picked = offers[ordered]
    pace = _pace(run.touches)
    start = float(run.touches.time.max()) + pace
    time = np.asarray(start + pace * np.arange(len(picked)), dtype=float)
    return Plan(names, replace(picked, time=time), float(np.sqrt(gained)))


def _greedy(difference: Array, spread: Array) -> tuple[list[int], float]:
    """Choice of touches with the largest ``d^T (1 + S S^T)^-1 d``, and that value.

    Args:
        difference: Of every rival at every touch, (R, N).
        spread: Root of the covariance of the prediction, (N, P).
    """
    d, S = difference.copy(), spread.copy()
    chosen: list[int] = []
    gained = np.zeros(len(d))
    free = np.ones(d.shape[1], dtype=bool)
    for _ in range(min(PLANNED_TOUCHES, d.shape[1])):
        variance = 1.0 + np.einsum("np,np->n", S, S)
        i = int(np.argmax(np.where(free, d[int(np.argmin(gained))] ** 2 / variance, -1.0)))
        gained += d[:, i] ** 2 / variance[i]
        chosen.append(i)
        free[i] = False
        # what the touch teaches: covariance and expected difference of all others given this one
        along = S @ S[i] / variance[i]
        d = d - d[:, i][:, None] * along
        root = 1.0 / (1.0 + np.sqrt(1.0 / variance[i]))
        S = S - np.outer(along, S[i]) * root
    return chosen, float(gained.min())


def _pace(touches: Touches) -> float:
    """Usual time between touches, s."""
    steps = np.diff(np.sort(touches.time))
    return float(np.median(steps)) if np.any(steps > 0.0) else DEFAULT_PACE


def _later(touches: Touches, offers: Touches) -> Touches:
    """Offers after the run, one after the other; sensors and spindle as at its end."""
    pace = _pace(touches)
    last = int(np.argmax(touches.time))
    time = np.asarray(touches.time.max() + pace * np.arange(1, len(offers) + 1), dtype=float)
    temperature = {k: np.full(len(offers), v[last]) for k, v in touches.temperature.items()}
    own = {k: np.full(len(offers), v[last]) for k, v in touches.value.items()}
    rpm = None if touches.spindle_rpm is None else np.full(len(offers), touches.spindle_rpm[last])
    return replace(offers, time=time, temperature=temperature, value=own, spindle_rpm=rpm)


def _joined(first: Touches, second: Touches) -> Touches:
    """Two records one after the other: effects that remember need what went before."""
    merged = {}
    for field in fields(Touches):
        a, b = getattr(first, field.name), getattr(second, field.name)
        if field.name in ("chain", "setups", "instrument") or a is None:
            merged[field.name] = a
        elif field.name in ("temperature", "value"):
            merged[field.name] = {k: np.concatenate([a[k], b[k]]) for k in a}
        else:
            merged[field.name] = np.concatenate([a, b])
    return Touches(**merged)
