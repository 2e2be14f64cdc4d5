"""What a run determines: combinations of parameters, single parameters, and what it never shows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr

from diagnosis.fit import Fit
from diagnosis.linear import solve
from twin.frames import Array
from twin.units import shown

INVISIBLE = 1e-8
"""Singular value over the largest one below which a direction is never seen: far above rounding,
far below the weakest direction that a probed run shows."""

DETERMINED = 10.0
"""A parameter counts as determined when the run cuts its standard deviation by this factor."""

NAMED = 4
"""Most parameters that are written out in the words of a combination."""

SHARE = 0.1
"""A parameter below this share of the largest weight is left out of the words."""


@dataclass(frozen=True, slots=True)
class Combination:
    """A combination of parameters that the run determines by itself.

    ``value = sum_k weight_k theta_k``, scaled so that the leading parameter has weight 1, in whose
    unit the value is.

    Attributes:
        words: Its dominant parameters, the leading one first.
        value: Estimate, base unit of the leading parameter.
        u: Standard uncertainty of the value.
        gain: Prior over posterior standard deviation.
        unit: Base unit of the leading parameter.
        weights: Weight of every parameter, (P,).
    """

    words: str
    value: float
    u: float
    gain: float
    unit: str
    weights: Array


@dataclass(frozen=True, slots=True)
class Determined:
    """A parameter that the run determines alone; base units."""

    name: str
    value: float
    u: float
    prior_sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class Gauge:
    """Parameters that can be moved together without any touch noticing.

    Attributes:
        words: In words.
        members: Names of the parameters, the leading one first.
        weights: How far each moves per unit of the leading one, base units.
    """

    words: str
    members: tuple[str, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Estimable:
    """What a fit can and cannot say.

    Attributes:
        rank: Number of independent combinations that the touches see, without any prior.
        parameters: Number of parameters.
        effective: Number of parameters that the data rather than the prior decide.
        condition: Ratio of the largest to the smallest visible singular value, scaled columns.
        combinations: Best determined first.
        determined: Parameters that are determined by themselves, best first.
        gauges: What no touch of this run shows; the prior keeps it near its mean.
    """

    rank: int
    parameters: int
    effective: float
    condition: float
    combinations: tuple[Combination, ...]
    determined: tuple[Determined, ...]
    gauges: tuple[Gauge, ...]


def estimable(fit: Fit) -> Estimable:
    """Eigen-directions of posterior against prior, single parameters, and gauge freedoms.

    In scaled parameters the prior is the unit matrix and the information of the touches is
    ``X^T X = V s^2 V^T``: the direction v has the posterior variance ``1/(1 + s^2)``. The
    combinations are those of the machine, with the set-ups of the standard free: columns are first
    freed of what a set-up can imitate.

    Args:
        fit: Any fit; its rows in use count.
    """
    X = fit.X[fit.used]
    s, Vt = _singular(X)
    rank = int((s > INVISIBLE * s[0]).sum())
    machine = len(fit.model.parameters)
    free = solve(X[:, machine:], np.zeros(len(X))).Q
    seen, directions = _singular(X[:, :machine] - free @ (free.T @ X[:, :machine]))
    return Estimable(
        rank,
        len(Vt),
        fit.solution.effective_parameters,
        float(s[0] / s[rank - 1]),
        tuple(
            _combination(fit, v, float(x)) for v, x in zip(directions, seen, strict=True) if x > 1.0
        ),
        _determined(fit),
        _gauges(fit, Vt[rank:]),
    )


def _singular(X: Array) -> tuple[Array, Array]:
    """Singular values (P,), largest first, and right singular vectors (P, P), one a row."""
    _, s, Vt = np.linalg.svd(np.linalg.qr(X, mode="r"))
    return np.concatenate([s, np.zeros(len(Vt) - len(s))]), Vt


def _combination(fit: Fit, v: Array, s: float) -> Combination:
    """One eigen-direction, v in scaled parameters of the machine, its leading weight made 1."""
    v = np.concatenate([v, np.zeros(len(fit.prior) - len(v))])
    weights = np.linalg.solve(fit.prior.root.T, v)  # v . phi as weights on theta - mean
    sd = fit.prior.sd
    lead = int(np.argmax(np.abs(weights * sd)))
    scale = weights[lead]
    weights = weights / scale
    u = float(1.0 / (np.sqrt(1.0 + s * s) * abs(scale)))
    words = _words(fit.names, weights, weights * sd)
    unit = fit.parameters[lead][1].unit
    return Combination(
        words, float(weights @ fit.theta), u, float(np.sqrt(1.0 + s * s)), unit, weights
    )


def _words(names: Sequence[str], weights: Array, importance: Array) -> str:
    """`EXX + 0.52 EC0Y - 0.3 ...`: the most important parameters with their weights."""
    order = np.argsort(-np.abs(importance), kind="stable")
    kept = [k for k in order if abs(importance[k]) >= SHARE * abs(importance[order[0]])]
    parts = []
    for k in kept[:NAMED]:
        sign = "-" if weights[k] < 0 else "+"
        size = f"{abs(weights[k]):.3g} "
        parts.append(f"{sign} {'' if size == '1 ' else size}{names[k]}")
    rest = len(kept) - NAMED
    return " ".join(parts).removeprefix("+ ") + (f" and {rest} more" if rest > 0 else "")


def _determined(fit: Fit) -> tuple[Determined, ...]:
    """Single parameters whose uncertainty the run cuts tenfold, the most certain first."""
    sd, u, theta = fit.prior.sd, np.sqrt(np.diag(fit.covariance)), fit.theta
    order = [k for k in np.argsort(u / sd) if u[k] * DETERMINED < sd[k]]
    return tuple(
        Determined(
            fit.names[k], float(theta[k]), float(u[k]), float(sd[k]), fit.parameters[k][1].unit
        )
        for k in order
    )


def _gauges(fit: Fit, null: Array) -> tuple[Gauge, ...]:
    """Sparse directions that span what no touch sees, each with a leading parameter of its own.

    Args:
        fit: The fit.
        null: Orthonormal directions in scaled parameters, (G, P).
    """
    if len(null) == 0:
        return ()
    _, R, pivots = qr(null, mode="economic", pivoting=True)
    count = len(null)
    # reduced echelon form: every direction has 1 in its own pivot and 0 in the others'
    reduced = np.linalg.solve(R[:, :count], R)
    rows = np.zeros_like(null)
    rows[:, pivots] = reduced
    moved = rows @ fit.prior.root.T
    sd = fit.prior.sd
    out = []
    for row, lead in zip(moved, pivots[:count], strict=True):
        weights = row / row[lead]
        importance = np.abs(weights / sd)
        members = [k for k in np.argsort(-importance) if importance[k] > 1e-6 * importance.max()]
        members.sort(key=lambda k: k != lead)
        out.append(
            Gauge(
                _gauge_words(fit, weights, members, int(lead)),
                tuple(fit.names[k] for k in members),
                tuple(float(weights[k]) for k in members),
            )
        )
    return tuple(sorted(out, key=lambda g: len(g.members)))


def _gauge_words(fit: Fit, weights: Array, members: Sequence[int], lead: int) -> str:
    """`EZC1 is never seen`, or which parameters make up for it."""
    name = fit.names[lead]
    others = [k for k in members if k != lead]
    if not others:
        return f"{name} is never seen"
    return f"{name} looks like {_words(fit.names, -weights, _only(weights / fit.prior.sd, others))}"


def _only(values: Array, kept: Sequence[int]) -> Array:
    """The values at some places, zero elsewhere."""
    out = np.zeros_like(values)
    out[list(kept)] = values[list(kept)]
    return out


def shown_value(value: float, u: float, unit: str) -> str:
    """`12.3 ± 0.4 µm`: a number with its uncertainty in the unit that a report shows.

    Example:
        >>> shown_value(0.01234, 0.0004, "mm")
        '12.34 ± 0.40 µm'
    """
    label, factor = shown(unit)
    u_shown = u / factor
    digits = int(np.clip(1 - np.floor(np.log10(u_shown)), 0, 6)) if u_shown > 0.0 else 2
    return f"{value / factor:.{digits}f} ± {u_shown:.{digits}f} {label}"
