"""Regions where a model fails, in words: boxes of a few conditions, honest about chance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from diagnosis.fit import Fit
from diagnosis.linear import BoolArray
from diagnosis.patterns import variables
from twin.frames import Array
from twin.words import condition

Limit = tuple[str, float, float]
"""A column with its lower and upper end; one of them may be infinite."""

CHANCE = 1e-3
"""Probability that noise is said to have a region."""

DEPTH = 3
"""Most conditions that are joined."""

SMALLEST = 12
"""Fewest touches of a region in either half of the poses."""

CUTS = 16
"""Thresholds that are tried for a variable."""


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Touches that a model predicts wrongly on average.

    Attributes:
        limits: Lower and upper end of every column that bounds it, in the column's unit; of a
            label such as `feature = pad4` the column is 1 where that is so, else 0.
        rows: Touches in it, (N,).
        mean: Mean residual over those poses that had no say in drawing the region, mm.
        rms: Root mean square residual over the same poses, mm.
        p_value: Probability of such a mean by chance, over the same poses, all regions together.
    """

    limits: tuple[Limit, ...]
    rows: BoolArray
    mean: float
    rms: float
    p_value: float

    @property
    def conditions(self) -> str:
        """Conditions on columns of the run file, `B_deg >= 60 and time_s < 2400`."""
        return " and ".join(_condition(*limit) for limit in self.limits)

    @property
    def words(self) -> str:
        """The same as a reader says it, `B > 60 deg and time < 40 min`."""
        return " and ".join(condition(*limit) for limit in self.limits)


def regions(fit: Fit, most: int = 6) -> tuple[Region, ...]:
    """Regions of a run where the mean residual is not zero, what stands out most first.

    Each is without the touches of those before it.

    Every condition on one column and every pair of them is tried, since a free set-up may leave
    nothing of a misfit in either column alone; a third is joined where it says more. One half of
    the table poses draws the regions, the other half judges them, so that a threshold chosen by
    chance is found out.

    Args:
        fit: Any fit; rows in use count.
        most: Largest number of regions.

    Reference:
        Friedman and Fisher, Bump hunting in high-dimensional data, Statistics and Computing 9
        (1999) 123-143.
    """
    known = {k: v for k, v in _explaining(fit).items() if np.ptp(v) > 0.0}
    draws, judges = _halves(fit)
    offers = _offers(known, draws)
    inside = np.stack([_within(known, limit) for limit in offers]) if offers else None
    if inside is None:
        return ()
    z = fit.residual / fit.u
    left = fit.used
    found = []
    for _ in range(most):
        box = _best_box(inside, z, draws & left, judges & left)
        if box is None:
            break
        rows = np.all(inside[list(box)], axis=0) & left
        region = _judged(fit, [offers[i] for i in box], rows, judges, most)
        if region is not None:
            found.append(region)
        left = left & ~rows
    return tuple(found)


def _judged(
    fit: Fit, limits: Sequence[Limit], rows: BoolArray, judges: BoolArray, count: int
) -> Region | None:
    """A region as those poses see it that had no say in drawing it; None if it may be chance."""
    seen = rows & judges
    z = fit.residual[seen] / fit.u[seen]
    p = min(1.0, 2.0 * float(ndtr(-abs(float(z.sum())) / np.sqrt(len(z)))) * count)
    if p >= CHANCE:
        return None
    r = fit.residual[seen]
    rms = float(np.sqrt(np.mean(r**2)))
    return Region(_joined(limits), rows, float(r.mean()), rms, p)


def _explaining(fit: Fit) -> dict[str, Array]:
    """Variables that a user can find on the machine; temperatures only where time is not known."""
    known = variables(fit.run.touches)
    if "time_s" in known:
        known = {k: v for k, v in known.items() if not k.startswith("T_")}
    t = fit.run.touches
    setups = np.array([s.name for s in t.setups])[t.setup]
    for column, labels in (("feature", t.feature), ("setup", setups)):
        known |= {f"{column} = {k}": (labels == k).astype(float) for k in np.unique(labels)}
    return known


def _halves(fit: Fit) -> tuple[BoolArray, BoolArray]:
    """Touches in use of every other table pose, and those of the rest."""
    t = fit.run.touches
    label = np.unique(np.column_stack([t.setup, t.pose]), axis=0, return_inverse=True)[1]
    odd = label.reshape(-1) % 2 == 1
    if label.max() < 3:  # too few poses: every other touch
        odd = np.arange(len(t)) % 2 == 1
    return fit.used & odd, fit.used & ~odd


