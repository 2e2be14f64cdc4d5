"""A law over one of its variables, with the touches, as pictures and live pages draw it."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.laws import Learning, curve_of, partial_residual
from matstd.report.laws.law_words import variable_words
from matstd.report.numbers import time_unit
from matstd.twin.frames import Array
from matstd.twin.laws import Driver, Law
from matstd.twin.model import columns
from matstd.twin.units import DEG, UM, URAD

CURVE_POINTS = 400  # points of a curve that are drawn

DRAWN_BEYOND = 0.3
"""Share of the range by which a curve without a formula is drawn beyond it: there its uncertainty
comes back."""

MIN_LEVER = 0.2  # share of the largest lever below which a touch shows noise rather than the law


@dataclass(frozen=True, eq=False)
class LawCurve:
    """A law over one of its variables, and what every touch shows of it.

    A touch feels the carrier by a lever: its residual with the law put back, over the lever, is
    what it says of the curve. Of a law over two variables the lever holds what the shape of the
    other one is at the touch.
    """

    title: str  # `EBY`
    unit: str  # of the carrier
    scale: float  # one of it in base units
    label: str  # of the variable, with its unit
    x: Array  # of the curve, as it is shown, (M,)
    value: Array  # of the curve, in `unit`, (M,)
    u: Array  # its standard uncertainty, (M,)
    touch_x: Array  # of every touch, as it is shown, (N,)
    touch_value: Array  # of the curve at every touch, in `unit`, (N,)
    lever: Array  # of every touch, mm over the base unit; nan where it is too small, (N,)
    put_back: Array  # residual with the law put back over the lever, in `unit`, (N,)


def law_curve(learning: Learning, law: Law, driver: Driver) -> LawCurve:
    """The curve of a law over one of its variables."""
    fit = learning.after
    x = driver.values(fit.run.touches)
    used = x[fit.used]
    label, per = axis_label(driver, used)
    is_curve = any(f.shape.word == "curve" and f.driver == driver for f in law.factors)
    beyond = DRAWN_BEYOND * float(np.ptp(used)) if is_curve else 0.0
    grid = np.linspace(float(used.min()) - beyond, float(used.max()) + beyond, CURVE_POINTS)
    if driver.nature == "sign":
        grid = np.array([-1.0, 1.0])
    value, u = curve_of(learning, law, driver, grid)
    at_touches, _ = curve_of(learning, law, driver, x)
    lever = _levers(learning, law, at_touches)
    both, _ = partial_residual(learning, law)
    scale = URAD if law.carrier.is_angular else UM
    return LawCurve(
        title=law.carrier.name,
        unit="µrad" if law.carrier.is_angular else "µm",
        scale=scale,
        label=label,
        x=grid / per,
        value=value / scale,
        u=u / scale,
        touch_x=x / per,
        touch_value=at_touches / scale,
        lever=lever,
        put_back=both / lever / scale,
    )


def _levers(learning: Learning, law: Law, value: Array) -> Array:
    """What every touch shows of the law's value on the curve that is drawn, nan for too little."""
    fit = learning.after
    theta = fit.theta[fit.of_effect(law.name)]
    felt = columns([law], fit.run.touches) @ theta
    size = float(np.abs(value).max()) or 1.0
    way = int(np.argmax(np.abs(theta.reshape(law.carrier.count, -1)).sum(axis=1)))
    lever = law.carrier.columns(fit.run.touches)[:, way]
    if len(law.drivers) > 1 or law.carrier.count > 1:
        # what the touch shows of the drawn value holds the other variable and the other ways, too
        lever = np.divide(felt, value, out=np.zeros_like(felt), where=np.abs(value) > 0.05 * size)
    seen = np.abs(lever) > MIN_LEVER * float(np.abs(lever).max(initial=1e-300))
    return np.where(seen, lever, np.nan)


def axis_label(driver: Driver, x: Array) -> tuple[str, float]:
    """Label of a variable, and one of its unit in the base unit."""
    words = variable_words(driver)
    if driver.unit == "s":
        per, unit = time_unit(float(np.abs(x).max(initial=1.0)))
        return f"{words} in {unit}", per
    if driver.unit == "rad":
        return f"{words} in °", DEG
    unit = driver.unit.replace("degC", "°C")
    return (f"{words} in {unit}" if unit else words), 1.0
