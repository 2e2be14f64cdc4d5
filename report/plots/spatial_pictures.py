"""Pictures of a residual in space: on the standard, and table pose by table pose."""

from typing import Any

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import pose_vectors
from matstd.report.style import (
    BLUE,
    DIVERGING,
    GREEN,
    INK,
    LINE,
    ORANGE,
    SOFT,
    WASH,
    Figure,
    figure,
    plain,
    robust_limit,
)
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches
from matstd.twin.units import DEG, UM

EXTENT = 1.0  # touched points closer together than this (mm) are a place, not a standard
UNSURE = 3.0  # times the usual uncertainty of a pose's vector from which no arrow is drawn of it
MOST_NAMED = 24  # features whose names are written on the standard


def is_spread(touches: Touches) -> bool:
    """Whether the touched points cover something that can be drawn."""
    return bool(np.sort(np.ptp(touches.point, axis=0))[1] > EXTENT)


def draw_on_standard(fits: tuple[tuple[str, Fit], ...]) -> Figure:
    """Touched points of the standard in space, coloured by residual on one common scale.

    Args:
        fits: One model, seen in space and from above; or two models of the same run with a title
            each, such as before and after. What lies in a plane is seen from above alone.
    """
    drawn = figure(4.2, layout=None)  # a constrained layout cuts axes in space
    limit = robust_limit(np.concatenate([f.residual[f.used] / UM for _, f in fits]))
    lies = bool(np.ptp(fits[0][1].run.touches.point[:, 2]) < EXTENT)  # a bed or plate is all seen
    for (title, fit), left in zip(fits, (0.0, 0.435), strict=False):
        if lies:
            width = 0.36 if len(fits) > 1 else 0.76
            marks = _from_above(drawn, (left + 0.07, 0.13, width, 0.78), fit, limit, title)
            continue
        ax = drawn.add_axes((left, 0.03, 0.43, 0.9), projection="3d")
        marks = _points(ax, fit, limit, fit.run.touches.point)
        _standing(ax, fit.run.touches)
        ax.set_title(title, fontsize=10, color=INK, y=0.86)
    if len(fits) == 1 and not lies:
        _from_above(drawn, (0.54, 0.13, 0.33, 0.78), fits[0][1], limit, "from above")
    bar = drawn.colorbar(marks, cax=drawn.add_axes((0.905, 0.14, 0.014, 0.72)), extend="both")
    bar.set_label("residual in µm (positive: outside)", fontsize=9)
    bar.ax.tick_params(labelsize=8.5)
    if any(f.gross.rows.any() for _, f in fits):
        handles = drawn.axes[0].get_legend_handles_labels()
        drawn.legend(*handles, loc="lower left", fontsize=8.5, frameon=False)
    return drawn


def _from_above(
    drawn: Any, place: tuple[float, float, float, float], fit: Fit, limit: float, title: str
) -> Any:
    """Touches in x and y of the standard."""
    flat = drawn.add_axes(place)
    marks = _points(flat, fit, limit, fit.run.touches.point[:, :2])
    flat.set(xlabel="x in mm", ylabel="y in mm", aspect="equal")
    flat.set_title(title, fontsize=10, color=INK)
    plain(flat)
    _name_features(flat, fit.run.touches)
    return marks


def _name_features(ax: Any, touches: Touches) -> None:
    """Name of every feature at its middle, seen from above; features too many to read have none."""
    names = np.unique(touches.feature)
    if not 1 < len(names) <= MOST_NAMED:
        return
    for name in names:
        at = touches.point[touches.feature == name, :2].mean(axis=0)
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.75}
        ax.text(*at, str(name), fontsize=7.5, color=INK, ha="center", va="center", bbox=box)


def _points(ax: Any, fit: Fit, limit: float, p: Array) -> Any:
    """Touches of one fit, the largest residuals in front; gross errors as empty diamonds."""
    r = fit.residual / UM
    in_space = {"depthshade": False} if p.shape[1] == 3 else {}
    rows = np.flatnonzero(~fit.gross.rows)
    rows = rows[np.argsort(np.abs(r[rows]), kind="stable")]
    marks = ax.scatter(
        *p[rows].T,
        c=r[rows],
        s=15.0,
        cmap=DIVERGING,
        vmin=-limit,
        vmax=limit,
        edgecolors="#00000040",
        linewidths=0.35,
        **in_space,
    )
    if fit.gross.rows.any():
        ax.scatter(
            *p[fit.gross.rows].T,
            s=46.0,
            marker="D",
            facecolors="none",
            edgecolors=INK,
            linewidths=1.1,
            label="gross error, left out",
            **in_space,
        )
    return marks


