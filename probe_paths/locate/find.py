"""From the log of a search the place where the standard stands.

The touches do not identify the features they met, so the place is searched for: the touches are
compared with a height map of the standard (`Relief`) at thousands of placements within the spread.
The best are improved on it by Gauss-Newton, and the best of these on the exact surfaces, edges and
sides.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from matstd.artefact.body import Standard, contact
from matstd.probe_paths.locate.relief import Relief
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array, apply, fixed_xyz, inverse, pose
from matstd.twin.record import Setup
from matstd.twin.units import DEG


@dataclass(frozen=True)
class Spread:
    """Largest offset of the standard from its assumed place, either way in every direction."""

    distance: float = 20.0  # along x, y and z of its own frame, mm
    angle: float = 5.0 * DEG  # about each of them, rad


SPREADS = tuple(Spread(d, a * DEG) for d, a in ((20.0, 5.0), (15.0, 4.0), (10.0, 3.0), (5.0, 2.0)))
"""Spreads for which a search is tried, the widest first: placed by eye, by a rule, by a stop. A
standard of tall posts may leave a short stylus no room to come down over a wide spread."""


_TRIED, _FEWEST_TRIED = 40_000, 2_000
"""Places in the first round for a spread of 20 mm and 5 degrees, and for a small one."""

_IMPROVED_ON_RELIEF = 60  # number improved on the relief
_IMPROVED_EXACTLY = 3  # number improved on the exact surfaces

_ROUNDS, _EXACT_ROUNDS, _LAST_ROUNDS = 25, 15, 15
_RESTARTS, _RESTART_PLACES = 6, 24
_RESTART_SPREAD = np.array([1.5, 1.5, 0.5, 0.01, 0.01, 0.01])  # mm and rad, of random restarts
_STEP = np.array([0.5, 0.5, 0.5, 0.005, 0.005, 0.005])  # mm and rad, of differences on the picture
_FINE = np.array([1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5])  # the same on the surfaces
_ROBUST = 2.0  # mm: residual from which a touch near an edge counts linearly
_SAME = 4.0  # mm: two placements closer than this at every touch are one
MAX_RMS = 0.1
"""Largest rms of the touches at an accepted place, mm: machine errors over the 100 mm of a search
leave 0.03 mm."""

KNOWN, KNOWN_ANGLE = 0.3, 0.1 * DEG
"""Largest standard uncertainties of a place that programs are planned for, mm and rad."""

_CLEAR, _ROUGH = 3.0, 0.03
"""Least ratio of the rms at the next place to that of the best, and the rms that errors of a
machine alone may cause, mm."""


@dataclass(frozen=True, eq=False)
class Found:
    """Where a standard stands."""

    setup: Setup
    shift: Array  # shift of the standard from its assumed place, in its own frame, (3,), mm
    angles: Array  # about x, y and z of it, (3,), rad
    u: Array  # standard uncertainties of both, (6,), mm and rad
    rms: float  # rms distance of the touches, mm
    next_rms: float  # the same at the best of the other places, mm


def find_standard(
    standard: Standard,
    believed: Setup,
    ball_table: Array,
    radius: float,
    rng: np.random.Generator,
    spread: Spread,
) -> Found:
    """Place of a standard from balls that came down on it.

    Args:
        ball_table: Centres of the balls at their contacts, table frame, (N, 3), mm; they came along
            -z of the believed standard.

    Raises:
        NotEnoughData: Fewer than nine touches, no place that fits, or two that fit alike.
    """
    if len(ball_table) < 9:
        raise NotEnoughData(f"{len(ball_table)} touches of a search, expected at least 9")
    ball = apply(inverse(believed.T_table_artefact), ball_table)
    limit = np.repeat([spread.distance, spread.angle], 3)
    relief = Relief.of(standard, radius)

    on_relief = partial(lifted, relief, ball)
    on_surfaces = partial(_lifted_exactly, standard, ball, radius)
    # fewer places for a smaller spread
    share = (spread.distance / Spread.distance) * (spread.angle / Spread.angle)
    count = max(int(min(share, 1.0) * _TRIED), _FEWEST_TRIED)
    tried = rng.uniform(-limit, limit, (count, 6))
    # the believed place is always among them
    tried[0] = 0.0
    best = _converged(_best(tried, on_relief, _IMPROVED_ON_RELIEF), on_relief, _STEP, _ROUNDS)
    few = _distinct(best, on_relief, ball)[:_IMPROVED_EXACTLY]
    few = _converged(few, on_surfaces, _FINE, _EXACT_ROUNDS)
    few = _distinct(few, on_surfaces, ball)
    few[:1] = _restarted(few[0], on_surfaces, rng)
    rms = np.sqrt(np.mean(on_surfaces(few) ** 2, axis=1))
    theta = few[0]
    u = _uncertainty(theta, on_surfaces)
    _refuse_ambiguous_place(rms, u)
    return Found(
        setup=replace(believed, T_table_artefact=believed.T_table_artefact @ _pose(theta)),
        shift=theta[:3],
        angles=theta[3:],
        u=u,
        rms=float(rms[0]),
        next_rms=float(rms[1]) if len(rms) > 1 else np.inf,
    )


def _refuse_ambiguous_place(rms: Array, u: Array) -> None:
    """Refuse a place that does not fit, is not the only one, or is too uncertain to plan for."""
    if rms[0] > MAX_RMS:
        raise NotEnoughData(
            f"no place within the spread fits the touches: the best leaves {rms[0]:.2f} mm; "
            "another standard, farther away, or another probe?"
        )
    if len(rms) > 1 and rms[1] < _CLEAR * max(rms[0], _ROUGH):
        raise NotEnoughData(
            f"two places fit the touches ({rms[0]:.2f} and {rms[1]:.2f} mm): align the standard "
            "better and search again"
        )
    if u[:3].max() > KNOWN or u[3:].max() > KNOWN_ANGLE:
        raise NotEnoughData(
            f"the touches fix the position to {u[:3].max():.2f} mm and {u[3:].max() / DEG:.2f} "
            f"degrees only, expected {KNOWN:g} mm and {KNOWN_ANGLE / DEG:g} degrees: align the "
            "standard better and search again"
        )


def _pose(theta: Array) -> Array:
    """Pose of a standard that stands at shift and angles (..., 6) from its believed place."""
    return pose(fixed_xyz(theta[..., 3:]), theta[..., :3])


Lift = Callable[[Array], Array]
"""By how much the standard at places (M, 6) would stop balls above where they were, (M, N), mm."""


def lifted(relief: Relief, ball: Array, theta: Array) -> Array:
    """On the relief: height of each ball over it, along its own way down."""
    out = []
    for some in np.array_split(theta, max(len(theta) // 2000, 1)):
        back = inverse(_pose(some))
        up = back[:, None, :3, 2]
        place = apply(back[:, None], ball)
        travel = np.zeros(place.shape[:2])
        for _ in range(3):  # the way leans by 5 degrees at most
            there = place + travel[..., None] * up
            height = relief.ball_at(there[..., :2].reshape(-1, 2)).reshape(travel.shape)
            travel = travel + np.clip(height - there[..., 2], -60.0, 60.0) / up[..., 2]
        out.append(travel)
    return np.concatenate(out)


def _lifted_exactly(standard: Standard, ball: Array, radius: float, theta: Array) -> Array:
    """The same on the exact surfaces, by first contacts."""
    above = 80.0  # mm; farther than any place of the few is from where it shall be
    back = inverse(_pose(theta))
    up = back[:, None, :3, 2]
    start = apply(back[:, None], ball) + above * up
    way = np.broadcast_to(-up, start.shape)
    met = contact(standard, start.reshape(-1, 3), way.reshape(-1, 3), radius, 2.0 * above)
    travel = np.where(np.isfinite(met.travel), met.travel, 2.0 * above)
    return above - travel.reshape(start.shape[:2])


def _cost(lifted: Array) -> Array:
    """Huber's cost: quadratic up to `_ROBUST`, linear beyond."""
    size = np.abs(lifted)
    cost = np.where(size < _ROBUST, 0.5 * size**2, _ROBUST * (size - 0.5 * _ROBUST))
    return cost.sum(axis=1)