def _offers(known: dict[str, Array], draws: BoolArray) -> list[Limit]:
    """Every condition on one column that is tried."""
    out: list[Limit] = []
    for name, values in known.items():
        if " = " in name:
            out.append((name, 0.5, np.inf))
            continue
        for cut in _cuts(values[draws]):
            out += [(name, -np.inf, cut), (name, cut, np.inf)]
    return out


def _within(known: dict[str, Array], limit: Limit) -> BoolArray:
    """Touches that meet a condition, (N,)."""
    name, low, high = limit
    return np.asarray((known[name] >= low) & (known[name] < high))


def _best_box(
    inside: BoolArray, z: Array, draws: BoolArray, judges: BoolArray
) -> tuple[int, ...] | None:
    """Conditions of the region that stands out most, or None if chance could do as well.

    Its worth is the log likelihood of a mean of its own less the log of the number of regions of
    as many conditions that were tried.

    Args:
        inside: Touches that meet each condition, (C, N).
        z: Residuals over their noise, (N,).
        draws: Touches that draw, (N,).
        judges: Touches that judge, (N,).
    """
    drawn, judged = inside[:, draws].astype(float), inside[:, judges].astype(float)
    here = z[draws]
    scores = _scores((drawn * here) @ drawn.T, drawn @ drawn.T, judged @ judged.T)
    worth = 0.5 * scores**2 - np.log(len(inside)) * (2.0 - np.eye(len(inside)))
    i, j = np.unravel_index(int(np.argmax(worth)), worth.shape)
    box, best = tuple(dict.fromkeys((int(i), int(j)))), float(worth[i, j])
    while len(box) < DEPTH:
        part = np.all(drawn[list(box)] > 0.0, axis=0)
        other = np.all(judged[list(box)] > 0.0, axis=0)
        sums, counts = drawn[:, part] @ here[part], drawn[:, part].sum(axis=1)
        more = _scores(sums, counts, judged[:, other].sum(axis=1))
        gained = 0.5 * more**2 - np.log(len(inside)) * (len(box) + 1.0)
        k = int(np.argmax(gained))
        if gained[k] <= best:
            break
        box, best = (*box, k), float(gained[k])
    return box if best > 0.0 else None


def _scores(sums: Array, drawn: Array, judged: Array) -> Array:
    """Sums of residuals over their standard deviation; zero where too few touches draw or judge."""
    enough = (drawn >= SMALLEST) & (judged >= SMALLEST)
    return np.asarray(np.where(enough, np.abs(sums) / np.sqrt(np.maximum(drawn, 1.0)), 0.0))


def _cuts(values: Array) -> list[float]:
    """Round thresholds between the quantiles of some values."""
    unique = np.unique(values)
    if len(unique) < 2:
        return []
    at = np.unique(np.linspace(0, len(unique) - 2, CUTS).astype(int))
    return [_round_between(float(unique[i]), float(unique[i + 1])) for i in at]


def _round_between(low: float, high: float) -> float:
    """The number with the fewest digits in (low, high].

    Example:
        >>> _round_between(2391.7, 2405.1)
        2400.0
    """
    middle = 0.5 * (low + high)
    for digits in range(-6, 12):
        rounded = round(middle, digits)
        if low < rounded <= high:
            return float(rounded) + 0.0  # no negative zero
    return high


def _joined(limits: Sequence[Limit]) -> tuple[Limit, ...]:
    """Conditions with those on one column joined to the tightest."""
    out: dict[str, Limit] = {}
    for name, low, high in limits:
        _, lowest, highest = out.get(name, (name, -np.inf, np.inf))
        out[name] = (name, max(low, lowest), min(high, highest))
    return tuple(out.values())


def _condition(name: str, low: float, high: float) -> str:
    """One range of a column, as a file has it."""
    if " = " in name:
        return name if low > -np.inf else name.replace(" = ", " != ")
    if np.isinf(low):
        return f"{name} < {high:.6g}"
    if np.isinf(high):
        return f"{name} >= {low:.6g}"
    return f"{low:.6g} <= {name} < {high:.6g}"
