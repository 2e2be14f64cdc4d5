"""Pictures of what a machine reaches of a blank, and of the bodies that fit on it side by side."""

import numpy as np

from matstd.artefact.feasibility import Room
from matstd.artefact.layout import Blank, least_gap
from matstd.artefact.reach import ANGLE, Limit, PlacesInReach
from matstd.report.style import BLUE, INK, RED, Axes, Figure, figure, plain
from matstd.twin.machine import Chain
from matstd.twin.units import DEG

_COLOURS = "viridis"


def draw_reach(reach: PlacesInReach, chain: Chain, blank: Blank) -> Figure:
    """Places within reach by angle and travels, before design."""
    drawn = figure(7.6, layout=None)  # a constrained layout would draw everything twice
    drawn.subplots_adjust(0.07, 0.07, 0.97, 0.89, 0.24, 0.32)
    top, side, poses, limits = drawn.subplots(2, 2).ravel()
    drawn.suptitle(
        f"{reach.places} of {len(reach.point)} places of a standard of this blank are within reach "
        f"at {int(reach.reached.any(axis=0).sum())} of {len(reach.poses)} table poses",
        color=INK,
    )
    _places(drawn, top, reach, 1, "from above")
    _places(drawn, side, reach, 2, "from the side")
    a, b = blank.base.half_size
    for axes, low, high, across in ((top, -b, b, a), (side, 0.0, blank.height, a)):
        axes.plot(
            [-across, across, across, -across, -across], [low, low, high, high, low], color=INK
        )
    _poses(drawn, poses, reach, chain)
    _limits(limits, reach)
    return drawn


def _places(drawn: Figure, axes: Axes, reach: PlacesInReach, other: int, title: str) -> None:
    """Places with the share of the table poses at which each is reached."""
    share = 100.0 * reach.reached.mean(axis=1)
    x, y = reach.point[:, 0], reach.point[:, other]
    shown = axes.scatter(x, y, c=share, cmap=_COLOURS, vmin=0.0, vmax=100.0, s=22)
    never = share == 0.0
    axes.scatter(x[never], y[never], marker="x", color=RED, s=26, label="never reached")
    _blank_axes(axes, other, title)
    if never.any():
        axes.legend(loc="upper right", fontsize=8)
    drawn.colorbar(shown, ax=axes, label="table poses that reach it in %")


def _blank_axes(axes: Axes, other: int, title: str) -> None:
    across = f"{'xyz'[other]} of the standard in mm"
    axes.set(xlabel="x of the standard in mm", ylabel=across, aspect="equal")
    axes.set_title(f"the blank {title}", loc="left")
    plain(axes)


def _poses(drawn: Figure, axes: Axes, reach: PlacesInReach, chain: Chain) -> None:
    """Share of the places that each table pose reaches."""
    names, share = chain.rotary_axes, 100.0 * reach.reached.mean(axis=0)
    axes.set_title("table poses", loc="left")
    plain(axes)
    if len(names) >= 2:
        a, b = (reach.poses[:, i] / DEG for i in (0, 1))
        shown = axes.scatter(a, b, c=share, cmap=_COLOURS, vmin=0.0, vmax=100.0, s=40)
        axes.set(xlabel=f"{names[0]} in °", ylabel=f"{names[1]} in °")
        drawn.colorbar(shown, ax=axes, label="places reached in %")
    elif names:
        order = np.argsort(reach.poses[:, 0])
        axes.plot(reach.poses[order, 0] / DEG, share[order], ".-", color=BLUE)
        axes.set(xlabel=f"{names[0]} in °", ylabel="places reached in %", ylim=(0.0, 105.0))
    else:
        axes.axis("off")
        axes.text(0.5, 0.5, f"no rotary axis: {share[0]:.0f} % of the places", ha="center")


def _limits(axes: Axes, reach: PlacesInReach) -> None:
    """Share of all touches, every place at every pose, that each limit bars."""
    barred = reach.barred()
    axes.set_title("limits that prevent touches", loc="left")
    plain(axes, "x")
    if not barred:
        axes.axis("off")
        axes.text(0.5, 0.5, "every place is reached at every table pose", ha="center")
        return
    for row, (limit, share) in enumerate(barred):
        axes.barh(row, 100.0 * share, 0.4, color=BLUE)
        words = f"{_words(limit)}: {100.0 * share:.0f} %"
        axes.text(0.0, row - 0.25, words, va="bottom", color=INK)
    axes.set(xlabel="share of all touches tried in %", xlim=(0.0, 100.0), yticks=[])
    axes.set_ylim(max(len(barred), 3) - 0.5, -0.8)


def _words(limit: Limit) -> str:
    if limit.name == ANGLE:
        return f"over {limit.at / DEG:g}° from the tool axis"
    return f"{limit.name} {'above' if limit.upper else 'below'} {limit.at:g} mm"


def draw_room(room: Room) -> Figure:
    """Faces and balls that stand side by side, from above and the side."""
    blank = room.blank
    drawn = figure(5.0)
    drawn.suptitle(
        f"{len(room.faces)} of {room.wanted} patches and {len(room.balls)} balls fit side by side: "
        f"between two bodies cutter and probe need {least_gap(blank.limits):g} mm",
        color=INK,
    )
    a, b = blank.base.half_size
    views = ((1, "from above", -b, b), (2, "from the side", 0.0, blank.height))
    round_it = np.linspace(0.0, 2.0 * np.pi, 60)
    for axes, (other, title, low, high) in zip(drawn.subplots(1, 2), views, strict=True):
        for face in room.faces:
            x, y = face.half_size
            uv = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
            outline = face.point(uv)
            axes.fill(outline[:, 0], outline[:, other], color=BLUE, alpha=0.5, lw=0.0)
        for ball in room.balls:
            x, y = ball.centre[0], ball.centre[other]
            turned = ball.radius * np.stack([np.cos(round_it), np.sin(round_it)])
            axes.fill(x + turned[0], y + turned[1], color=RED, alpha=0.7, lw=0.0)
        axes.plot([-a, a, a, -a, -a], [low, low, high, high, low], color=INK, lw=1.0)
        _blank_axes(axes, other, title)
    return drawn
