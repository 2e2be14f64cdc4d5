"""What a residual does over every variable of its run, the one it depends on most first."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual.patterns import variables
from matstd.twin.frames import Array
from matstd.twin.record import Touches

MAX_BINS = 12  # bins of a variable, of equally many touches each
MIN_TOUCHES_OF_BIN = 6  # touches of a bin, at least
MAX_LABELS = 16  # labels of a feature that are shown one by one


def standardised(fit: Fit) -> Array:
    """Residuals over their own standard deviation with the noise as stated, (N,).

    A row that the fit rests upon has ``u sqrt(1 - h)`` with its leverage h, since it drew the fit
    towards itself; a row left out has ``u sqrt(1 + s^2)`` with the uncertainty s of its prediction.
    If the model is right and the noise as stated they are standard normal.
    """
    own = (fit.solution.spread(fit.X) ** 2).sum(axis=1)
    variance = np.where(fit.used, 1.0 - own, 1.0 + own)
    return np.asarray(fit.residual / (fit.run.u * np.sqrt(np.maximum(variance, 1e-6))))


def binned(
    values: Array, r: Array, weight: Array, most: int = MAX_BINS
) -> tuple[Array, Array, Array]:
    """Means of residuals in bins of a variable that hold equally many touches.

    Values that occur often keep a bin of their own. The standard error is that of the scatter
    within the bin.

    Args:
        values: Of the variable, (N,).
        r: Residuals, (N,).
        weight: Of each, such as one over its variance, (N,).

    Returns:
        Mean value, mean residual and its standard error of every bin, (B,) each.
    """
    distinct = np.unique(values)
    if len(distinct) <= most:
        label = np.searchsorted(distinct, values)
    else:
        count = int(np.clip(len(values) // MIN_TOUCHES_OF_BIN, 1, most))
        edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, count + 1)[1:-1]))
        label = np.searchsorted(edges, values, side="right")
    w = np.bincount(label, weight)
    n = np.bincount(label)
    full = n >= 2
    with np.errstate(invalid="ignore", divide="ignore"):
        x = np.bincount(label, weight * values) / w
        mean = np.bincount(label, weight * r) / w
        squares = np.bincount(label, weight * (r - mean[label]) ** 2) / w
        error = np.sqrt(squares / np.maximum(n - 1, 1))
    return x[full], mean[full], error[full]


@dataclass(frozen=True, slots=True, eq=False)
class RankedVariable:
    """A variable of a run with what the residual does over it."""

    name: str  # column of the run file, or what parts the touches
    values: Array  # of the touches in use, (N,)
    # names of the values 0, 1, ... of a variable that parts touches in few groups
    labels: tuple[str, ...] | None
    strength: float  # mean squared ratio of a bin's mean to its standard error; 1 in pure noise


def rank_variables(fit: Fit) -> tuple[RankedVariable, ...]:
    """Everything that was recorded and varies, the one on which the residual depends most first."""
    rows = fit.used
    r, weight = fit.residual[rows], 1.0 / fit.run.u[rows] ** 2
    known: list[tuple[str, Array, tuple[str, ...] | None]] = [
        (k, v[rows], None) for k, v in variables(fit.run.touches).items()
    ]
    known += [(k, v[rows], names) for k, v, names in labelled(fit.run.touches)]
    out = []
    for name, values, labels in known:
        if np.ptp(values) > 0.0:
            _, mean, error = binned(values, r, weight)
            strength = float(np.mean((mean / np.maximum(error, 1e-12)) ** 2)) if len(mean) else 0.0
            out.append(RankedVariable(name, values, labels, strength))
    return tuple(sorted(out, key=lambda p: -p.strength))


def labelled(touches: Touches) -> list[tuple[str, Array, tuple[str, ...] | None]]:
    """What parts the touches in groups: last motion of every axis, feature, set-up, pose.

    Returns:
        Name, number of the group of every touch (N,), and the names of few enough groups.
    """
    known = [(f"last move of {a}", np.sign(touches.last_move(a))) for a in touches.chain.axes]
    out: list[tuple[str, Array, tuple[str, ...] | None]] = []
    for name, sign in known:
        present, label = np.unique(sign, return_inverse=True)
        words = tuple({-1.0: "minus", 0.0: "unknown", 1.0: "plus"}[s] for s in present)
        out.append((name, label.astype(float), words))
    names, label = np.unique(touches.feature, return_inverse=True)
    shown = tuple(str(n) for n in names) if len(names) <= MAX_LABELS else None
    out.append(("feature", label.astype(float), shown))
    out.append(("set-up", touches.setup.astype(float), tuple(s.name for s in touches.setups)))
    out.append(("pose", touches.pose.astype(float), None))
    return out
