"""Picture of a region: the error that is off in it, over each variable that bounds it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import Region, Side, observed_error, variables
from matstd.report.plots.pattern_pictures import course
from matstd.report.style import FAINT, RED, axis_of, figure, plain, robust_limit
from matstd.twin.frames import Array
from matstd.twin.units import UM, URAD

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_region(fit: Fit, region: Region) -> Figure | None:
    """The error of a region over every variable that bounds it, within its other bounds.

    Returns:
        None for a region that labels bound, or in which touches scatter.
    """
    known = variables(fit.run.touches)
    bounds = {k: _bounds(region, k, v) for k, v in known.items()}
    names = [k for k in known if any(c.variable == k for c in region.conditions)]
    if region.wrong is None or not names:
        return None
    rows, values, weight = observed_error(fit, region)
    unit, word = (URAD, "µrad") if region.wrong.is_angular else (UM, "µm")
    size = region.wrong.size / unit
    limit = max(robust_limit(values / unit, 0.9), 2.0 * abs(size))
    drawn = figure(3.0)
    axes = drawn.subplots(1, len(names), sharey=True, squeeze=False)[0]
    for ax, name in zip(axes, names, strict=True):
        within = np.ones(len(rows), dtype=bool)
        for other in (k for k in names if k != name):
            low, high = bounds[other]
            within &= (known[other][rows] >= low) & (known[other][rows] <= high)
        label, x = axis_of(name, np.append(known[name][rows[within]], bounds[name]))
        ax.axvspan(*x[-2:], color=FAINT, alpha=0.35, lw=0.0)
        ax.plot(x[-2:], [size, size], "-", color=RED, lw=1.4)
        course(ax, x[:-2], values[within] / unit, weight[within], limit)
        ax.set_xlabel(label, fontsize=8.5)
        plain(ax)
    axes[0].set_ylabel(f"{region.wrong.carrier} in {word}")
    return drawn


def _bounds(region: Region, name: str, values: Array) -> tuple[float, float]:
    """Where a region begins and ends along a variable."""
    own = {c.side: float(c.bound) for c in region.conditions if c.variable == name}
    return own.get(Side.FROM, float(values.min())), own.get(Side.BELOW, float(values.max()))
