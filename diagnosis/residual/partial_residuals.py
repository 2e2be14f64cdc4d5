"""Partial residuals: what one effect explains, and what was measured of it, over what drives it.

For an effect with deviation c along the normal and a residual r of the whole model, ``r + c`` is
what the run says about that effect alone. Where the effect acts at one place of the machine both
are divided by the deviation along the normal per unit of that place, so that the picture shows the
component error itself, EZZ in µm over time, whatever way the touches looked.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from diagnosis.fit import Fit
from diagnosis.residual.patterns import variables
from twin.effects import normal_in_tool
from twin.frames import Array
from twin.model import Effect, Where, columns, inner_values
from twin.record import IntArray, Touches
from twin.units import DEG, MINUTE, UM, URAD

LETTERS = "XYZABC"

ROUGH = 0.12
"""Share of an effect's variance in its steps between neighbours over a variable, from which it is
no function of that variable."""

SEES = 0.25
"""Touches that see an effect with less than this share of the best view are not drawn as points."""


@dataclass(frozen=True, slots=True, eq=False)
class Partial:
    """What a run shows of one effect, touch by touch.

    Attributes:
        variable: What the effect is drawn over, with its unit; "" where it is no function of one
            variable, and `x` is then what it explains.
        x: Of every touch, (M,).
        quantity: What is drawn, with its unit.
        explained: By the effect, (M,).
        observed: The same plus the residual of the whole model, (M,).
        weight: Of every touch, one over its variance, (M,).
        shown: Numbers of the touches that see the effect well enough to be drawn as points.
        rows: Of the run, (M,): those in the fit, then those held out.
    """

    variable: str
    x: Array
    quantity: str
    explained: Array
    observed: Array
    weight: Array
    shown: IntArray
    rows: IntArray


def partial(fit: Fit, effect: Effect) -> Partial:
    """Partial residuals of an effect that is in a fit.

    Args:
        fit: The model with everything in it.
        effect: As it stands in the fit.

    Raises:
        KeyError: It is not in the fit.
    """
    touches = fit.run.touches
    theta = fit.theta[fit.of_effect(effect.name)]
    rows = np.concatenate([np.flatnonzero(fit.used), np.flatnonzero(fit.test_rows)])
    name, unit, whole, per_unit = _split(effect, touches, theta)
    explained = whole[rows] / unit
    seen = per_unit[rows]
    usable = np.where(np.abs(seen) > 1e-12, seen, 1e-12)
    observed = explained + fit.residual[rows] / (usable * unit)
    weight = (usable * unit / fit.run.u[rows]) ** 2
    shown = np.flatnonzero(np.abs(seen) >= SEES * float(np.quantile(np.abs(seen), 0.99)))
    variable, x = _driver(effect, touches, rows, explained)
    return Partial(variable, x, name, explained, observed, weight, shown, rows)


def _split(effect: Effect, touches: Touches, theta: Array) -> tuple[str, float, Array, Array]:
    """An effect as a quantity at every touch times the deviation along the normal per unit of it.

    At one place of the machine it is the component error there. At several places that all follow
    one course it is the deviation where that shows most. Else it is the deviation itself.

    Returns:
        Name with unit, one of that unit in the base unit, the quantity (N,), deviation per unit
        (N,).
    """
    terms = effect.terms(touches)
    places = {term.where for term in terms}
    if len(places) == 1:
        where = places.pop()
        whole = np.sum([theta[t.parameter] * t.amount for t in terms], axis=0)
        return (*_place(where, touches), np.asarray(whole), touches.signature.of(where))
    deviation = columns([effect], touches) @ theta
    course = _common_course(np.stack([t.amount for t in terms]))
    if course is None:
        return "deviation along the normal, µm", UM, deviation, np.ones(len(touches))
    per_course = np.sum(
        [
            theta[t.parameter] * w * touches.signature.of(t.where)
            for t, w in zip(terms, course[1], strict=True)
        ],
        axis=0,
    )
    most = per_course[np.argmax(np.abs(per_course))]
    return "deviation where it shows most, µm", UM, most * course[0], per_course / most


def _common_course(amounts: Array) -> tuple[Array, Array] | None:
    """The course (N,) that amounts (T, N) have in common, with their weights (T,); None if none."""
    size = np.linalg.norm(amounts, axis=1)
    course = amounts[np.argmax(size)]
    weights = amounts @ course / max(float(course @ course), 1e-300)
    left = np.abs(amounts - weights[:, None] * course).max()
    return (course, weights) if left < 1e-9 * np.abs(course).max() else None


def _place(where: Where, touches: Touches) -> tuple[str, float]:
    """Name of an entry of a contribution with its unit, and one of that unit in the base unit."""
    if where.part == "bias":
        return "bias along the normal, µm", UM
    unit, factor = ("µrad", URAD) if where.is_angular else ("µm", UM)
    letter = LETTERS[where.component]
    if where.part == "shift":
        return f"shift of the standard in {letter}, {unit}", factor
    link = touches.chain.links[where.link].name
    zero = "0" if where.part == "place" else ""
    return f"E{letter}{zero}{link}, {unit}", factor


def _driver(
    effect: Effect, touches: Touches, rows: IntArray, explained: Array
) -> tuple[str, Array]:
    """The variable that an effect is a smooth function of, the most telling first."""
    known = {k: v[rows] for k, v in _drivers(effect, touches).items()}
    rough = {k: roughness(v, explained) for k, v in known.items()}
    smooth = [k for k in known if rough[k] < ROUGH]
    if not smooth:
        return "", explained
    # the order in which drivers are offered decides between those that are about equally good
    best = next(k for k in smooth if rough[k] <= max(3.0 * min(rough.values()), 0.01))
    return best, known[best]


def _drivers(effect: Effect, touches: Touches) -> Mapping[str, Array]:
    """Everything an effect may be a function of, with units for an axis of a picture, in order."""
    known = variables(touches)
    scanned = inner_values(effect, touches)
    periods = [value for inner, value in scanned if inner.acts == "with a period"]
    out: dict[str, Array] = {}
    time = _time(touches)
    if any(inner.unit == "s" for inner, _ in scanned):
        out |= time
    for axis in touches.chain.programmed_axes:
        q = touches.reading(axis)
        for period in periods:
            out[f"{axis} within a period of {period:.4g} mm"] = q % period
        unit, factor = ("°", DEG) if touches.chain.link(axis).kind == "rotary" else ("mm", 1.0)
        out[f"{axis} in {unit}"] = q / factor
        out[f"last move of {axis}"] = touches.last_move(axis)
    n = normal_in_tool(touches)
    out["azimuth of the normal about the tool axis in °"] = np.arctan2(n[:, 1], n[:, 0]) / DEG
    out["angle between normal and tool axis in °"] = np.arccos(np.clip(n[:, 2], -1.0, 1.0)) / DEG
    out |= {f"temperature of {sensor} in °C": v for sensor, v in touches.temperature.items()}
    if "spindle_rpm" in known:
        out["spindle speed in 1/min"] = known["spindle_rpm"]
    out |= time
    return {k: v for k, v in out.items() if np.ptp(v) > 0.0}


def _time(touches: Touches) -> dict[str, Array]:
    """Time in minutes, or in hours where the run is long."""
    time = touches.since_start
    hours = np.ptp(time) > 600.0 * MINUTE
    return {f"time in {'h' if hours else 'min'}": time / (3600.0 if hours else MINUTE)}


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
