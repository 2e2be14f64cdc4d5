"""Bodies of a machine by rule from its chain alone: plain solids, not to scale.

Both sides are built from their end, workpiece or tool, to the foundation. Each axis adds the part
that it moves and, on the body that carries it, what it moves on:

- a linear axis across its side: a carriage, and rails as long as its travel;
- a linear axis along its side: a ram, and the housing that guides it;
- a rotary axis along its side: a disc;
- a rotary axis across its side: trunnions on its line with arms, and their bearings;
- a joint of an arm: a drum on its line and a tube to the next one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from matstd.report.machine.solids import FOUNDATION, Drawn, ball, block, cylinder, frame_along, rod
from matstd.report.style import series
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Link

TOOL_RADIUS, BALL_RADIUS = 4.0, 6.0  # of the tool that is drawn, mm
_NOSE_RADIUS, _NOSE = 45.0, 170.0  # of the spindle, mm: those of a spindle HSK 63
_STEEL, _RAIL, _BED = "#aeb6c0", "#6b7685", "#d3d8de"
_TINT = 0.45  # of the colour of an axis that its bodies keep; the rest is white
_ALIGNED = 0.7  # cosine from which an axis counts as along its side
_MIN_HALF_WIDTH = 60.0  # mm: half a body's width at least
_MAX_HALF_WIDTH = 450.0  # mm: half a table's width at most


@dataclass(frozen=True, slots=True)
class Letter:
    """Where the letter of an axis stands."""

    on: str  # link that carries it
    text: str  # the letter
    place: tuple[float, float, float]  # frame of the machine with every axis at zero, (3,), mm


@dataclass
class _Side:
    """One side of a machine while it is built, from its end to the foundation."""

    outwards: Array  # direction from the end to the foundation, (3,)
    # box round all that was built, (3,), mm
    low: Array
    high: Array
    bodies: list[Drawn] = field(default_factory=list)
    letters: list[Letter] = field(default_factory=list)

    @property
    def middle(self) -> Array:
        return 0.5 * (self.low + self.high)

    @property
    def end(self) -> float:
        """How far out it reaches, along `outwards`, mm."""
        return float(np.where(self.outwards > 0, self.high, self.low) @ self.outwards)

    def half(self, along: Array) -> float:
        """Half its width in a direction, mm."""
        return float(np.abs(along) @ (0.5 * (self.high - self.low)))

    def add(self, on: str, colour: str, *parts: Array) -> None:
        """A body, which the box then holds too."""
        corners = np.concatenate(parts)
        self.bodies.append(Drawn(on, colour, corners))
        self.low = np.minimum(self.low, corners.min(axis=(0, 1)))
        self.high = np.maximum(self.high, corners.max(axis=(0, 1)))

    def write(self, axis: str, place: Array) -> None:
        """The letter of an axis, on what it moves."""
        x, y, z = (float(v) for v in place)
        self.letters.append(Letter(axis, axis, (x, y, z)))


def chain_bodies(chain: Chain, length: float) -> tuple[list[Drawn], list[Letter]]:
    """Bodies and letters of a machine; `length` of the tool from the gauge point to its tip, mm."""
    up = np.array([0.0, 0.0, 1.0])
    colours = {name: _tinted(series(k)) for k, name in enumerate(chain.axes)}
    inner = [k for k in chain.links if k.carries_workpiece and k.kind != "fixed"]
    outer = [k for k in reversed(chain.links) if not k.carries_workpiece and k.kind != "fixed"]
    tool = _Side(up, np.zeros(3), np.zeros(3))
    tool.add("t", _STEEL, *_tool(length))
    if chain.joints:
        _arm(tool, [k for k in outer if k.is_joint], colours)
        outer = [k for k in outer if not k.is_joint]
    else:
        tool.add(_spindle(outer), _STEEL, cylinder(_NOSE_RADIUS, _NOSE_RADIUS, 0.0, _NOSE))
        tool.low, tool.high = (
            np.array([-_NOSE_RADIUS] * 2 + [0.0]),
            np.array([_NOSE_RADIUS] * 2 + [_NOSE]),
        )
    table = _table(chain, inner)
    _stack(table, [k for k in inner if k.programmed], colours)
    _stack(tool, [k for k in outer if k.programmed], colours)
    bed = _foundation(table, tool)
    return [*table.bodies, *tool.bodies, *bed], [*table.letters, *tool.letters]


def _tinted(colour: str) -> str:
    parts = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round(255 - _TINT * (255 - v)):02x}" for v in parts)


def _tool(length: float) -> list[Array]:
    """A thin cylinder with a ball round its tip; nothing sticks out of a tool without length."""
    tip = ball(min(BALL_RADIUS, 0.4 * length) if length > 0.0 else BALL_RADIUS)
    parts = [tip - [0.0, 0.0, length]]
    if length > 0.0:
        parts.append(cylinder(TOOL_RADIUS, TOOL_RADIUS, -length, 0.0))
    return parts


def _spindle(outer: Sequence[Link]) -> str:
    """Link that the spindle's nose belongs to: the body that carries the tool."""
    programmed = [k.name for k in outer if k.programmed]
    return programmed[0] if programmed else FOUNDATION


