"""Pictures of laws: the law with the data, and the residual before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from matstd.diagnosis.laws import Learning, curve_of, partial_residual
from matstd.report.laws.law_words import variable_words
from matstd.report.numbers import time_unit
from matstd.report.style import BLUE, FAINT, INK, NEUTRAL, ORANGE, figure, plain, robust_limit
from matstd.twin.frames import Array
from matstd.twin.laws import Driver, Law
from matstd.twin.model import columns
from matstd.twin.units import DEG, UM, URAD

if TYPE_CHECKING:
    from matplotlib.figure import Figure

POINTS = 400
"""Points of a curve that are drawn."""

BEYOND = 0.3
"""Share of the range by which a curve is drawn beyond it: there its uncertainty comes back."""

MIN_LEVER = 0.2
"""Share of the largest lever below which a touch shows noise rather than the law."""


def draw_law(learning: Learning, law: Law) -> Figure:
    """The law over each of its variables, with ± 2 u, and the touches with the law put back.

    A touch feels the carrier by a lever: its residual with the law put back is divided by it. Of a
    product of two shapes touches are drawn by what the other shape is at them.
    """
    count = len(law.factors)
    drawn = figure(3.4)
    every = np.atleast_1d(drawn.subplots(1, count))
    for k, ax in enumerate(every):
        _panel(ax, learning, law, k)
    unit = "µrad" if law.carrier.is_angular else "µm"
    every[0].set_ylabel(f"{law.carrier.name} in {unit}")
    every[0].legend(fontsize=8, frameon=False)
    return drawn


def _panel(ax: Any, learning: Learning, law: Law, k: int) -> None:
    """One variable of a law."""
    driver, scale = law.factors[k].driver, URAD if law.carrier.is_angular else UM
    fit = learning.after
    x = driver.values(fit.run.touches)[fit.used]
    label, per = axis_label(driver, x)
    beyond = BEYOND * float(np.ptp(x)) if law.factors[k].shape.word == "curve" else 0.0
    grid = np.linspace(float(x.min()) - beyond, float(x.max()) + beyond, POINTS)
    if driver.nature == "sign":
        grid = np.array([-1.0, 1.0])
    value, u = curve_of(learning, law, k, grid)
    points, seen = _put_back(learning, law, k)
    ax.plot(x[seen] / per, points[seen] / scale, ".", ms=2.5, color=FAINT, label="touches")
    low, high = (value - 2.0 * u) / scale, (value + 2.0 * u) / scale
    ax.fill_between(grid / per, low, high, color=BLUE, alpha=0.2, lw=0, label="± 2 u")
    ax.plot(grid / per, value / scale, color=BLUE, lw=1.6, label="law")
    limit = 1.4 * max(robust_limit(points[seen] / scale), float(np.abs(value).max()) / scale)
    ax.set_ylim(-limit, limit)
    ax.axhline(0.0, color=NEUTRAL, lw=0.7)
    ax.set_xlabel(label)
    plain(ax)


def _put_back(learning: Learning, law: Law, k: int) -> tuple[Array, NDArray[np.bool_]]:
    """Residual with the law put back, per unit of its lever, and which touches see it; rows used.

    The lever is what the touch shows of the law's value on the curve that is drawn.
    """
    fit = learning.after
    both, _ = partial_residual(learning, law)
    x = law.factors[k].driver.values(fit.run.touches)
    value, _ = curve_of(learning, law, k, x)
    C = columns([law], fit.run.touches)
    theta = fit.theta[fit.of_effect(law.name)]
    felt = C @ theta
    size = float(np.abs(value).max()) or 1.0
    levers = law.carrier.columns(fit.run.touches)
    way = int(np.argmax(np.abs(theta.reshape(law.carrier.count, -1)).sum(axis=1)))
    lever = levers[:, way]
    if len(law.factors) > 1 or law.carrier.count > 1:
        # what the touch shows of the drawn value holds the other factor and the other ways, too
        lever = np.divide(felt, value, out=np.zeros_like(felt), where=np.abs(value) > 0.05 * size)
    seen = np.abs(lever) > MIN_LEVER * float(np.abs(lever).max(initial=1e-300))
    out = np.divide(both, lever, out=np.zeros_like(both), where=seen)
    return out[fit.used], seen[fit.used]


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


def draw_before_after(learning: Learning) -> Figure:
    """Residual over every variable of the laws, without and with them, on one scale."""
    drivers = list(dict.fromkeys(f.driver for one in learning.laws for f in one.law.factors))[:3]
    drawn = figure(4.2)
    axes = drawn.subplots(2, len(drivers), sharey=True, squeeze=False)
    limit = robust_limit(learning.before.residual[learning.before.used] / UM, 0.995)
    pairs = ((learning.before, "without the law", ORANGE), (learning.after, "with the law", BLUE))
    for row, (fit, words, colour) in zip(axes, pairs, strict=True):
        for ax, driver in zip(row, drivers, strict=True):
            x = driver.values(fit.run.touches)[fit.used]
            label, per = axis_label(driver, x)
            shown = np.clip(fit.residual[fit.used] / UM, -limit, limit)
            ax.plot(x / per, shown, ".", ms=2.2, color=colour)
            ax.axhline(0.0, color=INK, lw=0.6)
            ax.set_xlabel(label)
            plain(ax)
        row[0].set_ylabel(f"residual in µm,\n{words}")
    return drawn
