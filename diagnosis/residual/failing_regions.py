"""Regions where a model fails: boxes of a few conditions, honest about chance.

A user who reads "wrong by 8 µm where B > 60 deg" knows where to look. Every condition on one
variable, and every pair of them, is a box; its worth is the likelihood that a mean (or a scatter)
of its own gains, less what it costs to choose it among so many. The best box is drawn on one half
of the table poses and judged on the other, its touches are set aside, and the next is looked for.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import BoolArray, f_tail
from matstd.diagnosis.residual.patterns import variables
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

MAX_CONDITIONS = 3
"""Most conditions that are joined."""

MIN_TOUCHES_OF_REGION = 12
"""Fewest touches of a region in either half of the poses."""

MAX_CUTS = 16
"""Thresholds that are tried for a variable."""


class Side(Enum):
    """On which side of its bound a condition holds; the values are those of the files."""

    BELOW = "<"
    FROM = ">="
    IS = "="


class Condition(NamedTuple):
    """One condition on a column of the run file: `B_deg >= 60`, `feature = pad4`."""

    variable: str
    side: Side
    bound: float | str


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Touches that a model predicts wrongly: on average, or worse than others with both signs.

    Attributes:
        conditions: All of them hold in it; bounds in the unit of the column, at most one of each
            side for a column.
        rows: Touches in it, (N,).
        mean: Mean residual over those poses that had no say in drawing the region, mm.
        rms: Root mean square residual over the same poses, mm.
        p_value: Probability of such a mean, or of a scatter so much larger than that of the other
            touches, by chance, over the same poses, all regions together.
        u: Standard uncertainty of the mean, from the noise, mm.
    """

    conditions: tuple[Condition, ...]
    rows: BoolArray
    mean: float
    rms: float
    p_value: float
    u: float


def regions(fit: Fit, cured: Fit | None = None, most: int = 6) -> tuple[Region, ...]:
    """Regions of a run where the mean residual is not zero, what stands out most first.

    Each is without the touches of those before it. Where no mean stands out, since what is wrong
    has both signs everywhere, regions where the residual is larger than elsewhere.

    Every condition on one column and every pair of them is tried, since a free set-up may leave
    nothing of a misfit in either column alone; a third is joined where it says more. One half of
    the table poses draws the regions, the other half judges them, so that a threshold chosen by
    chance is found out.

    Args:
        cured: The same with the effects that it lacked. What they explain then draws the regions:
            so few numbers, that are known not to be chance, need no half of the poses to judge
            them, and the residuals of all do.

    Reference:
        Friedman and Fisher, Bump hunting in high-dimensional data, Statistics and Computing 9
        (1999) 123-143.
    """
    known = {k: v for k, v in _explaining(fit).items() if (v != v[0]).any()}
    draws, judges = _halves(fit) if cured is None else (fit.used, fit.used)
    offers = _offers(known, draws)
    if not offers:
        return ()
    inside = np.stack([_holds(known[c.variable], c) for c in offers])
    u = fit.u if cured is None else cured.u
    z = _even(fit) / u
    drawing = z if cured is None else (fit.residual - cured.residual) / u
    squares = z**2 if cured is None else 1.0 + drawing**2
    for kind, values in ((_BY_MEAN, drawing), (_BY_SIZE, squares)):
        # a region that the judging half rejects is removed too, so that the search goes on
        left = fit.used
        found: list[Region] = []
        for _ in range(most):
            box = _best_box(inside, values, draws & left, judges & left, kind)
            if box is None:
                break
            rows = np.all(inside[list(box)], axis=0) & left
            region = _judged(fit, [offers[i] for i in box], u, (rows, judges & left), kind, most)
            if region is not None:
                found.append(region)
            left = left & ~rows
        if found:
            return tuple(found)
    return ()


def _even(fit: Fit) -> Array:
    """Residuals with the share given back that the fit takes from each row in use, (N,), mm."""
    out = fit.residual.copy()
    out[fit.used] /= np.sqrt(np.maximum(1.0 - fit.solution.leverage, 1e-6))
    return out


def _mean_worth(sums: Array, counts: Array, values: Array) -> Array:
    """Log likelihood that a mean of its own gains a region."""
    return 0.5 * sums**2 / np.maximum(counts, 1.0)


def _size_worth(sums: Array, counts: Array, values: Array) -> Array:
    """Log likelihood that a larger variance of its own gains a region; sums are of squares."""
    count, total = len(values), float(values.sum())
    others = np.maximum(count - counts, 1.0)
    here = np.maximum(sums / np.maximum(counts, 1.0), 1e-12)
    there = np.maximum((total - sums) / others, 1e-12)
    gained = count * np.log(total / count) - counts * np.log(here) - others * np.log(there)
    return np.where((here > there) & (count - counts >= MIN_TOUCHES_OF_REGION), 0.5 * gained, 0.0)


def _mean_chance(z: Array, others: Array) -> float:
    """Probability of such a mean in noise, either sign."""
    return 2.0 * float(ndtr(-abs(float(z.sum())) / np.sqrt(len(z))))


def _size_chance(z: Array, others: Array) -> float:
    """Probability of such a variance beside that of the others, F test."""
    ratio = float(np.mean(z**2) / np.mean(others**2)) if len(others) else 0.0
    return float(f_tail(ratio, len(z), len(others)))


@dataclass(frozen=True, slots=True)
class _Kind:
    """How a region stands out.

    Attributes:
        worth: Log likelihood gained, from sums and numbers of touches in boxes and all values.
        chance: Probability of a region's normalised residuals beside those of the others.
    """

    worth: Callable[[Array, Array, Array], Array]
    chance: Callable[[Array, Array], float]


