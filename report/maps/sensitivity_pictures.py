"""Pictures of S, the sensitivity of the tool point to every error parameter."""

from typing import Any

import numpy as np

from matstd.report.style import (
    INK,
    NEUTRAL,
    Figure,
    axis_title,
    figure,
    nothing,
    plain,
    reading_label,
    series,
)
from matstd.sensitivity.first_order import Workspace, section, sensitivity
from matstd.sensitivity.study import Study
from matstd.twin.frames import Array
from matstd.twin.machine import LETTERS, Family, Symbol
from matstd.twin.units import UM, URAD

_COLUMNS = 4  # maps in a row: their numbers stay readable in print
_PLANE = 31  # values of each reading of a map of S
_CURVE = 121  # values of the reading of a curve of S
_UNIFORM_SPREAD = 1e-3  # relative spread of S below which a parameter is the same everywhere
_BASES, _STEPS = 16, 7  # poses and values along each reading that show what S depends on


def _unit(symbol: Symbol) -> float:
    """What one shown unit of S (µm/µm, µm/µrad) is in base units."""
    return UM / URAD if symbol.is_angular else 1.0


def overview(study: Study) -> Figure:
    """Table of S: rows are links, columns the six components, for functions and for constants."""
    chain = study.chain
    drawn = figure(0.42 * len(chain.links) + 1.6)
    component, constant = drawn.subplots(1, 2, sharey=True)
    rows = {link.name: i for i, link in enumerate(chain.links)}
    each = [(component, True, "component errors"), (constant, False, "location and set-up errors")]
    largest = max(
        float(study.sensitivity[:, i].max()) / _unit(s)
        for i, s in enumerate(chain.symbols)
        if s.is_angular
    )
    for axes, wanted, title in each:
        for i, symbol in enumerate(chain.symbols):
            if (symbol.family is Family.COMPONENT) == wanted:
                S = study.sensitivity[:, i] / _unit(symbol)
                _cell(axes, rows[symbol.link], symbol, S, largest)
        axes.set(xlim=(-0.5, 5.5), ylim=(len(rows) - 0.5, -0.5), title=title)
        axes.set_xticks(range(6), [f"E{a}" for a in LETTERS])
        axes.set_yticks(range(len(rows)), [axis_title(link) for link in chain.links])
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
        axes.text(1.0, len(rows) - 0.42, "µm/µm", ha="center", va="top", fontsize=8, color=INK)
        axes.text(4.0, len(rows) - 0.42, "µm/µrad", ha="center", va="top", fontsize=8, color=INK)
        axes.xaxis.tick_top()
    return drawn


def _cell(axes: Any, row: int, symbol: Symbol, S: Array, largest: float) -> None:
    """One parameter: its range as text on a shade of its mean."""
    from matplotlib import colormaps
    from matplotlib.patches import Rectangle

    low, high = float(S.min()), float(S.max())
    shade = float(S.mean()) / (largest if symbol.is_angular else 2.0)
    colour = colormaps["YlGnBu" if symbol.is_angular else "Greys"](0.75 * min(shade, 1.0))
    corner = (symbol.component - 0.48, row - 0.46)
    axes.add_patch(Rectangle(corner, 0.96, 0.92, facecolor=colour, edgecolor=NEUTRAL, lw=0.6))
    same = high - low < 0.005
    text = f"{round(high, 3) + 0.0:.3g}" if same else f"{low:.2f} – {high:.2f}"
    dark = 0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2] < 0.55
    ink = "white" if dark else INK
    axes.text(symbol.component, row, text, ha="center", va="center", fontsize=7.5, color=ink)


def _influence(study: Study) -> Array:
    """How much S of every parameter varies with each open reading alone, (P, open axes).

    Mean over some poses of the variance along the reading; exactly zero where there is none.
    """
    workspace, chain = study.workspace, study.chain
    bases = study.q[:_BASES]
    out = []
    for axis in workspace.open_axes:
        q = np.repeat(bases, _STEPS, axis=0)
        q[:, chain.axis_index(axis)] = np.tile(
            np.linspace(*workspace.limit(axis), _STEPS), len(bases)
        )
        S = sensitivity(chain, q, workspace.length).reshape(len(bases), _STEPS, -1)
        out.append(S.var(axis=1).mean(axis=0))
    return np.stack(out, axis=1) if out else np.zeros((len(chain.symbols), 0))


def maps_of_S(study: Study) -> Figure:
    """One small map for every parameter whose S depends on the pose."""
    chain, influence = study.chain, _influence(study)
    # variances against the mean square of S: rounding is 1e-30, anything real far above
    matters = (
        influence > _UNIFORM_SPREAD**2 * np.mean(study.sensitivity**2, axis=0)[:, None] + 1e-20
    )
    moving = np.flatnonzero(matters.any(axis=1))
    if not len(moving):
        return nothing("No sensitivity depends on the pose.")
    columns = min(_COLUMNS, len(moving))
    rows = -(-len(moving) // columns)
    drawn = figure(2.1 * rows, layout=None)  # constrained: seconds for 36 maps
    gap = {"left": 0.5, "right": 0.35, "bottom": 0.4, "top": 0.3}  # inch
    width, height = drawn.get_size_inches()
    drawn.subplots_adjust(
        left=gap["left"] / width,
        right=1.0 - gap["right"] / width,
        bottom=gap["bottom"] / height,
        top=1.0 - gap["top"] / height,
        wspace=0.62,
        hspace=0.52,
    )
    grid = drawn.subplots(rows, columns, squeeze=False).ravel()
    free = study.workspace.open_axes
    for axes, i in zip(grid, moving, strict=False):
        most = np.argsort(-influence[i], kind="stable")[: min(2, int(matters[i].sum()))]
        readings = [free[k] for k in sorted(most)]
        _map_of_S(axes, study.workspace, chain.symbols[i], readings)
    for axes in grid[len(moving) :]:
        axes.set_axis_off()
    return drawn


def _map_of_S(axes: Any, workspace: Workspace, symbol: Symbol, readings: list[str]) -> None:
    """S over one reading as a curve, over two as colours."""
    chain, length = workspace.chain, workspace.length
    unit = "µm/µrad" if symbol.is_angular else "µm/µm"
    axes.set_title(f"{symbol.name}  {unit}", fontsize=8.5)
    axes.tick_params(labelsize=7, length=2)
    label_a, unit_a = reading_label(chain, readings[0])
    axes.set_xlabel(label_a, fontsize=8, labelpad=1)
    if len(readings) == 1:
        q = np.tile(workspace.centre, (_CURVE, 1))
        a = np.linspace(*workspace.limit(readings[0]), _CURVE)
        q[:, chain.axis_index(readings[0])] = a
        S = sensitivity(chain, q, length, [symbol])[:, 0]
        axes.plot(a / unit_a, S / _unit(symbol), color=series(0), lw=1.6)
        axes.set_ylim(bottom=0.0)
        plain(axes)
        return
    a, b, q = section(workspace, readings[0], readings[1], _PLANE)
    S = sensitivity(chain, q, length, [symbol])[:, 0].reshape(_PLANE, _PLANE)
    label_b, unit_b = reading_label(chain, readings[1])
    mesh = axes.pcolormesh(
        a / unit_a, b / unit_b, S.T / _unit(symbol), cmap="viridis", shading="gouraud"
    )
    axes.set_ylabel(label_b, fontsize=8, labelpad=0)
    bar = axes.figure.colorbar(mesh, ax=axes, pad=0.03, fraction=0.06)
    bar.ax.tick_params(labelsize=7, length=2)
