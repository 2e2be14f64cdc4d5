"""Regions where a model fails, in words: a shallow tree on residuals, honest about chance."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from diagnosis.fit import Fit
from diagnosis.linear import BoolArray
from diagnosis.patterns import variables
from twin.frames import Array

CHANCE = 1e-3
"""Probability that noise is said to have a region."""

DEPTH = 3
"""Most conditions that are joined."""

SMALLEST = 12
"""Fewest touches of a region in either half of the poses."""

CUTS = 24
"""Thresholds that are tried for a variable."""


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Touches that a model predicts wrongly on average.

    Attributes:
        words: Conditions on columns of the run file, `B_deg > 60 and time_s < 2400`.
        rows: Touches in it, (N,).
        mean: Mean residual over those poses that had no say in drawing the region, mm.
        rms: Root mean square residual over the same poses, mm.
        p_value: Probability of such a mean by chance, over the same poses, all regions together.
    """

    words: str
    rows: BoolArray
    mean: float
    rms: float
    p_value: float


@dataclass(frozen=True, slots=True, eq=False)
class _Leaf:
    conditions: tuple[tuple[str, bool, float], ...]
    rows: BoolArray


def regions(fit: Fit, most: int = 6) -> tuple[Region, ...]:
    """Regions of a run where the mean residual is not zero, the largest share of misfit first.

    One half of the table poses draws the tree, the other half judges its leaves, so that a
    threshold chosen by chance is found out.

    Args:
        fit: Any fit; rows in use count.
        most: Largest number of regions.
    """
    known = {k: v for k, v in _explaining(fit).items() if np.ptp(v) > 0.0}
    z = fit.residual / fit.u
    draws, judges = _halves(fit)
    leaves = _grow(_Leaf((), np.ones(len(z), dtype=bool)), known, z, draws, judges, DEPTH)
    found = []
    for leaf in leaves:
        rows = leaf.rows & judges
        n = int(rows.sum())
        if not leaf.conditions or n < SMALLEST:
            continue
        score = abs(float(z[rows].sum())) / np.sqrt(n)
        p = min(1.0, 2.0 * float(ndtr(-score)) * len(leaves))
        if p < CHANCE:
            r = fit.residual[rows]
            inside = leaf.rows & fit.used
            rms = float(np.sqrt(np.mean(r**2)))
            found.append(Region(_words(leaf.conditions), inside, float(r.mean()), rms, p))
    found.sort(key=lambda g: -abs(g.mean) * g.rows.sum())
    return tuple(found[:most])


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


def _grow(
    leaf: _Leaf, known: dict[str, Array], z: Array, draws: BoolArray, judges: BoolArray, depth: int
) -> list[_Leaf]:
    """Leaves of the best tree below a leaf."""
    split = _best_split(leaf, known, z, draws, judges) if depth > 0 else None
    if split is None:
        return [leaf]
    name, cut = split
    out = []
    for below in (True, False):
        side = known[name] < cut if below else known[name] >= cut
        child = _Leaf((*leaf.conditions, (name, below, cut)), leaf.rows & side)
        out += _grow(child, known, z, draws, judges, depth - 1)
    return out


def _best_split(
    leaf: _Leaf, known: dict[str, Array], z: Array, draws: BoolArray, judges: BoolArray
) -> tuple[str, float] | None:
    """Variable and threshold that part the residuals best, or None if chance could do as well."""
    here, other = leaf.rows & draws, leaf.rows & judges
    if here.sum() < 2 * SMALLEST or other.sum() < 2 * SMALLEST:
        return None
    best, choice, tried = 0.0, None, 0
    for name, values in known.items():
        for cut in _cuts(values[here]):
            low = values[here] < cut
            n = int(low.sum())
            m = len(low) - n
            judged = int((values[other] < cut).sum())
            if min(n, m, judged, int(other.sum()) - judged) < SMALLEST:
                continue
            tried += 1
            difference = float(z[here][low].mean() - z[here][~low].mean())
            score = abs(difference) / np.sqrt(1.0 / n + 1.0 / m)
            if score > best:
                best, choice = score, (name, cut)
    if choice is None or 2.0 * float(ndtr(-best)) * tried > CHANCE:
        return None
    return choice


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
            return float(rounded)
    return high


def _words(conditions: tuple[tuple[str, bool, float], ...]) -> str:
    """Conditions with those on one variable joined to the tightest."""
    low: dict[str, float] = {}
    high: dict[str, float] = {}
    for name, below, cut in conditions:
        if below:
            high[name] = min(cut, high.get(name, np.inf))
        else:
            low[name] = max(cut, low.get(name, -np.inf))
    names = dict.fromkeys(name for name, _, _ in conditions)
    parts = []
    for name in names:
        if " = " in name:
            parts.append(name if name in low else name.replace(" = ", " != "))
        elif name in low and name in high:
            parts.append(f"{low[name]:.6g} <= {name} < {high[name]:.6g}")
        elif name in high:
            parts.append(f"{name} < {high[name]:.6g}")
        else:
            parts.append(f"{name} >= {low[name]:.6g}")
    return " and ".join(parts)
