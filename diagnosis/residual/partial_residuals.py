"""Partial residuals: what one effect explains, and what was measured of it, over what drives it.

For an effect with deviation c along the normal and a residual r of the whole model, ``r + c`` is
what the run says about that effect alone. Where the effect acts at one place of the machine both
are divided by the deviation along the normal per unit of that place, so that a picture shows the
component error itself, EZZ over time, whatever way the touches looked.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual.patterns import variables
from matstd.twin.effects import normal_in_tool
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import LETTERS
from matstd.twin.model import Effect, Where, columns, inner_values, traits
from matstd.twin.record import Touches
from matstd.twin.units import DEG

MAX_ROUGHNESS = 0.12
"""Share of an effect's variance in its steps between neighbours over a variable, from which it is
no function of that variable."""

MIN_VIEW = 0.25
"""Touches that see an effect with less than this share of the best view are not drawn as points."""


class Seen(Enum):
    """What an effect is drawn as."""

    DEVIATION = "deviation along the normal"
    WHERE_MOST = "deviation where it shows most"
    BIAS = "bias along the normal"
    SHIFT = "shift of the standard"
    ERROR = "component error"


class Drawn(NamedTuple):
    """What an effect is drawn as; which direction or component error, and whether in rad."""

    seen: Seen
    symbol: str = ""
    is_angular: bool = False


class Driver(NamedTuple):
    """What an effect is drawn over: a column of the run or ""; within a period of it, or 0."""

    column: str
    period: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Partial:
    """What a run shows of one effect, touch by touch."""

    # what it is drawn over; without a column it is no function of one variable, and `x` is then
    # what it explains
    driver: Driver
    x: Array  # of every touch, in the unit of the driver's column, (M,)
    drawn: Drawn
    explained: Array  # by the effect, (M,), mm or rad
    observed: Array  # the same plus the residual of the whole model, (M,)
    weight: Array  # of every touch, one over its variance, (M,)
    shown: IntArray  # numbers of the touches that see the effect well enough to be drawn as points
    rows: IntArray  # of the run, (M,): those in the fit, then those held out
    way: IntArray  # sign of the last motion where the effect is another for either, (M,), else 0


def partial(fit: Fit, effect: Effect) -> Partial:
    """Partial residuals of an effect that is in a fit.

    Raises:
        KeyError: It is not in the fit.
    """
    touches = fit.run.touches
    theta = fit.theta[fit.of_effect(effect.name)]
    rows = np.concatenate([np.flatnonzero(fit.used), np.flatnonzero(fit.test_rows)])
    drawn, whole, per_unit = _split(effect, touches, theta)
    explained = whole[rows]
    seen = per_unit[rows]
    usable = np.where(np.abs(seen) > 1e-12, seen, 1e-12)
    observed = explained + fit.residual[rows] / usable
    weight = (usable / fit.run.u[rows]) ** 2
    shown = np.flatnonzero(np.abs(seen) >= MIN_VIEW * float(np.quantile(np.abs(seen), 0.99)))
    driver, x = _driver(effect, touches, rows, explained)
    return Partial(
        driver=driver,
        x=x,
        drawn=drawn,
        explained=explained,
        observed=observed,
        weight=weight,
        shown=shown,
        rows=rows,
        way=_ways(effect, touches)[rows],
    )


def _ways(effect: Effect, touches: Touches) -> IntArray:
    """Sign of the last motion of the axis of an effect with a course for either direction, (N,)."""
    own = traits(effect)
    if own.reversal is None or own.symbol is None:
        return np.zeros(len(touches), dtype=np.int64)
    return np.sign(touches.last_move(own.symbol.link)).astype(np.int64)


def _split(effect: Effect, touches: Touches, theta: Array) -> tuple[Drawn, Array, Array]:
    """An effect as a quantity at every touch times the deviation along the normal per unit of it.

    At one place of the machine it is the component error there. At several places that all follow
    one course it is the deviation where that shows most. Else it is the deviation itself.

    Returns:
        What the quantity is, the quantity (N,), deviation per unit (N,).
    """
    terms = effect.terms(touches)
    places = {term.where for term in terms}
    if len(places) == 1:
        where = places.pop()
        whole = np.sum([theta[t.parameter] * t.amount for t in terms], axis=0)
        return _place(where, touches), np.asarray(whole), touches.signature.of(where)
    deviation = columns([effect], touches) @ theta
    course = _common_course(np.stack([t.amount for t in terms]))
    if course is None:
        return Drawn(Seen.DEVIATION), deviation, np.ones(len(touches))
    per_course = np.sum(
        [
            theta[t.parameter] * w * touches.signature.of(t.where)
            for t, w in zip(terms, course[1], strict=True)
        ],
        axis=0,
    )
    most = per_course[np.argmax(np.abs(per_course))]
    return Drawn(Seen.WHERE_MOST), most * course[0], per_course / most


def _common_course(amounts: Array) -> tuple[Array, Array] | None:
    """The course (N,) that amounts (T, N) have in common, with their weights (T,); None if none."""
    size = np.linalg.norm(amounts, axis=1)
    course = amounts[np.argmax(size)]
    weights = amounts @ course / max(float(course @ course), 1e-300)
    left = np.abs(amounts - weights[:, None] * course).max()
    return (course, weights) if left < 1e-9 * np.abs(course).max() else None


def _place(where: Where, touches: Touches) -> Drawn:
    """An entry of a contribution."""
    if where.part == "bias":
        return Drawn(Seen.BIAS)
    letter = LETTERS[where.component]
    if where.part == "shift":
        return Drawn(Seen.SHIFT, letter, where.is_angular)
    link = touches.chain.links[where.link].name
    zero = "0" if where.part == "place" else ""
    return Drawn(Seen.ERROR, f"E{letter}{zero}{link}", where.is_angular)


def _driver(
    effect: Effect, touches: Touches, rows: IntArray, explained: Array
) -> tuple[Driver, Array]:
    """The variable that an effect is a smooth function of, the most informative first."""
    known = {k: v[rows] for k, v in _drivers(effect, touches).items()}
    rough = {k: roughness(v, explained) for k, v in known.items()}
    smooth = [k for k in known if rough[k] < MAX_ROUGHNESS]
    if not smooth:
        return Driver(""), explained
    # the order in which drivers are offered decides between those that are about equally good
    best = next(k for k in smooth if rough[k] <= max(3.0 * min(rough.values()), 0.01))
    return best, known[best]


def _drivers(effect: Effect, touches: Touches) -> Mapping[Driver, Array]:
    """Everything an effect may be a function of, in order."""
    known = variables(touches)
    scanned = inner_values(effect, touches)
    out: dict[Driver, Array] = {}
    if any(inner.unit == "s" for inner, _ in scanned):
        out[Driver("time_s")] = touches.since_start
    for axis in touches.chain.programmed_axes:
        q, is_rotary = touches.reading(axis), touches.chain.link(axis).kind == "rotary"
        column, unit = (f"{axis}_deg", DEG) if is_rotary else (f"{axis}_mm", 1.0)
        for value in (v for inner, v in scanned if inner.over == axis):
            period = 2.0 * np.pi / value if is_rotary else value
            out[Driver(column, period / unit)] = q % period / unit
        out[Driver(column)] = q / unit
        out[Driver(f"dir{axis}")] = touches.last_move(axis)
    n = normal_in_tool(touches)
    out[Driver("azimuth_deg")] = np.arctan2(n[:, 1], n[:, 0]) / DEG
    out[Driver("inclination_deg")] = np.arccos(np.clip(n[:, 2], -1.0, 1.0)) / DEG
    out |= {Driver(f"T_{sensor}_degC"): v for sensor, v in touches.temperature.items()}
    if "spindle_rpm" in known:
        out[Driver("spindle_rpm")] = known["spindle_rpm"]
    out[Driver("time_s")] = touches.since_start
    return {k: v for k, v in out.items() if np.ptp(v) > 0.0}


def roughness(x: Array, y: Array) -> float:
    """Half the mean squared step of y between neighbours in x over its variance; 1 for no function.

    Values of x that coincide are neighbours at random: their scatter counts in full. A constant is
    a function of anything.

    Reference:
        von Neumann, Annals of Mathematical Statistics 12 (1941) 367-395.
    """
    spread = float(np.var(y))
    if spread < 1e-24 * max(1.0, float(np.mean(y) ** 2)):
        return 0.0
    order = np.lexsort((np.arange(len(y)) * 7919 % len(y), x))
    return float(0.5 * np.mean(np.diff(y[order]) ** 2) / spread)