def _table(chain: Chain, inner: Sequence[Link]) -> _Side:
    """The end of the workpiece's side: its table, whose face holds the table's origin."""
    up = np.array([0.0, 0.0, 1.0])
    first = inner[0] if inner else None
    if first is not None and first.kind == "rotary" and abs(first.direction[1]) > _ALIGNED:
        up = np.array([0.0, 1.0, 0.0])  # with a level spindle Y stands upright (ISO 841)
    origin = chain.table_origin
    side = _Side(-up, origin.copy(), origin.copy())
    reach = [k.range[1] - k.range[0] for k in chain.links if k.kind == "linear" and k.programmed]
    half = float(np.clip(0.3 * min(reach, default=600.0), _MIN_HALF_WIDTH, _MAX_HALF_WIDTH))
    if first is None or first.kind != "rotary" or abs(first.direction @ up) < _ALIGNED:
        axes = frame_along(up)
        at = axes @ origin
        wide, thick = np.array([half, half, 0.0]), np.array([0.0, 0.0, 0.25 * _MIN_HALF_WIDTH])
        plate = block(at - wide - thick, at + wide, axes)
        side.add("w" if first is None else first.name, _STEEL, plate)
    else:
        side.low, side.high = origin - half * (1.0 - np.abs(up)), origin + half * (1.0 - np.abs(up))
    return side


def _stack(side: _Side, links: Sequence[Link], colours: dict[str, str]) -> None:
    """Every axis of a side, with what it moves on."""
    for k, link in enumerate(links):
        carrier = links[k + 1].name if k + 1 < len(links) else FOUNDATION
        is_along = abs(float(link.direction @ side.outwards)) > _ALIGNED
        carried = colours.get(carrier, _BED)
        if link.kind == "linear":
            build = _ram if is_along else _carriage
        else:
            build = _disc if is_along else _cradle
        build(side, link, carrier, (colours[link.name], carried))


def _frame(side: _Side, direction: Array) -> Array:
    """Directions in rows: along an axis, across it, and outwards."""
    along = direction - (direction @ side.outwards) * side.outwards
    along = along / np.linalg.norm(along)
    return np.array([along, np.cross(side.outwards, along), side.outwards])


def _carriage(side: _Side, link: Link, carrier: str, colour: tuple[str, str]) -> None:
    """A slab, and below it two rails on the body that carries it."""
    axes = _frame(side, link.direction)
    at, half = axes @ side.middle, [max(side.half(a), _MIN_HALF_WIDTH) for a in axes[:2]]
    thick, begin = 0.35 * _MIN_HALF_WIDTH + 0.06 * max(half), side.end
    low = np.array([at[0] - half[0], at[1] - half[1], begin])
    high = np.array([at[0] + half[0], at[1] + half[1], begin + thick])
    side.add(link.name, colour[0], block(low, high, axes))
    side.write(link.name, np.array([high[0], low[1], begin + 0.5 * thick]) @ axes)
    first, last = _travel(link)
    rail = np.array([low[0] + first, 0.0, high[2]]), np.array([high[0] + last, 0.0, high[2] + 22.0])
    parts = []
    for across in (-0.7, 0.7):
        middle = at[1] + across * half[1]
        wide = np.array([0.0, max(0.08 * half[1], 8.0), 0.0])
        place = np.array([0.0, middle, 0.0])
        parts.append(block(rail[0] + place - wide, rail[1] + place + wide, axes))
    side.add(carrier, _RAIL, *parts)
    if carrier == FOUNDATION:
        side.add(carrier, _BED, *(part + 22.0 * side.outwards for part in parts))
    else:  # the body that has the rails
        below = np.array([rail[0][0], low[1], rail[1][2]])
        above = np.array([rail[1][0], high[1], rail[1][2] + 0.4 * thick])
        side.add(carrier, colour[1], block(below, above, axes))


def _travel(link: Link) -> tuple[float, float]:
    """Ends of the motion of its body along its direction, ascending, mm."""
    low, high = link.range
    return (-high, -low) if link.carries_workpiece else (low, high)


