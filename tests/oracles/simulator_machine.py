"""Second model of a machine, written from the words of FORMATS.md and from nothing else.

Products of 4x4 matrices along the chain, for readings (N,) by axis letter; errors are dictionaries
from an ISO 230-1 name to an array (N,) or a number, mm and rad. Shares no code with `twin`.
"""

import tomllib
from dataclasses import dataclass

import numpy as np

UNIT = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1)}
TURNS_ABOUT = {"A": "X", "B": "Y", "C": "Z"}


@dataclass
class Axis:
    name: str
    primed: bool
    rotary: bool
    direction: np.ndarray
    point: np.ndarray
    low: float
    high: float
    programmed: bool

    def u(self, q):
        """Reading scaled to [-1, 1] over the range."""
        return (q - 0.5 * (self.low + self.high)) / (0.5 * (self.high - self.low))


@dataclass
class Machine:
    """Axes in chain order from the workpiece to the tool."""

    text: str
    axes: list
    origin: np.ndarray

    def axis(self, name):
        return next(a for a in self.axes if a.name == name)

    @property
    def programmed(self):
        return [a.name for a in self.axes if a.programmed]

    @property
    def linear(self):
        return [a.name for a in self.axes if not a.rotary]

    @property
    def rotary(self):
        return [a.name for a in self.axes if a.rotary and a.programmed]


def read_machine(text):
    tables = tomllib.loads(text)
    axes, foundation_passed = [], False
    for token in tables["chain"].strip("[] ").split()[1:-1]:
        if token == "f":
            foundation_passed = True
            continue
        name = token.strip("()'")
        letter = name[0]
        rotary = letter in TURNS_ABOUT
        table = tables["axis"].get(name, {})
        scale = np.pi / 180.0 if rotary else 1.0
        low, high = (np.array(table.get("range", (-360.0, 360.0))) * scale).tolist()
        axes.append(
            Axis(
                name,
                not foundation_passed,
                rotary,
                np.array(UNIT[TURNS_ABOUT.get(letter, letter)], dtype=float),
                np.array(table.get("point", (0.0, 0.0, 0.0)), dtype=float),
                low,
                high,
                "(" not in token,
            )
        )
    return Machine(text, axes, np.array(tables["workpiece"]["origin"], dtype=float))


IDENTITY = np.eye(4)


def eye(n):
    out = np.empty((n, 4, 4))
    out[:] = IDENTITY
    return out


def shifted(v):
    """(N, 3) -> translations (N, 4, 4)."""
    out = eye(len(v))
    out[:, 0, 3], out[:, 1, 3], out[:, 2, 3] = v[:, 0], v[:, 1], v[:, 2]
    return out


def about_x(a):
    out, c, s = eye(len(a)), np.cos(a), np.sin(a)
    out[:, 1, 1], out[:, 1, 2], out[:, 2, 1], out[:, 2, 2] = c, -s, s, c
    return out


def about_y(a):
    out, c, s = eye(len(a)), np.cos(a), np.sin(a)
    out[:, 0, 0], out[:, 0, 2], out[:, 2, 0], out[:, 2, 2] = c, s, -s, c
    return out


def about_z(a):
    out, c, s = eye(len(a)), np.cos(a), np.sin(a)
    out[:, 0, 0], out[:, 0, 1], out[:, 1, 0], out[:, 1, 1] = c, -s, s, c
    return out


ABOUT = {"A": about_x, "B": about_y, "C": about_z}


def turned(a, b, c):
    """Small rotations about the fixed x, then y, then z: ``Rz Ry Rx`` written out."""
    (sx, sy, sz), (cx, cy, cz), out = np.sin([a, b, c]), np.cos([a, b, c]), eye(len(a))
    out[:, 0, 0], out[:, 1, 0], out[:, 2, 0] = cz * cy, sz * cy, -sy
    out[:, 0, 1], out[:, 0, 2] = cz * sy * sx - sz * cx, cz * sy * cx + sz * sx
    out[:, 1, 1], out[:, 1, 2] = sz * sy * sx + cz * cx, sz * sy * cx - cz * sx
    out[:, 2, 1], out[:, 2, 2] = cy * sx, cy * cx
    return out


def about_point(T, point, move=0.0):
    """Rotations (N, 4, 4) about a point, (3,) or (N, 3), and then a displacement."""
    point = np.broadcast_to(point, (len(T), 3))
    T[:, :3, 3] = move + point - (T[:, :3, :3] @ point[:, :, None])[:, :, 0]
    return T


def undone(T):
    """Inverse of rigid motions (N, 4, 4)."""
    out = eye(len(T))
    for i in range(3):
        for j in range(3):
            out[:, i, j] = T[:, j, i]
    for i in range(3):
        out[:, i, 3] = -(
            T[:, 0, i] * T[:, 0, 3] + T[:, 1, i] * T[:, 1, 3] + T[:, 2, i] * T[:, 2, 3]
        )
    return out