def _best(tried: Array, lift: Lift, count: int) -> Array:
    """The best-fitting places, each at its best height."""
    lifted = lift(tried)
    middle = np.median(lifted, axis=1, keepdims=True)
    tried = tried - middle * np.eye(6)[2]
    some = np.argsort(_cost(lifted - middle))[: 20 * count]
    for _ in range(2):
        tried = _gauss_newton_step(tried[some], lift, _STEP)
        some = np.argsort(_cost(lift(tried)))[: len(some) // 4]
    return tried[some[:count]]


def _converged(theta: Array, lift: Lift, step: Array, rounds: int) -> Array:
    """Places improved until none moves by more than a hundredth of a step."""
    for _ in range(rounds):
        better = _gauss_newton_step(theta, lift, step)
        if np.all(np.abs(better - theta) < 0.01 * step):
            return better
        theta = better
    return theta


def _restarted(theta: Array, lift: Lift, rng: np.random.Generator) -> Array:
    """The best place, restarted near it where edges may have stopped the steps, (1, 6)."""
    best = _converged(theta[None], lift, _FINE, _LAST_ROUNDS)
    for _ in range(_RESTARTS):
        if np.sqrt(np.mean(lift(best) ** 2)) < _ROUGH:
            break
        round_it = best + rng.normal(0.0, 1.0, (_RESTART_PLACES, 6)) * _RESTART_SPREAD
        near = _converged(round_it, lift, _FINE, 4)
        near = near[np.argsort(_cost(lift(near)))[:4]]
        both = np.concatenate([best, _converged(near, lift, _FINE, _EXACT_ROUNDS)])
        best = both[[np.argmin(_cost(lift(both)))]]
    return best


def _gauss_newton_step(theta: Array, lift: Lift, step: Array) -> Array:
    """One damped Gauss-Newton step of every place, taken where it improves the fit."""
    moved = theta[:, None] + np.concatenate([np.diag(step), -np.diag(step)])
    both = lift(np.concatenate([theta[:, None], moved], axis=1).reshape(-1, 6))
    both = both.reshape(len(theta), 13, -1)
    now = both[:, 0]
    J = np.swapaxes(both[:, 1:7] - both[:, 7:], 1, 2) / (2.0 * step)
    weight = np.minimum(1.0, _ROBUST / np.maximum(np.abs(now), 1e-9))
    scale = step / step[0]
    J = J * scale
    H = np.einsum("mni,mn,mnj->mij", J, weight, J)
    g = np.einsum("mni,mn,mn->mi", J, weight, now)
    candidates = [theta]
    for damping in (1e-6, 0.1, 3.0):
        eye = damping * np.einsum("mii->m", H)[:, None, None] / 6.0 * np.eye(6) + 1e-9 * np.eye(6)
        way = -np.linalg.solve(H + eye, g[..., None])[..., 0] * scale
        size = np.linalg.norm(way / scale, axis=1, keepdims=True)
        candidates.append(theta + way * np.minimum(1.0, 5.0 / np.maximum(size, 1e-12)))
    every = np.stack(candidates, axis=1)
    costs = _cost(lift(every.reshape(-1, 6))).reshape(every.shape[:2])
    return every[np.arange(len(theta)), np.argmin(costs, axis=1)]


def _distinct(theta: Array, lift: Lift, ball: Array) -> Array:
    """Places that differ by more than `_SAME` at one touch or more, the best first."""
    ranked = theta[np.argsort(_cost(lift(theta)))]
    kept: list[Array] = []
    for one in ranked:
        here = apply(_pose(one), ball)
        if all(np.abs(here - apply(_pose(k), ball)).max() > _SAME for k in kept):
            kept.append(one)
    return np.array(kept)


def _uncertainty(theta: Array, lift: Lift) -> Array:
    """Standard uncertainties from the scatter and the Jacobian of the touches, (6,)."""
    moved = theta + np.concatenate([np.diag(_FINE), -np.diag(_FINE)])
    both = lift(moved)
    J = (both[:6] - both[6:]).T / (2.0 * _FINE)
    r = lift(theta[None])[0]
    s = np.sqrt(r @ r / (len(r) - 6))
    return s * np.sqrt(np.diag(np.linalg.pinv(J.T @ J)))
