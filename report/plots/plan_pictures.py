"""Pictures of a plan: the set-up, where the standard is touched, how the table turns meanwhile."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Plate
from matstd.artefact.reach import Solid, table_face
from matstd.probe_paths.plan import TouchPlan
from matstd.report.style import BLUE, INK, RED, SOFT, Figure, figure, plain
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.units import DEG

LARGE_TABLE = 1.6
"""Width of a table over that of what stands on it, from which on it is not drawn to its edges."""

_PER_MM = 0.14  # of the length of an arrow, so that it is 7 mm long


def draw_setup(plan: TouchPlan) -> Figure:
    """Table, standard and clamps from above, and the probe from the side.

    Of a table much larger than what stands on it the middle is drawn large, and the whole small.
    """
    from matplotlib.patheffects import withStroke

    drawn = figure(4.6)
    halo = {"color": INK, "path_effects": [withStroke(linewidth=2.5, foreground="white")]}
    T_face_table = inverse(table_face(plan.setup.T_table_artefact))
    T_face_artefact = T_face_table @ plan.setup.T_table_artefact
    base = apply(T_face_artefact, _outline(plan.standard.base.body))
    table = plan.options.workshop.table
    low, high = _room_round(base, [k for k in plan.options.workshop.solids if k is not table])
    edge = apply(table.T_face_solid, _outline(table.plate))
    is_wide = np.ptp(edge[:, :2], axis=0).max() > LARGE_TABLE * (high - low).max()
    panels = [["top", "side"], ["top", "whole" if is_wide else "side"]]
    drawn_on: Any = drawn.subplot_mosaic(panels, width_ratios=(1.5, 1.0), height_ratios=(1.7, 1.0))
    top, side = drawn_on["top"], drawn_on["side"]
    if is_wide:
        _whole_table(drawn_on["whole"], edge, base)
        top.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for solid in plan.options.workshop.solids:
        outline = apply(solid.T_face_solid, _outline(solid.plate))
        is_table = solid is table
        top.plot(*outline[:, :2].T, color=SOFT if is_table else RED, lw=1.2)
        if not is_table:
            top.annotate(solid.name, (solid.x, solid.y), color=RED, fontsize=7, ha="center")
    top.plot(*base[:, :2].T, color=BLUE, lw=1.4)
    for patch in plan.standard.patches:
        a, b = patch.half_size
        corners = np.array([[-a, -b, 0.0], [a, -b, 0.0], [a, b, 0.0], [-a, b, 0.0], [-a, -b, 0.0]])
        face = apply(T_face_artefact @ patch.T_artefact_patch, corners)
        top.fill(*face[:, :2].T, facecolor=BLUE, alpha=0.15, edgecolor=BLUE, lw=0.8)
        middle = face[:4, :2].mean(axis=0)
        top.annotate(patch.name, middle, fontsize=7, ha="center", va="center", **halo)
    for sphere in plan.standard.spheres:
        centre = apply(T_face_artefact, sphere.centre[None])[0]
        top.plot(*centre[:2], "o", color=BLUE, ms=4, zorder=4)
        top.annotate(sphere.name, centre[:2], fontsize=7, xytext=(4, 3),
                     textcoords="offset points", **halo)  # fmt: skip
    for at, name in zip(np.eye(3)[:2] * 60.0, "xy", strict=True):
        ends = apply(T_face_artefact, np.array([np.zeros(3), at]))
        # centred on the line of the arrow, which else leans by half of the letter
        top.annotate(name, ends[0, :2], ends[1, :2], ha="center", va="center",
                     arrowprops={"arrowstyle": "<-", "color": INK}, **halo)  # fmt: skip
    of_face = _directions(T_face_table[:3, :3])
    x, y = (f"{a} of the table in mm" for a in of_face[:2])
    top.set(aspect="equal", xlabel=x, ylabel=y)
    at_zero = ", rotary axes at zero" * bool(plan.chain.rotary_axes)
    looks = "from above" if of_face[2] == "z" else f"onto the face, which looks along {of_face[2]}"
    top.set_title(f"{looks}{at_zero}", loc="left")
    plain(top)
    _probe(side, plan)
    return drawn


def _directions(R_face_table: Array) -> list[str]:
    """Directions of the table frame along x, y, z of its face: `["z", "x", "y"]`."""
    largest = [int(np.argmax(np.abs(row))) for row in R_face_table]
    signs = ["-" if R_face_table[k, i] < 0.0 else "" for k, i in enumerate(largest)]
    return [sign + "xyz"[i] for sign, i in zip(signs, largest, strict=True)]


def _room_round(base: Array, solids: Sequence[Solid]) -> tuple[Array, Array]:
    """Smallest and largest x and y of the standard and all beside it, with a margin, mm."""
    outlines = [apply(k.T_face_solid, _outline(k.plate)) for k in solids]
    points = np.concatenate([base, *outlines])[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.1 * (high - low).max()
    return low - margin, high + margin


def _whole_table(ax: Any, edge: Array, base: Array) -> None:
    """The table with the standard on it."""
    ax.plot(*edge[:, :2].T, color=SOFT, lw=1.2)
    ax.fill(*base[:, :2].T, facecolor=BLUE, alpha=0.3, edgecolor=BLUE, lw=0.8)
    ax.set_aspect("equal")
    ax.set_title("the whole table, mm", loc="left")
    plain(ax)


def _outline(plate: Plate) -> Array:
    """Points round a plate, closed, (K, 3)."""
    angle = np.linspace(0.0, 2.0 * np.pi, 121)
    inner = np.array(plate.half_size) - plate.corner_radius
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    corner = np.sign(np.round(unit, 9)) * inner + plate.corner_radius * unit
    return np.column_stack([corner, np.zeros(len(angle))])


def _probe(ax: Any, plan: TouchPlan) -> None:
    """Ball and cylinders, to scale."""
    probe, low = plan.probe, 0.0
    angle = np.linspace(0.0, 2.0 * np.pi, 60)
    ax.plot(probe.radius * np.cos(angle), probe.radius * np.sin(angle), color=RED, lw=1.2)
    for high, radius in (*probe.stack, (probe.length + 30.0, probe.nose_radius)):
        ax.plot([-radius, -radius, radius, radius, -radius], [low, high, high, low, low], color=INK,
                lw=1.0)  # fmt: skip
        low = high
    ax.axhline(probe.length, color=SOFT, lw=0.8, ls="--")
    ax.set(aspect="equal", xlabel="mm", ylabel="above the ball centre in mm")
    ax.set_title("probe; dashed: gauge line", loc="left")
    plain(ax)


def draw_touches(plan: TouchPlan) -> Figure:
    """Touched points on the standard from above and from the side, coloured by kind of feature."""
    drawn = figure(4.4)
    top, side = drawn.subplots(1, 2, width_ratios=(1.0, 1.25))
    for ax, (i, j) in ((top, (0, 1)), (side, (0, 2))):
        _outlines(ax, plan, i, j)
        for is_sphere, colour, label in ((False, BLUE, "patch"), (True, RED, "sphere")):
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
                scale=_PER_MM,
                width=0.0022,
                headwidth=3.5,
                label=f"{label}: {rows.sum()} touches",
            )
            ax.update_datalim((p + n / _PER_MM)[:, [i, j]])  # no arrow leaves the picture
        ax.set(aspect="equal", xlabel="x in mm", ylabel=f"{'xyz'[j]} in mm")
        plain(ax)
    top.set_title("from above", loc="left")
    side.set_title("from the side", loc="left")
    side.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, frameon=False)
    return drawn


def _outlines(ax: Any, plan: TouchPlan, i: int, j: int) -> None:
    """Edges of patches and circles of spheres in two coordinates of the artefact frame."""
    for name, surface in plan.standard.features.items():
        if isinstance(surface, FreeformPatch):
            a, b = surface.half_size
            s = np.linspace(-1.0, 1.0, 25)
            # along all four edges: a freeform face bends them
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
        ax.plot(edge[:, i], edge[:, j], color=SOFT, lw=0.8)
        ax.text(
            centre[i],
            centre[j],
            name,
            fontsize=7,
            color=INK,
            ha="center",
            va="center",
            bbox={"facecolor": "white", "alpha": 0.65, "lw": 0, "pad": 0.6},
        )


def draw_order(plan: TouchPlan) -> Figure:
    """Rotary readings over the sequence of touches, with the side of every approach."""
    axes = plan.chain.rotary_axes
    drawn = figure(1.0 + 1.5 * max(len(axes), 1))
    panels = np.atleast_1d(drawn.subplots(max(len(axes), 1), 1, sharex=True))
    begin = np.searchsorted(plan.visit, np.arange(len(plan.visits)))
    end = np.append(begin[1:], len(plan))
    for k, axis in enumerate(axes):
        ax = panels[k]
        reading = np.array([v.rotary[k] for v in plan.visits]) / DEG
        side = np.array([v.side[k] for v in plan.visits])
        ax.hlines(reading, begin, end, color=BLUE, lw=3)
        middle = 0.5 * (begin + end)
        for sign, marker in ((1, "^"), (-1, "v")):
            rows = side == sign
            ax.plot(
                middle[rows],
                reading[rows],
                marker,
                color=RED,
                ms=5,
                label=f"reached {'upwards' if sign > 0 else 'downwards'}",
            )
        ax.set_ylabel(f"{axis} in °")
        ax.margins(y=0.15)
        plain(ax)
    panels[-1].set_xlabel("touch, in the order of execution")
    # a machine without rotary axes has one panel, and nothing in it
    if plan.chain.rotary_axes:
        panels[0].legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, frameon=False
        )
    return drawn
