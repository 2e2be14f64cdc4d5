"""Pictures of laws: the law with the data, and the residual before and after."""

from typing import Any

import numpy as np

from matstd.diagnosis.laws import Learning
from matstd.report.laws.curves import LawCurve, axis_label, law_curve
from matstd.report.style import (
    BLUE,
    FAINT,
    INK,
    NEUTRAL,
    ORANGE,
    Figure,
    figure,
    plain,
    robust_limit,
)
from matstd.twin.frames import Mask
from matstd.twin.laws import Law
from matstd.twin.units import UM


def draw_law(learning: Learning, law: Law) -> Figure:
    """The law over each of its variables, with ± 2 u, and the touches with the law put back.

    A touch feels the carrier by a lever: its residual with the law put back is divided by it.
    """
    drawn = figure(3.4)
    every = np.atleast_1d(drawn.subplots(1, len(law.drivers)))
    for ax, driver in zip(every, law.drivers, strict=True):
        _panel(ax, law_curve(learning, law, driver), learning.after.used)
    unit = "µrad" if law.carrier.is_angular else "µm"
    every[0].set_ylabel(f"{law.carrier.name} in {unit}")
    every[0].legend(fontsize=8, frameon=False)
    return drawn


def _panel(ax: Any, curve: LawCurve, used: Mask) -> None:
    """A law over one of its variables."""
    seen = used & np.isfinite(curve.put_back)
    points = curve.put_back[seen]
    ax.plot(curve.touch_x[seen], points, ".", ms=2.5, color=FAINT, label="touches")
    low, high = curve.value - 2.0 * curve.u, curve.value + 2.0 * curve.u
    ax.fill_between(curve.x, low, high, color=BLUE, alpha=0.2, lw=0, label="± 2 u")
    ax.plot(curve.x, curve.value, color=BLUE, lw=1.6, label="law")
    limit = 1.4 * max(robust_limit(points), float(np.abs(curve.value).max()))
    ax.set_ylim(-limit, limit)
    ax.axhline(0.0, color=NEUTRAL, lw=0.7)
    ax.set_xlabel(curve.label)
    plain(ax)


def draw_before_after(learning: Learning) -> Figure:
    """Residual over every variable of the laws, without and with them, on one scale."""
    drivers = list(dict.fromkeys(d for one in learning.laws for d in one.law.drivers))[:3]
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
