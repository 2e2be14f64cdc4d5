"""What the rotary axes do: volumetric error and S of single points of the workpiece, over B and C.

The linear axes follow, as they do under a program, so that the tool point stays at one point of the
workpiece; where their travel does not let them, nothing is drawn.
"""

from typing import Any

import numpy as np

from matstd.report.style import LINE, Figure, figure, nothing, reading_label
from matstd.sensitivity.first_order import covariance, normal_length, sensitivity
from matstd.sensitivity.study import PointOverRotary, Study, points_over_rotary
from matstd.twin.frames import Array
from matstd.twin.machine import Symbol
from matstd.twin.units import UM, URAD

_SHOWN = 4  # maps in a row
_STILL = 0.02  # relative range of S below which its map would be one colour
_ALIKE = 0.98  # correlation of two maps of S that show the same
_BEYOND = LINE


def draw_rotary(study: Study) -> Figure:
    """P95 of the volumetric error, and S of the errors that matter, over the rotary readings."""
    workspace = study.workspace
    points = points_over_rotary(workspace)
    if not any(p.reached.any() for p in points):
        return nothing("No rotary axis turns a point of the workpiece.")
    p95 = [
        p.shown(normal_length(covariance(study.population, p.q, workspace.length)).p95) / UM
        for p in points
    ]
    symbols = _moving(study, points[-1])
    drawn = figure(2.4 * (1 + bool(symbols)))
    grid = drawn.subplots(1 + bool(symbols), _SHOWN, squeeze=False)
    together = np.concatenate([v.ravel() for v in p95])  # one point may be beyond every travel
    span = (float(np.nanmin(together)), float(np.nanmax(together)))
    for axes, point, values in zip(grid[0], points, p95, strict=True):
        mesh = _map(axes, study, point, values, span)
        at = ", ".join(f"{name} {reading:.0f}" for name, reading in point.linear.items())
        axes.set_title(f"point at {at}", fontsize=9)
    if mesh is not None:
        bar = drawn.colorbar(mesh, ax=grid[0], pad=0.01)
        bar.set_label("95 % quantile in µm", fontsize=9)
        bar.ax.tick_params(labelsize=8)
    for axes, symbol in zip(grid[-1], symbols, strict=False):
        unit, words = (UM / URAD, "µm/µrad") if symbol.is_angular else (1.0, "µm/µm")
        S = sensitivity(workspace.chain, points[-1].q, workspace.length, [symbol])[:, 0]
        mesh = _map(axes, study, points[-1], points[-1].shown(S) / unit, None)
        axes.set_title(f"S of {symbol.name} in {words}", fontsize=9)
        if mesh is not None:
            drawn.colorbar(mesh, ax=axes, pad=0.02).ax.tick_params(labelsize=8)
    for axes in grid[1:].ravel()[len(symbols) :]:
        axes.set_axis_off()
    return drawn


def _map(
    axes: Any,
    study: Study,
    point: PointOverRotary,
    values: Array,
    span: tuple[float, float] | None,
) -> Any:
    """One map; a curve where one axis turns. Returns what a colour bar belongs to."""
    label_a, unit_a = reading_label(study.chain, point.axes[0])
    axes.set_xlabel(label_a, fontsize=9, labelpad=1)
    axes.tick_params(labelsize=8)
    if len(point.axes) == 1:
        axes.plot(point.readings[0] / unit_a, values)
        axes.set_ylim(bottom=0.0)
        return None
    label_b, unit_b = reading_label(study.chain, point.axes[1])
    axes.set_ylabel(label_b, fontsize=9, labelpad=1)
    axes.set_facecolor(_BEYOND)
    low, high = span or (None, None)
    return axes.pcolormesh(
        point.readings[0] / unit_a,
        point.readings[1] / unit_b,
        values.T,
        cmap="viridis",
        vmin=low,
        vmax=high,
        shading="nearest",
    )


def _moving(study: Study, point: PointOverRotary) -> list[Symbol]:
    """Errors of largest share whose S changes as the table turns, no two with the same map."""
    q = point.q[point.reached]
    if not len(q):
        return []
    S = sensitivity(study.chain, q, study.workspace.length)
    chosen: list[int] = []
    for i in np.argsort(-study.shares.mean(axis=0), kind="stable"):
        if np.ptp(S[:, i]) <= _STILL * max(float(S[:, i].max()), 1e-300):
            continue
        alike = (float(np.corrcoef(S[:, i], S[:, k])[0, 1]) for k in chosen)
        if max(alike, default=0.0) < _ALIKE:
            chosen.append(int(i))
        if len(chosen) == _SHOWN:
            break
    return [study.chain.symbols[i] for i in chosen]