_BY_MEAN = _Kind(_mean_worth, _mean_chance)
_BY_SIZE = _Kind(_size_worth, _size_chance)


def _judged(
    fit: Fit,
    conditions: Sequence[Condition],
    noise: Array,
    who: tuple[BoolArray, BoolArray],
    kind: _Kind,
    count: int,
) -> Region | None:
    """A region as those poses see it that had no say in drawing it; None if it may be chance."""
    rows, judges = who
    seen, z = rows & judges, _even(fit) / noise
    p = min(1.0, kind.chance(z[seen], z[judges & ~rows]) * count)
    if p >= POLICY.false_alarm:
        return None
    r = fit.residual[seen]
    u = float(np.sqrt(np.sum(noise[seen] ** 2)) / len(r))
    return Region(
        conditions=_tightest(conditions),
        rows=rows,
        mean=float(r.mean()),
        rms=rms(r),
        p_value=p,
        u=u,
    )


def _explaining(fit: Fit) -> dict[str, NDArray[Any]]:
    """Variables and labels that a user can find on the machine, (N,) each.

    Temperatures only where time is not known: they follow it.
    """
    known: dict[str, NDArray[Any]] = dict(variables(fit.run.touches))
    if "time_s" in known:
        known = {k: v for k, v in known.items() if not k.startswith("T_")}
    t = fit.run.touches
    setups = np.array([s.name for s in t.setups])[t.setup]
    return known | {"feature": t.feature, "setup": setups}


def _halves(fit: Fit) -> tuple[BoolArray, BoolArray]:
    """Touches in use of every other table pose, and those of the rest."""
    t = fit.run.touches
    label = np.unique(np.column_stack([t.setup, t.pose]), axis=0, return_inverse=True)[1]
    odd = label.reshape(-1) % 2 == 1
    if label.max() < 3:  # too few poses: every other touch
        odd = np.arange(len(t)) % 2 == 1
    return fit.used & odd, fit.used & ~odd


def _offers(known: dict[str, NDArray[Any]], draws: BoolArray) -> list[Condition]:
    """Every condition on one column that is tried."""
    out: list[Condition] = []
    for name, values in known.items():
        if values.dtype.kind == "U":
            out += [Condition(name, Side.IS, str(label)) for label in np.unique(values)]
            continue
        for cut in _cuts(values[draws]):
            out += [Condition(name, Side.BELOW, cut), Condition(name, Side.FROM, cut)]
    return out


def _holds(values: NDArray[Any], condition: Condition) -> BoolArray:
    """Touches that meet a condition, (N,)."""
    if condition.side is Side.IS:
        return np.asarray(values == condition.bound)
    below = values < condition.bound
    return np.asarray(below if condition.side is Side.BELOW else ~below)


def _best_box(
    inside: BoolArray, values: Array, draws: BoolArray, judges: BoolArray, kind: _Kind
) -> tuple[int, ...] | None:
    """Conditions of the region that stands out most, or None if chance could do as well.

    Its worth is the log likelihood gained by what is its own, less the log of the number of regions
    of as many conditions that were tried.

    Args:
        inside: Touches that meet each condition, (C, N).
        values: Of which a region's sum is taken, (N,).
        draws: Touches that draw, (N,).
        judges: Touches that judge, (N,).
    """
    drawn, judged = inside[:, draws].astype(float), inside[:, judges].astype(float)
    here = values[draws]
    if not len(here):
        return None

    def worth(sums: Array, counts: Array, others: Array) -> Array:
        enough = (counts >= MIN_TOUCHES_OF_REGION) & (others >= MIN_TOUCHES_OF_REGION)
        return np.where(enough, kind.worth(sums, counts, here), 0.0)

    both = worth((drawn * here) @ drawn.T, drawn @ drawn.T, judged @ judged.T)
    both = both - np.log(len(inside)) * (2.0 - np.eye(len(inside)))
    i, j = np.unravel_index(int(np.argmax(both)), both.shape)
    box, best = tuple(dict.fromkeys((int(i), int(j)))), float(both[i, j])
    while len(box) < MAX_CONDITIONS:
        part = np.all(drawn[list(box)] > 0.0, axis=0)
        other = np.all(judged[list(box)] > 0.0, axis=0)
        sums, counts = drawn[:, part] @ here[part], drawn[:, part].sum(axis=1)
        more = worth(sums, counts, judged[:, other].sum(axis=1))
        gained = more - np.log(len(inside)) * (len(box) + 1.0)
        k = int(np.argmax(gained))
        if gained[k] <= best:
            break
        box, best = (*box, k), float(gained[k])
    return box if best > 0.0 else None


def _cuts(values: Array) -> list[float]:
    """Round thresholds between the quantiles of some values."""
    unique = np.unique(values)
    if len(unique) < 2:
        return []
    at = np.unique(np.linspace(0, len(unique) - 2, MAX_CUTS).astype(int))
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


def _tightest(conditions: Sequence[Condition]) -> tuple[Condition, ...]:
    """Conditions of which none follows from another, column by column, lower bounds first."""
    out = []
    for name in dict.fromkeys(c.variable for c in conditions):
        own = [c for c in conditions if c.variable == name]
        for side, tightest in ((Side.IS, min), (Side.FROM, max), (Side.BELOW, min)):
            bounds = [c.bound for c in own if c.side is side]
            out += [Condition(name, side, tightest(bounds))] if bounds else []
    return tuple(out)
