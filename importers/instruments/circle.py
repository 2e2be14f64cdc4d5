"""Circular tests (ISO 230-4): radial deviations of a ball bar or a grid plate over the angle.

The bar says by how much the tool is farther from the centre than the path that was programmed:
actual minus nominal. A controller that believes in its machine sees the circle outside its place by
the negative of that, along the radius; a deviation in the file gets the other sign here.

Reference:
    ISO 230-4 (circular tests for numerically controlled machine tools).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.importers.instruments.axis_log import strokes
from matstd.importers.sheets import ANGLES, MM, Sheet, bare, unit_of_column
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array, apply
from matstd.twin.machine import Axis, Chain, linear_directions, make_chain, table_to_tool
from matstd.twin.record import Instrument, IntArray, Labels, Run, Setup, Touches
from matstd.twin.units import MINUTE

BETWEEN = 10.0
"""Pause (s) between two runs of which nobody says how long it was."""

JUST = 1e-6
"""Angle (rad) before a reading at which its axes last moved for certain."""

IS_RADIUS = 0.1
"""Distance of a column's mean from the radius, as a share of it, up to which it holds radii."""

_ANGLE = re.compile(r"angle|winkel|theta|θ|\bphi\b|φ|azimut", re.IGNORECASE)
_RUN = re.compile(r"\brun|lauf|direction|richtung|sense|\bdir\b|drehsinn", re.IGNORECASE)
_CCW = re.compile(r"ccw|anti|counter|gegen|\bg0?3\b|\+", re.IGNORECASE)
_CW = re.compile(r"cw|clockwise|uhrzeiger|im uhr|\bg0?2\b|-", re.IGNORECASE)
_DEVIATION = re.compile(r"dev|radial|radius|error|abweich|fehler|δ|delta|\bdr", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class CircularTest:
    """Readings of a circular test in the order in which they were taken.

    Attributes:
        plane: Letters of its two axes; angles count from the first to the second.
        radius: Nominal, mm.
        angle: (N,), rad.
        deviation: Actual minus nominal radius, (N,), mm.
        sense: 1 from the first axis to the second, -1 the other way round, (N,).
        run: Name of the run, (N,).
        line: Line of the file, (N,).
    """

    plane: str
    radius: float
    angle: Array
    deviation: Array
    sense: IntArray
    run: Labels
    line: IntArray


def read_circle(sheet: Sheet, plane: str, radius: float, unit: str | None = None) -> CircularTest:
    """A circular test from a table: a row a reading, or a row an angle and a column a run.

    Places `X` and `Y` from the centre, as of a grid plate, may stand for angles and deviations.

    Runs are told by a column of directions, by columns named for theirs (CCW, CW, G3, G2, gegen,
    im Uhrzeigersinn), else by angles that rise or fall.

    Args:
        plane: `XY`, `ZX` ...: angles count from the first axis to the second.
        radius: Nominal radius, mm.
        unit: Of deviations whose column names none.

    Raises:
        BadFile: Neither angles and deviations nor two coordinates, a unit or a direction that is
            not stated.
    """
    names = [bare(c) for c in sheet.columns]
    at = next((i for i, n in enumerate(names) if _ANGLE.search(n)), None)
    letters = [_named(names, letter) for letter in plane]
    if at is None and None not in letters:
        return _cartesian(sheet, plane, radius, [i for i in letters if i is not None])
    if at is None:
        listed = ", ".join(map(repr, sheet.columns))
        raise BadFile(
            sheet.path, "header", f"columns {listed}", "a column of angles, or of both coordinates"
        )
    angle = sheet.numbers(at) * ANGLES.get(unit_of_column(sheet.columns[at]) or "deg", 1.0)
    told = next((i for i, n in enumerate(names) if i != at and _is_told(sheet, i, n)), None)
    values = [i for i, n in enumerate(names) if i not in (at, told) and _is_value(sheet, i, n)]
    if not values:
        listed = ", ".join(map(repr, sheet.columns))
        raise BadFile(sheet.path, "header", f"columns {listed}", "a column of radial deviations")
    parts = [_column(sheet, plane, radius, unit, angle, i, told, len(values) > 1) for i in values]
    rows = [np.isfinite(p.deviation) & np.isfinite(p.angle) for p in parts]
    both = list(zip(parts, rows, strict=True))
    return CircularTest(
        plane=plane,
        radius=radius,
        angle=np.concatenate([p.angle[r] for p, r in both]),
        deviation=np.concatenate([p.deviation[r] for p, r in both]),
        sense=np.concatenate([p.sense[r] for p, r in both]),
        run=np.concatenate([p.run[r] for p, r in both]),
        line=np.concatenate([p.line[r] for p, r in both]),
    )


def _named(names: Sequence[str], letter: str) -> int | None:
    """Column of a coordinate, by its letter."""
    pattern = re.compile(rf"(?<![a-z]){letter}(?![a-z])", re.IGNORECASE)
    return next((i for i, n in enumerate(names) if pattern.search(n.replace("_", " "))), None)


def _cartesian(sheet: Sheet, plane: str, radius: float, columns: list[int]) -> CircularTest:
    """Places on the circle, as a grid plate or two scales read them."""
    units = [unit_of_column(sheet.columns[i]) or "mm" for i in columns]
    if odd := [u for u in units if u not in MM]:
        raise BadFile(sheet.path, "header", odd[0], f"one of {', '.join(MM)}")
    x, y = (sheet.numbers(i) * MM[u] for i, u in zip(columns, units, strict=True))
    angle = np.arctan2(y, x)
    sense, stroke = strokes(np.unwrap(angle))
    sense[sense == 0] = sense[sense != 0][0] if sense.any() else 1
    return CircularTest(
        plane=plane,
        radius=radius,
        angle=angle,
        deviation=np.hypot(x, y) - radius,
        sense=sense,
        run=np.array([f"run{k}" for k in stroke]),
        line=np.array(sheet.lines),
    )


def _is_told(sheet: Sheet, column: int, name: str) -> bool:
    """Whether a column says of every row which way round it was taken."""
    words = {t for t in sheet.looked_at(column) if t}
    return bool(_RUN.search(name)) and bool(words) and all(_sense(w) for w in words)


def _is_value(sheet: Sheet, column: int, name: str) -> bool:
    """Whether a column holds deviations, or radii."""
    cells = [row[column] for row in sheet.cells if row[column] != ""]
    is_number = bool(cells) and all(isinstance(c, float) for c in cells)
    return is_number and bool(_DEVIATION.search(name) or _sense(name))


def _sense(word: str) -> int:
    """1 counter-clockwise, -1 clockwise, 0 for a word that says neither."""
    if word in ("1", "-1"):
        return int(word)
    return 1 if _CCW.search(word) else -1 if _CW.search(word) else 0


def _column(
    sheet: Sheet,
    plane: str,
    radius: float,
    unit: str | None,
    angle: Array,
    column: int,
    told: int | None,
    is_one_of_several: bool,
) -> CircularTest:
    """Readings of one column, in the order in which they were taken."""
    name, n = sheet.columns[column], len(sheet)
    values = sheet.numbers(column)
    known = unit_of_column(name) or unit
    if known not in MM:
        found = f"column {name!r} without a unit of length"
        raise BadFile(sheet.path, "header", found, f"one of {', '.join(MM)} behind it, or --unit")
    values = values * MM[known]
    if abs(float(np.nanmean(values)) - radius) < IS_RADIUS * radius:
        values = values - radius
    order = np.arange(n)
    if told is not None:
        sense = np.array([_sense(t) for t in sheet.text(told)], dtype=np.int64)
        run = np.array(sheet.text(told))
    elif _sense(bare(name)):
        sense, run = np.full(n, _sense(bare(name))), np.full(n, bare(name))
        rising = float(np.nanmedian(np.diff(angle))) > 0.0
        # a table over rising angles holds a clockwise run backwards
        order = order if rising == (sense[0] > 0) else order[::-1]
    elif is_one_of_several:
        found = f"column {name!r}"
        raise BadFile(sheet.path, "header", found, "CCW or CW in the names of several runs")
    else:
        sense, stroke = strokes(np.unwrap(angle))
        sense[sense == 0] = sense[sense != 0][0] if sense.any() else 1
        run = np.array([f"run{k}" for k in stroke])
    return CircularTest(
        plane=plane,
        radius=radius,
        angle=angle[order],
        deviation=values[order],
        sense=sense[order],
        run=run[order],
        line=np.array(sheet.lines)[order],
    )


def circle_machine(plane: str, radius: float) -> Chain:
    """A machine of the two axes of a circle, whose travels are its diameter."""
    axes = {letter: Axis(range=(-radius, radius)) for letter in plane}
    return make_chain("two axes", f"[w f {' '.join(plane)} t]", axes)


def circle_run(
    test: CircularTest,
    chain: Chain,
    u: float,
    centre: Sequence[float] = (0.0, 0.0, 0.0),
    feed: float | None = None,
    bar_force: float | None = None,
) -> Run:
    """Run of a circular test: a row a reading, along the radius outwards.

    Args:
        test: The readings.
        chain: A machine with the two axes.
        u: Standard uncertainty of one reading, mm.
        centre: Readings of X, Y and Z at the centre of the circle, mm.
        feed: Along the path, mm/min: times of the rows follow from it; None leaves them 0.
        bar_force: Of a loaded bar that pushes the tool away from the centre, N; negative pulls.

    Raises:
        UnknownAxis: The machine does not have the axes.
        DesignError: The circle leaves a travel.
    """
    n = len(test.angle)
    first, second = (chain.axis_index(letter) for letter in test.plane)
    around = np.column_stack([np.cos(test.angle), np.sin(test.angle)])
    q = np.zeros((n, len(chain.axes)))
    for letter, value in zip("XYZ", centre, strict=True):
        if letter in chain.axes:
            q[:, chain.axis_index(letter)] = value
    at_centre = q.copy()
    q[:, [first, second]] += test.radius * around
    for letter in test.plane:
        low, high = chain.link(letter).range
        reading = q[:, chain.axis_index(letter)]
        if reading.min() < low - 1e-6 or reading.max() > high + 1e-6:
            raise DesignError(
                f"--circle {test.plane}: {letter} from {reading.min():g} to {reading.max():g} mm; "
                f"its travel is {low:g} to {high:g}; --centre states the middle of the circle"
            )
    approach = np.zeros(q.shape)
    before = test.angle - JUST * test.sense  # at a quadrant an axis has not turned round yet
    turned = np.column_stack([-np.sin(before), np.cos(before)]) * test.sense[:, None]
    approach[:, [first, second]] = np.sign(turned)
    D = linear_directions(chain, at_centre)
    columns = [chain.linear_axes.index(letter) for letter in test.plane]
    normal = np.einsum("nij,nj->ni", D[:, :, columns], around)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    touches = Touches(
        chain=chain,
        q=q,
        length=np.zeros(n),
        radius=np.zeros(n),
        point=apply(table_to_tool(chain, q), np.zeros((n, 3))),
        normal=normal,
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=_times(test, feed),
        approach=approach,
        feature=test.run,
        force=None if bar_force is None else bar_force * normal,
        instrument=Instrument.BALL_BAR,
    )
    return Run(touches, -test.deviation, np.full(n, u), line=test.line)


def _times(test: CircularTest, feed: float | None) -> Array:
    """Time of every row, (N,), s, from the way along the path."""
    if feed is None:
        return np.zeros(len(test.angle))
    step = np.abs(np.diff(np.unwrap(test.angle), prepend=test.angle[:1]))
    took = step * test.radius / (feed / MINUTE)
    changes = np.flatnonzero(test.run[1:] != test.run[:-1]) + 1
    took[changes] = BETWEEN
    return np.asarray(np.cumsum(took))