def _standing(ax: Any, touches: Touches) -> None:
    """Equal scales, a view, and unobtrusive axes."""
    from matplotlib.ticker import MaxNLocator

    low, high = touches.point.min(axis=0), touches.point.max(axis=0)
    size = np.maximum(high - low, 0.12 * float((high - low).max()))
    middle = 0.5 * (low + high)
    for set_limit, m, s in zip((ax.set_xlim, ax.set_ylim, ax.set_zlim), middle, size, strict=True):
        set_limit(m - 0.5 * s, m + 0.5 * s)
    ax.patch.set_visible(False)  # else it covers the label of the axes to its left
    ax.set_box_aspect(size, zoom=1.0)
    ax.view_init(26.0, -58.0)
    for letter, axis in zip("xyz", (ax.xaxis, ax.yaxis, ax.zaxis), strict=True):
        axis.set_label_text(f"{letter} in mm", fontsize=8)
        axis.labelpad = 0.0 if letter != "z" else -3.0  # else it runs into the axes to the right
        axis.set_major_locator(MaxNLocator(5))
        axis.pane.set_facecolor(WASH)
        axis.pane.set_edgecolor(LINE)
        axis._axinfo["grid"].update(color=LINE, linewidth=0.6)
    ax.tick_params(labelsize=7.5, pad=0)


def draw_pose_arrows(fit: Fit) -> Figure:
    """Mean residual vector of every table pose: an arrow at its rotary readings, and in order."""
    rows, vectors, spread = pose_vectors(fit)
    drawn = figure(4.4)
    left, right = drawn.subplots(1, 2, width_ratios=(1.0, 1.15))
    _arrows(drawn, left, fit, rows, vectors / UM, _is_sure(spread))
    number = np.arange(1, len(rows) + 1)
    for k, (letter, colour) in enumerate(zip("XYZ", (BLUE, ORANGE, GREEN), strict=True)):
        right.errorbar(
            number + 0.16 * (k - 1),
            vectors[:, k] / UM,
            spread[:, k] / UM,
            fmt="o",
            ms=3.5,
            lw=1.1,
            color=colour,
            label=letter,
        )
    right.axhline(0.0, color=SOFT, lw=0.8)
    right.set_xlabel("table pose, in the order of probing")
    right.set_ylabel("mean residual in machine directions, µm")
    right.legend(fontsize=8, frameon=False, ncols=3)
    plain(right)
    return drawn


def _where(touches: Touches, rows: IntArray) -> tuple[Array, Array, str, str]:
    """Two coordinates in which the poses of a machine lie apart, with their names."""
    known = [
        (f"{axis} in °", touches.reading(axis)[rows] / DEG)
        for axis in touches.chain.programmed_axes
        if touches.chain.link(axis).kind == "rotary"
    ]
    known += [
        (f"{c} of the table in mm", touches.point_table[rows, i]) for i, c in enumerate("xyz")
    ]
    moved = [k for k in known if np.ptp(k[1]) > 1e-6][:2]
    if not moved:
        number = np.arange(1.0, len(rows) + 1.0)
        moved = [("single place", np.zeros(len(rows))), ("table pose, in order", number)]
    (y_name, y), (x_name, x) = (moved[0], moved[-1])
    return x, y, x_name, y_name


def _is_sure(spread: Array) -> Mask:
    """Poses whose vectors are not much less certain than those of the others, (M,)."""
    largest = spread.max(axis=1)
    return np.asarray(largest <= UNSURE * np.median(largest))


def _arrows(drawn: Any, ax: Any, fit: Fit, rows: IntArray, vectors: Array, sure: Mask) -> None:
    """Arrows in X and Y at the rotary readings, coloured by Z; their longest marks the scale."""
    x, y, x_name, y_name = _where(fit.run.touches, rows)
    # uncertain poses get a circle: their arrows would set the scale of all others
    limit = robust_limit(vectors[sure, 2], 1.0)
    length = float(np.linalg.norm(vectors[sure, :2], axis=1).max()) or 1.0
    marks = ax.quiver(
        x[sure],
        y[sure],
        *vectors[sure, :2].T,
        vectors[sure, 2],
        cmap=DIVERGING,
        clim=(-limit, limit),
        angles="uv",
        scale=7.0 * length,
        width=0.007,
        edgecolor=INK,
        linewidth=0.3,
    )
    ax.plot(x[sure], y[sure], ".", ms=3, color=SOFT)
    title = f"longest arrow: {length:.2g} µm"
    if not sure.all():
        ax.plot(x[~sure], y[~sure], "o", ms=4.5, mfc="none", color=SOFT)
        title += "; circle: too few touches"
    ax.set_title(title, fontsize=9, loc="left", color=INK)
    ax.set(xlabel=x_name, ylabel=y_name)
    ax.margins(0.22)
    plain(ax)
    bar = drawn.colorbar(marks, ax=ax, shrink=0.85)
    bar.set_label("along Z, µm (arrow: along X and Y)", fontsize=8.5)
