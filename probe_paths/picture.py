"""Pictures of a plan: where the standard is touched, and how the table turns meanwhile."""

from pathlib import Path
from typing import Any

import numpy as np

from artefact.datum import DatumSphere
from artefact.freeform import FreeformPatch
from probe_paths.plan import TouchPlan
from twin.files.whole import written_whole
from twin.units import DEG

_DPI = 140


def write_touches_picture(path: str | Path, plan: TouchPlan) -> None:
    """Touched points on the standard seen from above and from the side, coloured by feature kind.

    Args:
        path: PNG.
        plan: What is touched.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 4.6), layout="constrained")
    top, side = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    for ax, (i, j) in ((top, (0, 1)), (side, (0, 2))):
        _outlines(ax, plan, i, j)
        for is_sphere, colour, label in ((False, "#14558f", "patch"), (True, "#c2571a", "sphere")):
            rows = np.array(
                [isinstance(plan.standard.features[f], DatumSphere) for f in plan.feature]
            )
            rows = rows == is_sphere
            p, n = plan.point[rows], plan.normal[rows]
            ax.quiver(
                p[:, i],
                p[:, j],
                n[:, i],
                n[:, j],
                color=colour,
                angles="xy",
                scale_units="xy",
                scale=0.14,
                width=0.0022,
                headwidth=3.5,
                label=f"{label}: {rows.sum()} touches",
            )
        ax.set_aspect("equal")
        ax.set_xlabel("x in mm")
        ax.set_ylabel(f"{'xyz'[j]} in mm")
    top.set_title("from above", loc="left")
    side.set_title("from the side", loc="left")
    side.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, frameon=False)
    _save(figure, path)


def _outlines(ax: Any, plan: TouchPlan, i: int, j: int) -> None:
    """Edges of patches and circles of spheres in two coordinates of the artefact frame."""
    for name, surface in plan.standard.features.items():
        if isinstance(surface, FreeformPatch):
            a, b = surface.half_size
            s = np.linspace(-1.0, 1.0, 25)
            one = np.ones_like(s)
            ring = np.concatenate(
                [np.stack(c, -1) for c in ((s, -one), (one, s), (-s, one), (-one, -s))]
            )
            edge = surface.point(ring * np.array([a, b]))
            centre = surface.point(np.zeros((1, 2)))[0]
        elif isinstance(surface, DatumSphere):
            t = np.linspace(0.0, 2.0 * np.pi, 60)
            circle = np.zeros((60, 3))
            circle[:, i], circle[:, j] = np.cos(t), np.sin(t)
            centre = surface.centre
            edge = centre + surface.radius * circle
        else:
            continue
        ax.plot(edge[:, i], edge[:, j], color="#7d8794", lw=0.8)
        ax.text(
            centre[i],
            centre[j],
            name,
            fontsize=7,
            color="#3d4652",
            ha="center",
            va="center",
            bbox={"facecolor": "white", "alpha": 0.65, "lw": 0, "pad": 0.6},
        )


def write_order_picture(path: str | Path, plan: TouchPlan) -> None:
    """Rotary readings over the sequence of touches, with the side of every approach.

    Args:
        path: PNG.
        plan: In the order of execution.
    """
    from matplotlib.figure import Figure

    axes = plan.chain.rotary_axes
    figure = Figure(figsize=(10.5, 1.0 + 1.5 * max(len(axes), 1)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(max(len(axes), 1), 1, sharex=True))
    begin = np.searchsorted(plan.visit, np.arange(len(plan.visits)))
    end = np.append(begin[1:], len(plan))
    for k, axis in enumerate(axes):
        ax = panels[k]
        reading = np.array([v.rotary[k] for v in plan.visits]) / DEG
        side = np.array([v.side[k] for v in plan.visits])
        ax.hlines(reading, begin, end, color="#14558f", lw=3)
        middle = 0.5 * (begin + end)
        for sign, marker in ((1, "^"), (-1, "v")):
            rows = side == sign
            ax.plot(
                middle[rows],
                reading[rows],
                marker,
                color="#c2571a",
                ms=5,
                label=f"reached {'upwards' if sign > 0 else 'downwards'}",
            )
        ax.set_ylabel(f"{axis} in degrees")
        ax.margins(y=0.15)
        ax.grid(alpha=0.25)
    panels[-1].set_xlabel("touch, in the order of execution")
    # a machine without rotary axes has one panel, and nothing in it
    if plan.chain.rotary_axes:
        panels[0].legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, frameon=False
        )
    _save(figure, path)


def _save(figure: Any, path: str | Path) -> None:
    with written_whole(path) as part:
        figure.savefig(part, dpi=_DPI, format="png")