def _ram(side: _Side, link: Link, carrier: str, colour: tuple[str, str]) -> None:
    """A bar as long as its travel, and round it the housing that it slides in."""
    axes = frame_along(side.outwards)
    at, begin = axes @ side.middle, side.end
    half = float(
        np.clip(min(side.half(axes[0]), side.half(axes[1])), _MIN_HALF_WIDTH, 2.0 * _MIN_HALF_WIDTH)
    )
    ends = np.array(_travel(link)) * float(link.direction @ side.outwards)
    first, last = float(ends.min()), float(ends.max())
    deep = 3.0 * half  # of the housing
    wide = np.array([half, half, 0.0])
    middle = np.array([at[0], at[1], 0.0])
    low, high = middle - wide, middle + wide
    low[2], high[2] = begin, begin + (last - first) + deep
    side.add(link.name, colour[0], block(low, high, axes))
    side.write(link.name, np.array([at[0] + half, at[1], high[2]]) @ axes)
    side.high, side.low = side.high.copy(), side.low.copy()
    wall, guide = 0.35 * half, (begin + last, begin + last + deep)
    parts = []
    for k, sign in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)):
        a, b = middle - half - wall * (k == 0), middle + half + wall * (k == 0)
        a[k], b[k] = sorted((at[k] + sign * half, at[k] + sign * (half + wall)))
        a[2], b[2] = guide
        parts.append(block(a, b, axes))
    # what comes next is built on the housing, not on the bar that moves through it
    side.low, side.high = middle @ axes, middle @ axes
    side.add(carrier, colour[1], *parts)


def _disc(side: _Side, link: Link, carrier: str, colour: tuple[str, str]) -> None:
    """A disc on the line of the axis; what carries it comes with the next axis."""
    axes = frame_along(side.outwards)
    centre = link.point + ((side.middle - link.point) @ link.direction) * link.direction
    at = axes @ centre
    radius = max(side.half(axes[0]), side.half(axes[1]), _MIN_HALF_WIDTH)
    thick, begin = 0.35 * _MIN_HALF_WIDTH + 0.1 * radius, side.end
    plain = cylinder(radius, radius, begin, begin + thick) + np.array([at[0], at[1], 0.0])
    # a mark on the rim shows that it turns
    mark = block(
        np.array([at[0] + 0.82 * radius, at[1] - 0.05 * radius, begin - 1.0]),
        np.array([at[0] + 1.03 * radius, at[1] + 0.05 * radius, begin + thick]),
        axes,
    )
    side.add(link.name, colour[0], plain @ axes)
    side.add(link.name, _RAIL, mark)
    side.write(link.name, np.array([at[0] - radius, at[1], begin + 0.5 * thick]) @ axes)


def _cradle(side: _Side, link: Link, carrier: str, colour: tuple[str, str]) -> None:
    """Trunnions on the line with arms to all that they swing, and bearings on the carrier."""
    axes = _frame(side, link.direction)
    at, line = axes @ side.middle, axes @ link.point
    wide = max(side.half(axes[0]), _MIN_HALF_WIDTH) + 15.0
    deep = max(side.half(axes[1]), _MIN_HALF_WIDTH)
    plate, arm = 0.3 * _MIN_HALF_WIDTH + 0.05 * wide, 0.25 * _MIN_HALF_WIDTH + 0.06 * wide
    round_line = max(1.2 * arm, 0.4 * _MIN_HALF_WIDTH)
    end = max(side.end, line[2] - round_line)
    # the line may lie above or below the plate: arms reach over both
    level = sorted((line[2] - round_line, end + plate))
    parts = [
        block(
            np.array([at[0] - wide - arm, at[1] - 0.6 * deep, end]),
            np.array([at[0] + wide + arm, at[1] + 0.6 * deep, end + plate]),
            axes,
        )
    ]
    trunnions = []
    for sign in (-1.0, 1.0):
        near, far = sorted((at[0] + sign * wide, at[0] + sign * (wide + arm)))
        width = min(0.6 * deep, 1.5 * round_line)
        low = np.array([near, min(line[1], at[1]) - width, level[0]])
        high = np.array([far, max(line[1], at[1]) + width, level[1]])
        parts.append(block(low, high, axes))
        pins = [at[0] + sign * (wide + k * arm) for k in (0.8, 2.4)]
        ends = [np.array([pin, line[1], line[2]]) @ axes for pin in pins]
        trunnions.append(rod(ends[0], ends[1], 0.6 * round_line))
    side.add(link.name, colour[0], *parts, *trunnions)
    side.write(link.name, np.array([at[0] + wide + 2.6 * arm, line[1], line[2]]) @ axes)
    corners = np.concatenate(
        [*(b.corners.reshape(-1, 3) for b in side.bodies if b.on == link.name)]
    )
    local = corners @ axes.T - line
    # bearings stand on a foot that nothing which swings can reach
    swing = float(np.hypot(local[:, 1], local[:, 2]).max()) + 15.0
    foot = line[2] + swing
    bearings = []
    for sign in (-1.0, 1.0):
        near, far = sorted(at[0] + sign * (wide + k * arm) for k in (1.3, 2.3))
        low = np.array([near, line[1] - 1.1 * round_line, line[2] - 1.1 * round_line])
        high = np.array([far, line[1] + 1.1 * round_line, foot])
        bearings.append(block(low, high, axes))
    low = np.array([at[0] - wide - 2.3 * arm, line[1] - deep, foot])
    high = np.array([at[0] + wide + 2.3 * arm, line[1] + deep, foot + plate])
    side.add(carrier, colour[1], *bearings, block(low, high, axes))