def of(errors, name, n):
    return np.broadcast_to(np.asarray(errors.get(name, 0.0), dtype=float), (n,))


def component_motion(axis, q, errors):
    """The six component errors of an axis: a turn about its lever point, and a displacement."""
    n = len(q)
    if not any(f"E{letter}{axis.name}" in errors for letter in "XYZABC"):
        return eye(n)
    six = [of(errors, f"E{letter}{axis.name}", n) for letter in "XYZABC"]
    lever = axis.point
    if not axis.rotary:  # a linear axis carries its reference point along, where its body goes
        lever = lever + (-q if axis.primed else q)[:, None] * axis.direction
    E = about_point(turned(*six[3:]), lever, np.stack(six[:3], axis=1))
    return undone(E) if axis.primed else E


def nominal_motion(axis, travel):
    """Travel of the body along, or about, an axis that stands where it should."""
    if not axis.rotary:
        return shifted(travel[:, None] * axis.direction)
    main = int(np.flatnonzero(axis.direction)[0])
    return about_point(ABOUT["ABC"[main]](travel), axis.point)


def body_motion(axis, q, errors):
    """Travel along, or turn about, the axis where its location errors have put it."""
    n = len(q)
    if not any(f"E{letter}0{axis.name}" in errors for letter in "XYZABC"):
        return nominal_motion(axis, -q if axis.primed else q)
    e = [of(errors, f"E{letter}0{axis.name}", n) for letter in "XYZ"]
    r = [of(errors, f"E{letter}0{axis.name}", n) for letter in "ABC"]
    main = int(np.flatnonzero(axis.direction)[0])
    sign = -1.0 if axis.primed else 1.0
    if not axis.rotary:
        r[main] = np.zeros(n)  # a squareness: nothing about the axis itself
        direction = turned(*r)[:, :3, main]
        return shifted((sign * (q + e[main]))[:, None] * direction)
    angle = sign * (q + r[main])
    e[main], r[main] = np.zeros(n), np.zeros(n)
    line = about_point(turned(*r), axis.point, np.stack(e, axis=1))
    return line @ about_point(ABOUT["ABC"[main]](angle), axis.point) @ undone(line)


def set_up_motion(point, letter, errors, n):
    if not any(f"E{c}0{letter}" in errors for c in "XYZABC"):
        return eye(n)
    six = [of(errors, f"E{c}0{letter}", n) for c in "XYZABC"]
    return about_point(turned(*six[3:]), point, np.stack(six[:3], axis=1))


def table_and_tool(machine, q, errors):
    """Poses of the table and of the tool in the machine frame, (N, 4, 4) each.

    Args:
        machine: The machine.
        q: Readings (N,) by axis name; a spindle left out stands at zero.
        errors: By ISO name.
    """
    n = len(next(iter(q.values())))
    table, tool = eye(n), eye(n)
    for axis in reversed([a for a in machine.axes if a.primed]):
        reading = q.get(axis.name, np.zeros(n))
        table = table @ component_motion(axis, reading, errors) @ body_motion(axis, reading, errors)
    table = table @ set_up_motion(machine.origin, "w", errors, n)
    for axis in [a for a in machine.axes if not a.primed]:
        reading = q.get(axis.name, np.zeros(n))
        tool = tool @ component_motion(axis, reading, errors) @ body_motion(axis, reading, errors)
    tool = tool @ set_up_motion(np.zeros(3), "t", errors, n)
    return table @ shifted(np.tile(machine.origin, (n, 1))), tool


def tip(machine, q, length, errors=None):
    """Ball centre in the table frame, (N, 3)."""
    table, tool = table_and_tool(machine, q, errors or {})
    T = undone(table) @ tool
    return T[:, :3, 3] - length * T[:, :3, 2]


def tool_axes(machine, q):
    """Nominal directions of the tool's x, y, z in the table frame: columns of (N, 3, 3)."""
    table, tool = table_and_tool(machine, q, {})
    return (undone(table) @ tool)[:, :3, :3]


def tip_per_linear(machine, q, length):
    """Nominal motion of the tip per unit of each linear axis, columns of (N, 3, 3); and the tip
    with every linear axis at zero."""
    rest = {name: (np.zeros_like(v) if name in machine.linear else v) for name, v in q.items()}
    start = tip(machine, rest, length)
    columns = []
    for name in machine.linear:
        ahead = dict(rest)
        ahead[name] = np.full(len(start), 100.0)
        columns.append((tip(machine, ahead, length) - start) / 100.0)
    return np.stack(columns, axis=2), start


def readings_at(machine, target, q, length):
    """Readings that bring the nominal ball centre to a target (N, 3) at given rotary readings."""
    D, start = tip_per_linear(machine, q, length)
    move = np.linalg.solve(D, (target - start)[:, :, None])[:, :, 0]
    out = dict(q)
    for i, name in enumerate(machine.linear):
        out[name] = move[:, i]
    return out
