"""Maps of sensitivities and of the volumetric error, for reports (PNG)."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from matstd.report.maps.regions_picture import draw_regions
from matstd.report.maps.sensitivity_pictures import maps_of_S, overview
from matstd.report.style import (
    INK,
    LINE,
    Figure,
    axis_title,
    figure,
    nothing,
    plain,
    reading_label,
    save,
    series,
)
from matstd.report.words import sampling_words, unsampled
from matstd.sensitivity.first_order import covariance, normal_length, sensitivity
from matstd.sensitivity.shares import region_totals, regions
from matstd.sensitivity.study import PointOverRotary, Study, points_over_rotary
from matstd.twin.frames import Array
from matstd.twin.machine import Symbol
from matstd.twin.units import DEG, UM, URAD

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
    axes: Any, study: Study, point: PointOverRotary, values: Array, span: tuple[float, float] | None
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


def shows_more(S: Array, shown: Iterable[Array]) -> bool:
    """Whether a map of S has more than one colour, and differs from those that are shown.

    Args:
        S: At the places of the map; not a number where the machine does not reach.
        shown: S of other errors at the same places.
    """
    seen = np.isfinite(S)
    if np.ptp(S[seen]) <= _STILL * max(float(S[seen].max()), 1e-300):
        return False
    return all(np.corrcoef(S[seen], other[seen])[0, 1] < _ALIKE for other in shown)


def _moving(study: Study, point: PointOverRotary) -> list[Symbol]:
    """Errors of largest share whose S changes as the table turns, no two with the same map."""
    q = point.q[point.reached]
    if not len(q):
        return []
    S = sensitivity(study.chain, q, study.workspace.length)
    chosen: list[int] = []
    for i in np.argsort(-study.shares.mean(axis=0), kind="stable"):
        if shows_more(S[:, i], S.T[chosen]):
            chosen.append(int(i))
        if len(chosen) == _SHOWN:
            break
    return [study.chain.symbols[i] for i in chosen]


_BARS = 24
_BINS = 12


def draw_maps(
    study: Study, folder: Path, rng: np.random.Generator | None = None
) -> list[tuple[str, str]]:
    """Draw every map of a study into a folder; file name and caption of each."""
    sampled = f"Monte Carlo: {sampling_words(study.volumetric)}; {len(study.q)} poses."
    maps = [
        (
            "sensitivity.png",
            overview(study),
            "Sensitivity S of the tool point to every error parameter, minimum to maximum over "
            "the workspace. S of a translation is one everywhere, that of an angle its lever arm. "
            "Exact to first order.",
        ),
        (
            "sensitivity_maps.png",
            maps_of_S(study),
            "Sensitivities that depend on the pose, each over the one or two readings with the "
            "largest influence; other readings in the middle of the workspace.",
        ),
        (
            "volumetric_sections.png",
            _volumetric_sections(study),
            "Volumetric error over pairs of readings, all other readings as in the worst pose "
            f"({_pose_words(study)}). Above: 95 % quantile over machines. Below: share of the "
            "machines for which a pose is among the worst 5 % of the workspace (5 % by chance). "
            f"{sampled}",
        ),
        (
            "volumetric_rotary.png",
            draw_rotary(study),
            "Four points of the workpiece while the table turns and the linear axes follow; a "
            "point is named by the linear readings that reach it with the table level. Above: "
            "volumetric error, 95 % quantile. Below: S of dominant errors, at the last of the "
            f"points. Grey: beyond the travel. {unsampled(study)}",
        ),
        (
            "volumetric_axes.png",
            _volumetric_axes(study),
            "Volumetric error against each reading: median over the poses of the mean and of the "
            f"95 % quantile, with the range that holds 80 % of the poses. {sampled}",
        ),
        ("variance_regions.png", *_regions(study, rng)),
        (
            "variance_shares.png",
            _shares(study),
            "The same over the whole workspace, with more parameters.",
        ),
    ]
    for name, drawn, _ in maps:
        save(drawn, folder / name)
    return [(name, caption) for name, _, caption in maps]


def _regions(study: Study, rng: np.random.Generator | None) -> tuple[Figure, str]:
    """Tornado of every region, with its caption."""
    found = regions(study.population, study.workspace)
    words = (
        "Share of the error parameters in the variance of the deviation, region by region: of the "
        "variance summed over the region, and the range that holds 90 % of its poses. Exact to "
        "first order."
    )
    if rng is None or study.population.dependence is not None:
        return draw_regions(study.chain, found), words
    totals = region_totals(study.population, study.workspace, found, rng)
    return draw_regions(study.chain, found, totals), (
        f"{words} Diamonds: total effect on the length |d|, interactions included, with twice its "
        f"standard error (Monte Carlo: {totals.machines} pairs of random machines, seed "
        f"{totals.seed}, at {totals.poses} poses of every region). Their sum exceeds 100 %, "
        "because the errors interact in a length."
    )


def _pose_words(study: Study) -> str:
    """Readings of the pose through which the sections run."""
    words = []
    for axis in study.chain.programmed_axes:
        unit, shown = (1.0, " mm") if study.chain.link(axis).kind == "linear" else (DEG, "°")
        value = study.worst_pose[study.chain.axis_index(axis)] / unit
        words.append(f"{axis} {value:.0f}{shown}")
    return ", ".join(words)


def _volumetric_sections(study: Study) -> Figure:
    """P95 of |d| and recurrence over pairs of readings."""
    sections = study.sections
    if not sections:
        return nothing("Fewer than two readings can move.")
    drawn = figure(4.6)
    grid = drawn.subplots(2, len(sections), squeeze=False)
    kinds: list[tuple[list[Array], float, str, str]] = [
        ([s.volumetric.p95 for s in sections], UM, "viridis", "95 % quantile in µm"),
        ([s.volumetric.recurrence for s in sections], 0.01, "magma", "among the worst 5 %, in %"),
    ]
    for row, (values, unit, colours, label) in enumerate(kinds):
        low = min(float(v.min()) for v in values) / unit
        high = max(float(v.max()) for v in values) / unit
        for column, (s, v) in enumerate(zip(sections, values, strict=True)):
            axes = grid[row, column]
            n = len(s.first)
            (label_a, unit_a), (label_b, unit_b) = (reading_label(study.chain, a) for a in s.axes)
            x, y, z = s.first / unit_a, s.second / unit_b, v.reshape(n, n).T / unit
            mesh = axes.pcolormesh(x, y, z, cmap=colours, vmin=low, vmax=high, shading="gouraud")
            axes.set(xlabel=label_a, ylabel=label_b)
        drawn.colorbar(mesh, ax=grid[row], pad=0.01, label=label)
    return drawn


def _volumetric_axes(study: Study) -> Figure:
    """|d| against every reading."""
    free = study.workspace.open_axes
    if not free:
        return nothing("No reading can move.")
    drawn = figure(3.0)
    grid = drawn.subplots(1, len(free), sharey=True, squeeze=False)[0]
    v = study.volumetric
    curves = [(v.p95 / UM, series(1), "95 % quantile"), (v.mean / UM, series(0), "mean")]
    for axes, name in zip(grid, free, strict=True):
        label, unit = reading_label(study.chain, name)
        reading = study.q[:, study.chain.axis_index(name)] / unit
        lots = np.array_split(np.argsort(reading), _BINS)
        middle = [reading[lot].mean() for lot in lots]
        for value, colour, what in curves:
            low, median, high = np.array(
                [np.quantile(value[lot], (0.1, 0.5, 0.9)) for lot in lots]
            ).T
            axes.fill_between(middle, low, high, color=colour, alpha=0.18, lw=0)
            axes.plot(middle, median, color=colour, lw=1.8, label=what)
        axes.set_xlabel(label)
        plain(axes)
    grid[0].set_ylabel("volumetric error in µm")
    grid[0].set_ylim(bottom=0.0)
    grid[-1].legend(frameon=False, fontsize=8, loc="lower right")
    return drawn


def _shares(study: Study) -> Figure:
    """Bars of the largest shares of variance, coloured by link."""
    from matplotlib.patches import Patch

    chain = study.chain
    mean = study.shares.mean(axis=0)
    order = np.argsort(-mean, kind="stable")[:_BARS]
    order = order[mean[order] > 0.0]
    low, high = np.quantile(study.shares[:, order], (0.05, 0.95), axis=0)
    colour = {link.name: series(i) for i, link in enumerate(chain.links)}
    drawn = figure(0.2 * len(order) + 1.0)
    axes = drawn.subplots()
    y = np.arange(len(order))
    links = [chain.symbols[i].link for i in order]
    axes.barh(y, 100.0 * mean[order], color=[colour[k] for k in links], height=0.72)
    axes.hlines(y, 100.0 * low, 100.0 * high, color=INK, lw=1.0)
    axes.plot(100.0 * low, y, "|", 100.0 * high, y, "|", color=INK, ms=5)
    axes.set_yticks(y, [chain.symbols[i].name for i in order], fontsize=8)
    axes.set_ylim(len(order) - 0.4, -0.6)
    axes.set_xlim(left=0.0)
    axes.set_xlabel(
        "share of the variance of the deviation in %   "
        f"(the {len(order)} shown: together {100.0 * mean[order].sum():.0f} %)"
    )
    plain(axes, "x")
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    present = [link for link in chain.links if link.name in links]
    axes.legend(
        handles=[Patch(color=colour[link.name], label=axis_title(link)) for link in present],
        frameon=False,
        fontsize=8,
        loc="lower right",
    )
    return drawn