def _arm(side: _Side, joints: Sequence[Link], colours: dict[str, str]) -> None:
    """Drums on the lines of the joints of an arm, and tubes between them, from the tool on."""
    before = np.zeros(3)
    for k, link in enumerate(joints):
        carrier = joints[k + 1].name if k + 1 < len(joints) else FOUNDATION
        size = _MIN_HALF_WIDTH * (0.6 + 0.15 * k)
        # of a line the point next to where the arm has come is where the drum sits
        centre = link.point + ((before - link.point) @ link.direction) * link.direction
        if np.linalg.norm(before - centre) > 1.0:
            side.add(link.name, colours[link.name], rod(before, centre, 0.55 * size))
        reach = 1.1 * size * link.direction
        side.add(carrier, colours.get(carrier, _BED), rod(centre - reach, centre + reach, size))
        side.write(link.name, centre + 1.3 * reach)
        before = centre


def _foundation(table: _Side, tool: _Side) -> list[Drawn]:
    """A bed below the workpiece's side, and what stands on it to carry the tool's side."""
    held = [b.corners.reshape(-1, 3) for b in tool.bodies if b.on == FOUNDATION]
    points = np.concatenate(held) if held else np.array([tool.low, tool.high])
    low, high = points.min(axis=0), points.max(axis=0)
    margin, thick = 0.5 * _MIN_HALF_WIDTH, 1.5 * _MIN_HALF_WIDTH
    axis = int(np.argmax(np.abs(table.outwards)))
    bed = np.array([table.low - margin, table.high + margin])
    sense = float(table.outwards[axis])
    bed[:, axis] = sorted((sense * table.end, sense * (table.end + thick)))
    if axis == _UP:
        parts = _portal(bed, low, high) if high[0] - low[0] > high[1] - low[1] else []
        parts = parts or _column(bed, low, high)
    else:  # the spindle is level: a wall behind the tool's side, from the bed up
        wall = np.array([low - margin, high + margin])
        wall[:, _UP] = tool.end, tool.end + 2.0 * _MIN_HALF_WIDTH
        wall[0, axis], wall[1, axis] = min(wall[0, axis], bed[0, axis]), high[axis] + margin
        bed[1, _UP] = max(bed[1, _UP], wall[1, _UP])
        parts = [block(*wall)]
    return [Drawn(FOUNDATION, _BED, np.concatenate([block(*bed), *parts]))]


def _portal(bed: Array, low: Array, high: Array) -> list[Array]:
    """Four legs below the ends of two rails; the bed grows to stand below them."""
    leg = _MIN_HALF_WIDTH + 0.03 * (high[0] - low[0])
    bed[0, :2] = np.minimum(bed[0, :2], low[:2] - leg)
    bed[1, :2] = np.maximum(bed[1, :2], high[:2] + leg)
    out = []
    for x in (low[0], high[0] - leg):
        for y in (low[1] - leg, high[1]):
            foot = np.array([x, y, bed[1, _UP] - 1.0])
            out.append(block(foot, np.array([x + leg, y + leg, high[_UP]])))
    return out


def _column(bed: Array, low: Array, high: Array) -> list[Array]:
    """A column behind everything, with a beam to what it carries."""
    back, deep = max(bed[1, 1], high[1]), 2.0 * _MIN_HALF_WIDTH
    beam = block(np.array([low[0], high[1] - 1.0, low[_UP]]), np.array([high[0], back, high[_UP]]))
    bed[1, 1] = back + deep
    foot = np.array([low[0] - 0.5 * _MIN_HALF_WIDTH, back, bed[0, _UP]])
    return [beam, block(foot, np.array([high[0] + 0.5 * _MIN_HALF_WIDTH, back + deep, high[_UP]]))]


_UP = 2  # index of Z, along which the tool points on every machine
