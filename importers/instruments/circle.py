"""Circular tests (ISO 230-4): radial deviations of a ball bar or a grid plate over the angle.

The bar measures how much farther from the centre the tool is than programmed: actual minus nominal.
A controller that assumes the nominal machine sees the circle displaced by the negative of that
along the radius, so a deviation in the file gets the opposite sign here.

Reference:
    ISO 230-4 (circular tests for numerically controlled machine tools).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from matstd.importers.sheets import ANGLES, MM, Sheet, strokes
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Axis, Chain, linear_directions, make_chain
from matstd.twin.record import Instrument, Labels, Run, Setup, at_poses
from matstd.twin.rows import stacked
from matstd.twin.units import MINUTE

PAUSE_BETWEEN_RUNS = 10.0  # assumed pause between two runs, s
ANGLE_BEFORE_READING = 1e-6  # angle (rad) before a reading at which its axes were still moving
RADIUS_TOLERANCE = 0.1
"""A column holds radii if its mean differs from the radius by less than this share of it."""

Order = tuple[IntArray, Labels, IntArray]
"""Sense and name of the run of every row, and the rows in the order in which they were taken."""

_ANGLE = re.compile(r"angle|winkel|theta|θ|\bphi\b|φ|azimut", re.IGNORECASE)
_RUN = re.compile(r"\brun|lauf|direction|richtung|sense|\bdir\b|drehsinn", re.IGNORECASE)
_CCW = re.compile(r"ccw|anti|counter|gegen|\bg0?3\b|\+", re.IGNORECASE)
_CW = re.compile(r"cw|clockwise|uhrzeiger|im uhr|\bg0?2\b|-", re.IGNORECASE)
_DEVIATION = re.compile(r"dev|radial|radius|error|abweich|fehler|δ|delta|\bdr", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class CircularTest:
    """Readings of a circular test in the order in which they were taken."""

    plane: str  # letters of its two axes; angles count from the first to the second
    radius: float  # nominal, mm
    angle: Array  # (N,), rad
    deviation: Array  # actual minus nominal radius, (N,), mm
    sense: IntArray  # 1 from the first axis to the second, -1 back, (N,)
    run: Labels  # name of the run, (N,)
    line: IntArray  # line of the file, (N,)


def read_circle(sheet: Sheet, plane: str, radius: float, unit: str | None = None) -> CircularTest:
    """A circular test from a table: one row per reading, or per angle with columns of runs.

    Places `X` and `Y` from the centre, as of a grid plate, may stand for angles and deviations.
    Runs are those of a column of directions, or of columns named for theirs (CCW, CW, G3, G2,
    gegen, im Uhrzeigersinn), else of angles that rise or fall.

    Args:
        plane: `XY`, `ZX` ...: angles count from the first axis to the second.
        radius: Nominal radius, mm.
        unit: Unit of deviations whose column names none.

    Raises:
        BadFile: No such columns, a unit or a direction that is not stated.
    """
    at = sheet.find(_ANGLE)
    letters = (re.compile(rf"(?<![a-zA-Z]){c}(?![a-zA-Z])", re.IGNORECASE) for c in plane)
    places = [i for i in map(sheet.find, letters) if i is not None]
    if at is None and len(places) < 2:
        raise sheet.lacking("a column of angles, or of both coordinates")
    if at is None:
        x, y = (sheet.quantity(i, MM, "mm") for i in places)
        # rows of places are in the order of time, those of a table over angles need not be
        angle, all_rows = np.arctan2(y, x), np.arange(len(sheet))
        found = [(np.hypot(x, y) - radius, (*_by_motion(angle), all_rows))]
    else:
        angle = sheet.quantity(at, ANGLES, "deg")
        found = _columns(sheet, at, angle, radius, unit)
    parts = []
    for deviation, (sense, run, order) in found:
        rows = order[np.isfinite(deviation + angle)[order]]
        test = CircularTest(
            plane=plane,
            radius=radius,
            angle=angle[rows],
            deviation=deviation[rows],
            sense=sense[rows],
            run=run[rows],
            line=np.array(sheet.lines)[rows],
        )
        parts.append(test)
    return stacked(parts)


def _columns(
    sheet: Sheet, at: int, angle: Array, radius: float, unit: str | None
) -> list[tuple[Array, Order]]:
    """Deviations of every column that holds some, with the order of their rows."""
    others = [i for i in range(len(sheet.columns)) if i != at]
    said = next((i for i in others if _states_sense(sheet, i)), None)
    values = [i for i in others if i != said and _is_value(sheet, i)]
    if not values:
        raise sheet.lacking("a column of radial deviations")
    out = []
    for i in values:
        reading = sheet.quantity(i, MM, unit)
        if abs(float(np.nanmean(reading)) - radius) < RADIUS_TOLERANCE * radius:
            reading = reading - radius
        out.append((reading, _order(sheet, i, angle, said, len(values) > 1)))
    return out


def _by_motion(angle: Array) -> tuple[IntArray, Labels]:
    """Sense and name of the run of every row, by angles that rise or fall."""
    sense, stroke = strokes(np.unwrap(angle))
    sense[sense == 0] = sense[sense != 0][0] if sense.any() else 1
    return sense, np.array([f"run{k}" for k in stroke])


def _states_sense(sheet: Sheet, column: int) -> bool:
    """Whether a column states the sense of rotation of every row."""
    words = {t for t in sheet.cells_as_text(column) if t}
    return bool(_RUN.search(sheet.names[column])) and bool(words) and all(map(_sense, words))


def _is_value(sheet: Sheet, column: int) -> bool:
    """Whether a column holds deviations, or radii."""
    cells = [row[column] for row in sheet.cells if row[column] != ""]
    name = sheet.names[column]
    is_number = bool(cells) and all(isinstance(c, float) for c in cells)
    return is_number and bool(_DEVIATION.search(name) or _sense(name))


def _sense(word: str) -> int:
    """1 counter-clockwise, -1 clockwise, 0 for any other word."""
    if word in ("1", "-1"):
        return int(word)
    return 1 if _CCW.search(word) else -1 if _CW.search(word) else 0


def _order(
    sheet: Sheet, column: int, angle: Array, said: int | None, is_one_of_several: bool
) -> Order:
    """The order of the rows of one column; raises BadFile where its name must state it."""
    n = len(sheet)
    order, sense = np.arange(n), _sense(sheet.names[column])
    if said is not None:
        words = sheet.text(said)
        return np.array([_sense(w) for w in words], dtype=np.int64), np.array(words), order
    if sense:
        is_rising = float(np.nanmedian(np.diff(angle))) > 0.0
        # a table over rising angles holds a clockwise run backwards
        order = order if is_rising == (sense > 0) else order[::-1]
        return np.full(n, sense), np.full(n, sheet.names[column]), order
    if is_one_of_several:
        found = f"column {sheet.columns[column]!r}"
        raise BadFile(sheet.path, "header", found, "CCW or CW in the names of several runs")
    return *_by_motion(angle), order


class CircleParameter(NamedTuple):
    """A number of a circular test with its standard uncertainty, rad, a ratio or mm."""

    name: str
    value: float
    u: float


def circle_parameters(test: CircularTest) -> list[CircleParameter]:
    """Squareness, scales and reversals, if these and the centre are all that acts.

    Least squares of ``r = R (a cos^2 + b sin^2 - c sin cos) + d cos + e sin + (f sgn(v_1) cos +
    g sgn(v_2) sin) / 2`` with scales a and b, squareness c (positive where the angle between the
    positive axes exceeds 90 degrees), centre (d, e), reversals f and g, and the velocities v of the
    axes. Every other error of a component adds to the residual, and so to the uncertainties.

    Reference:
        ISO 230-4.
    """
    # readings at which an axis reverses belong to neither of its ways
    moves = np.abs(np.sin(2.0 * test.angle)) > ANGLE_BEFORE_READING
    angle, sense, R = test.angle[moves], test.sense[moves], test.radius
    cos, sin, deviation = np.cos(angle), np.sin(angle), test.deviation[moves]
    ways = np.sign(-sin * sense), np.sign(cos * sense)
    A = np.column_stack(
        [-R * sin * cos, R * cos**2, R * sin**2, 0.5 * ways[0] * cos, 0.5 * ways[1] * sin, cos, sin]
    )
    if np.linalg.matrix_rank(A) < A.shape[1] or len(A) <= A.shape[1]:
        return []  # an arc, or readings that are too few
    value, *_ = np.linalg.lstsq(A, deviation, rcond=None)
    left = deviation - A @ value
    scatter = float(left @ left) / (len(A) - A.shape[1])
    u = np.sqrt(scatter * np.diag(np.linalg.inv(A.T @ A)))
    names = (
        f"squareness of {test.plane[0]} and {test.plane[1]}",
        *(f"scale of {a}" for a in test.plane),
        *(f"reversal of {a}" for a in test.plane),
    )
    return [CircleParameter(*one) for one in zip(names, value, u, strict=False)]


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
        u: Standard uncertainty of one reading, mm.
        centre: Readings of X, Y and Z at the centre of the circle, mm.
        feed: Along the path, mm/min: times of the rows follow from it; None leaves them 0.
        bar_force: Force of a loaded bar that pushes the tool outwards, N; negative pulls.

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
    # at a quadrant an axis has not reversed yet
    before = test.angle - ANGLE_BEFORE_READING * test.sense
    turned = np.column_stack([-np.sin(before), np.cos(before)]) * test.sense[:, None]
    approach[:, [first, second]] = np.sign(turned)
    D = linear_directions(chain, at_centre)
    columns = [chain.linear_axes.index(letter) for letter in test.plane]
    normal = np.einsum("nij,nj->ni", D[:, :, columns], around)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    touches = replace(
        at_poses(chain, q, 0.0),
        normal=normal,
        setups=(Setup("a"),),
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
    took[changes] = PAUSE_BETWEEN_RUNS
    return np.asarray(np.cumsum(took))
