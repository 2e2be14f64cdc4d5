"""What a model promises of its error: at the same touches again, and at other places.

At the same touches a run predicts itself: what it does not know of the machine there, it has seen
anyway. Elsewhere two things come on top. What the touches left open of the machine acts where they
did not look, ``u_i^2 = c_i C c_i^T`` with C the covariance of the estimates and c_i the columns
there, freed of what the placing of a standard takes up. And a law may hold only where it was seen:
so blocks of a domain (half of a stroke, a set-up, a part of the time) are left out, and how much
larger their errors are than their uncertainties multiplies it.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.accuracy.left_out_blocks import domains
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import left_out, solve
from matstd.twin.effects import setup_errors
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import inverse_linear
from matstd.twin.model import Model, columns
from matstd.twin.record import Instrument, Touches

OTHER_PLACES = 1000
"""Touches at other places, at least: their mean variance is known within a few per cent."""

MIN_BLOCKS = 3
"""Set-ups from which standards are placed as set-ups stood; with fewer, the standard stays."""

ON_STANDARD = (Instrument.TOUCH_PROBE, Instrument.CMM, Instrument.BALL_BAR)
"""Instruments whose points are of a body that is placed as a whole."""

LINEAR_AXES = 3  # linear axes that bring the tool to any point


@dataclass(frozen=True, slots=True)
class Domain:
    """Blocks of one domain left out in turn."""

    name: str  # a column of the run, `X_mm`; or `time_s`, `setup`
    ratio: float  # their errors over their uncertainties, rms; 1 for a model that holds there


@dataclass(frozen=True, slots=True)
class Promise:
    """Errors to expect of a model, rms of single touches, mm."""

    same: float  # in another run of the same touches
    elsewhere: float  # at other places, paths and set-ups within what was probed
    domains: tuple[Domain, ...]  # blocks left out, the worst first


def promise(fit: Fit, chosen: float | None = None) -> Promise:
    """What a fit promises; the other places are drawn alike each time.

    Args:
        chosen: Error of blocks left out, the choice of the model repeated without each, mm: the
            error of rows that nothing was chosen by, unless the file holds such rows out itself.
            None where nothing was chosen by prediction.
    """
    rng = np.random.default_rng(0)
    found = []
    for name, parts in domains(fit.run.touches, fit.used).items():
        squared = left_out(fit.solution.Q, fit.solution.residual, parts).squared
        found.append(Domain(name, float(np.sqrt(squared / fit.used.sum()))))
    found.sort(key=lambda d: -d.ratio)
    worst = found[0].ratio if found else 1.0
    touches, m = fit.run.touches, len(fit.model.parameters)
    variances = []
    for _ in range(1 + OTHER_PLACES // len(touches)):
        there = other_places(touches, rng)
        u = fit.u * fit.weight
        variances.append(machine_variance(there, fit.model, fit.spread[:m], u))
    square = fit.standardised_test_rms**2 + worst**2 * float(np.mean(variances))
    same = fit.test_rms if chosen is None or fit.test_rows.any() else chosen
    return Promise(same, max(float(np.sqrt(square)), same), tuple(found))


def machine_variance(touches: Touches, model: Model, root: Array, u: Array) -> Array:
    """Variance of a prediction that no set-up takes up, (N,), mm^2; arguments of `machine_root`."""
    left = machine_root(touches, model, root, u)
    return np.asarray(np.einsum("nk,nk->n", left, left))


def machine_root(touches: Touches, model: Model, root: Array, u: Array) -> Array:
    """Root of the covariance of a prediction that no set-up takes up, (N, K), mm.

    Args:
        root: Of the covariance of the model's parameters, (P, K), base units.
        u: Noise of every touch, (N,), mm, beside which set-ups are estimated.
    """
    placed = setup_errors(touches)
    sd = np.array([p.sd for e in placed for p in e.parameters])
    S = model.columns(touches) @ root / u[:, None]
    free = solve(columns(placed, touches) * sd / u[:, None], np.zeros(len(S))).Q
    return np.asarray((S - free @ (free.T @ S)) * u[:, None])


def other_places(touches: Touches, rng: np.random.Generator) -> Touches:
    """The same touches where the axes did not stand together, each in the range it was probed in.

    A rotary axis turns from pose to pose to where it stood in another pose. A standard is placed
    where another set-up was, one coordinate like this, the next like that, and the linear axes
    follow; without one, the linear axes move as the rotary ones do. A standard of few set-ups stays
    where it stood: moved by poses it would turn with what its alignment leaves open.
    """
    chain = touches.chain
    q = (touches.q if touches.commanded is None else touches.commanded).copy()
    poses = _labels(touches, touches.pose)
    is_standing = touches.instrument in ON_STANDARD and len(chain.linear_axes) == LINEAR_AXES
    moved = chain.rotary_axes if is_standing else chain.axes
    for k in map(chain.axis_index, moved):
        q[:, k] = _elsewhere(q[:, k], poses, rng)
    if not is_standing:
        there = replace(touches, q=q, commanded=None)
        return replace(there, point=there.ball_artefact - touches.radius[:, None] * touches.normal)
    setups, point = _labels(touches, np.zeros_like(touches.pose)), touches.point_table
    if setups.max() + 1 >= MIN_BLOCKS:
        point = np.column_stack([_elsewhere(point[:, k], setups, rng) for k in range(LINEAR_AXES)])
    target = point + touches.radius[:, None] * touches.normal_table
    return replace(touches, q=inverse_linear(chain, target, q, touches.target), commanded=None)


def _elsewhere(values: Array, label: IntArray, rng: np.random.Generator) -> Array:
    """Values of labelled rows, each label moved to where another one lay, (N,)."""
    count = np.bincount(label)
    middle = np.bincount(label, values) / count
    return values + (middle[rng.integers(len(count), size=len(count))] - middle)[label]


def _labels(touches: Touches, pose: IntArray) -> IntArray:
    key = np.column_stack([touches.setup, pose])
    return np.unique(key, axis=0, return_inverse=True)[1].reshape(-1)
