"""Tests of one axis (ISO 230-2, ISO 230-1): targets, cycles, both directions of approach.

The instrument (laser interferometer, autocollimator, encoder) measures the true motion of the axis:
``actual - target``, tool relative to workpiece, which is the component error of the axis. A
controller that assumes the nominal machine sees the surface displaced by the negative of that along
the direction of motion, so a deviation in the file gets the opposite sign here.

Reference:
    ISO 230-2:2014, clauses 3 and 5 (terms, target positions, cycles).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.importers.sheets import (
    ANGLES,
    MM,
    TIME,
    Sheet,
    approaches,
    bare,
    seconds,
    sign_of,
    signs,
    strokes,
    temperatures,
    unit_of_column,
)
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray
from matstd.twin.rows import picked, stacked

SLOPE_TOLERANCE = 0.1
"""Values with a slope over the targets within this of 1 are positions: no axis is wrong by a
tenth."""

_TARGET = re.compile(
    r"target|tgt|soll|nominal|command|set ?p(oin)?t|position|cible|consigne|\bp_?i\b", re.IGNORECASE
)
_ACTUAL = re.compile(r"actual|measured|ist\b|\bist|réel|mesur", re.IGNORECASE)
_REFERENCE = re.compile(r"reference\Z|\bref(_pos)?\Z", re.IGNORECASE)
"""Column of the reference instrument in tables of two; a `reference position` is a target."""
_DEVIATION = re.compile(r"dev|error|abweich|fehler|écart|erreur|\bx_?ij\b", re.IGNORECASE)
_ASIDE = re.compile(
    r"straight|gerad|rectitud|pitch|yaw|roll\b|angle|tilt|winkel|neig|nick|gier|roulis|tangage|"
    r"lacet|\be[a-cx-z][x-z]\b",
    re.IGNORECASE,
)
"""Names of columns of straightness and angular errors."""
_CYCLE = re.compile(
    r"cycle|run\b|zyklus|lauf\b|\bj\b|\brep(lica\w*|eat\w*|etition\w*)?\b|trial|pass\b|wiederhol|essai",
    re.IGNORECASE,
)
_COMPUTED = re.compile(
    r"\bmean|\bavg|average|mittel|moyen|\bst(an)?d(ard)?\b|estimat|sigma|σ|[±+-]\s*[2-4]\s*[\*·]?\s*s|"
    r"\b[2-4]\s*s\b|\bs\b|\brepeatab|wiederholbar|streu|\brange\b|spann|revers(al|ib)|umkehr|"
    r"\b[bmera](_?i)?\b|\bu\b|uncert|unsicher|\bmin\b|\bmax\b",
    re.IGNORECASE,
)
"""Names of columns that reports compute from the readings."""
_DIRECTION = re.compile(r"dir|richtung|approach|anfahr", re.IGNORECASE)
_WAY_OUT = re.compile(r"\b(up|forward|fwd|vorwärts|hin)\b", re.IGNORECASE)
_WAY_BACK = re.compile(r"\b(down|backward|bwd|reverse|rückwärts|zurück)\b", re.IGNORECASE)
_NUMBER = re.compile(r"\d+")
_BRACKETS = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]")
_ALONE = re.compile(
    r"(up|down|fwd|bwd|rev|forward|backward|reverse|vor|rück|zurück|hin|aller|retour|pos|neg|[-+↑↓])"
    r"(wards?|wärts)?\Z",
    re.IGNORECASE,
)
"""A direction alone, where there is one cycle."""
_AT_AND_WAY = re.compile(r"([+-]?\d+(?:[.,]\d*)?)\s*([^\d\s]*)\Z")
"""Name of a column made of a target and the direction below it, as in `50 ↓`."""
_MAX_DIGITS = 9  # digits of the number of a cycle


@dataclass(frozen=True, eq=False)
class PositioningTest:
    """Readings of a positioning test, one entry per reading."""

    axis: str
    target: Array  # commanded position, (N,), mm or rad
    deviation: Array  # actual minus target, (N,), mm or rad
    cycle: IntArray  # number of the cycle, (N,)
    direction: IntArray  # 1 where the target was reached with a growing reading, -1 else, 0 unknown
    line: IntArray  # line of the file, (N,)
    time: Array | None = None  # since the start of a log, (N,), s; None of a table
    # by sensor, each (N,), degC; of a log
    temperature: Mapping[str, Array] = field(default_factory=dict)
    is_by_order: bool = False  # whether directions are those in which the rows follow each other
    component: str = ""  # component error that was measured, such as EYX; "" of positioning

    @property
    def is_own(self) -> bool:
        """Whether the test is of positioning, not of straightness or tilt."""
        return _is_own(self.axis, self.component)

    @property
    def is_log(self) -> bool:
        """Whether its readings have times."""
        return self.time is not None and bool(np.any(self.time))

    @property
    def is_angle(self) -> bool:
        """Whether deviations are angles."""
        return _is_angle(self.axis, self.component)


def _is_own(axis: str, component: str) -> bool:
    return component in ("", f"E{axis}{axis}")


def _is_angle(axis: str, component: str) -> bool:
    return (axis if _is_own(axis, component) else component[1]) in "ABC"


def read_positioning(
    sheet: Sheet,
    axis: str,
    unit: str | None = None,
    named: tuple[str, str] = ("", ""),
    component: str = "",
) -> PositioningTest:
    """A positioning test from a table.

    Two layouts are read: one row per reading (columns target, cycle, direction, and deviation or
    actual position), and one row per target with one column per cycle and direction (`1 up`, `1
    down`, or the cycle in one header row and the direction in the next). With a column of times the
    first is a log: cycles are its strokes, directions those of its motion. Without columns of
    directions or cycles the order of the rows gives them.

    Args:
        axis: Letter of the axis, which says whether it turns (A B C).
        unit: Unit of deviations whose column names none.
        named: Names of the columns of targets and of actual positions, where the words of the
            header do not show them, as in a log of two encoders; empty otherwise.
        component: Component error that was measured, such as EYX or EBX; "" for positioning.

    Raises:
        BadFile: No column of targets or deviations, a unit that is not stated.
    """
    upright = _upright(sheet)
    is_turned, sheet = upright is not sheet, upright
    target = sheet.column(named[0]) if named[0] else sheet.find(_TARGET, _ACTUAL, _DEVIATION)
    if target is None:
        raise sheet.lacking("a column of targets, or its name by --target (and --actual)")
    turns = axis in "ABC"
    at = sheet.quantity(target, ANGLES if turns else MM, "deg" if turns else "mm")
    units = ANGLES if _is_angle(axis, component) else MM
    column, is_position = _readings(sheet, target, named[1], _is_own(axis, component))
    if column is None or (is_turned and _NUMBER.search(sheet.names[column])):
        return _without_gaps(sheet, stacked(_wide(sheet, axis, component, target, at, unit)))
    deviation = sheet.quantity(column, units, unit)
    cycle, clock = map(sheet.find, (_CYCLE, TIME))
    direction = sheet.find(_DIRECTION, _COMPUTED)
    sign, stroke = (
        approaches(_filled_forward(at)) if clock is None else strokes(_filled_forward(at))
    )
    # words above the parts of a table are surer than the order of its rows
    parted = _ways_of_parts(sheet)
    if clock is None and np.any(parted):
        sign = parted
    test = PositioningTest(
        axis=axis,
        target=at,
        deviation=deviation - at if is_position else deviation,
        cycle=stroke if cycle is None else sheet.whole_numbers(cycle, "the number of a cycle"),
        direction=sign if direction is None else signs(sheet, direction),
        line=np.array(sheet.lines),
        time=None if clock is None else seconds(sheet, clock),
        temperature={} if clock is None else temperatures(sheet),
        is_by_order=direction is None and bool(np.any(sign < 0)),
        component=component,
    )
    return _without_gaps(sheet, test)


def _readings(sheet: Sheet, target: int, named: str, is_own: bool) -> tuple[int | None, bool]:
    """Column of readings, None for a table with one column per run; whether they are positions."""
    if is_own and named:
        return sheet.column(named), True
    values, actual = sheet.find(_DEVIATION, _COMPUTED), sheet.find(_ACTUAL, _COMPUTED)
    if is_own:
        actual = sheet.find(_REFERENCE) if actual is None else actual
        return (actual, True) if values is None else (values, False)
    named_aside = (i for i, name in enumerate(sheet.names) if i != target and _ASIDE.search(name))
    aside = [i for i in named_aside if not _COMPUTED.search(sheet.names[i])]
    values = next(iter(aside), actual) if values is None else values
    if named:
        return sheet.column(named), False
    return (None if len(aside) > 1 else values), False


def _filled_forward(at: Array) -> Array:
    """Targets with missing ones replaced by the last one before them, or the first."""
    there = np.isfinite(at)
    last = np.maximum.accumulate(np.where(there, np.arange(len(at)), np.argmax(there)))
    return at[last]


def _upright(sheet: Sheet) -> Sheet:
    """The table with one row per target, transposed where needed: `Target [mm], 0, 100, 200`.

    A row of directions, whose cells are words, comes with it, below the targets or among the rows.
    Names of the rows may stand in several cells: `Deviation [µm], j = 1`.
    """
    if not all(isinstance(r[0], str) for r in sheet.cells):
        return sheet
    rows = [*sheet.cells, *(row for _, row in sheet.of_words if _DIRECTION.search(str(row[0])))]
    in_header = [_AT_AND_WAY.match(name) for name in sheet.columns]
    labels = next((i for i, m in enumerate(in_header) if m), 0)
    if labels and _TARGET.search(sheet.columns[0]) and all(in_header[labels:]):
        words = ["Target", *sheet.columns[1:labels]]
        found = [m for m in in_header if m]
        rows += [(*words, *(float(m[1].replace(",", ".")) for m in found))]
        rows += [("Direction", *[""] * (labels - 1), *(m[2] for m in found))]
    elif sheet.find(_TARGET) is not None:
        return sheet
    targets = next((r for r in rows if _TARGET.search(bare(str(r[0])))), None)
    if targets is None or not any(isinstance(cell, float) for cell in targets):
        return sheet
    labels = next(i for i, cell in enumerate(targets) if isinstance(cell, float))
    sheet.used.update(range(len(sheet.columns)))
    # a target over the columns of both directions stands in the first of its merged cells
    last: str | float = ""
    filled = [last := cell if cell != "" else last for cell in targets[labels:]]
    rows = [(*targets[:labels], *filled) if row is targets else row for row in rows]
    columns = list(zip(*(row[labels:] for row in rows), strict=True))
    return replace(
        sheet,
        columns=tuple(" ".join(str(c) for c in row[:labels] if c != "") for row in rows),
        cells=tuple(columns),
        lines=(sheet.lines[0],) * len(columns),
        above=("",) * len(columns),
        used=set(),
    )


def _wide(
    sheet: Sheet, axis: str, component: str, target: int, at: Array, unit: str | None
) -> list[PositioningTest]:
    """Every column of readings of a table with a row a target."""
    units = ANGLES if _is_angle(axis, component) else MM
    parts, found = [], {}
    whole = np.ones(len(sheet), dtype=np.int64)
    column = sheet.find(_DIRECTION, _COMPUTED)
    ways = _ways_of_parts(sheet) if column is None else signs(sheet, column)
    unit = unit or _unit_within(sheet, units)
    for i, name in enumerate(sheet.names):
        number = _NUMBER.search(sheet.columns[i])
        digits = number[0] if number else "1" if _ALONE.match(name) else ""
        if i in (target, column) or not digits or _COMPUTED.search(name):
            continue
        if len(digits) > _MAX_DIGITS:
            shown = f"column {sheet.columns[i][:40]!r}"
            raise BadFile(sheet.path, "header", shown, "the number of a cycle")
        found[i] = sign_of(name.replace(digits, "", 1))
        parts.append(
            PositioningTest(
                axis=axis,
                target=at,
                deviation=_deviations(sheet, i, target, at, unit, units),
                cycle=int(digits) * whole,
                direction=found[i] * whole if found[i] else ways,
                line=np.array(sheet.lines),
                component=component,
            )
        )
    if not parts:
        expected = "a column of deviations, or a column a cycle and direction (1 up, 1 down, ...)"
        raise sheet.lacking(expected)
    # one direction without a word is one run; beside others with words it would be a guess
    unsaid = next((i for i, sign in found.items() if sign == 0), None)
    if unsaid is not None and any(found.values()):
        expected = "up or down (fwd, bwd, +, -) in its name, as in others"
        raise BadFile(sheet.path, "header", f"column {sheet.columns[unsaid]!r}", expected)
    return parts


def _unit_within(sheet: Sheet, units: dict[str, float]) -> str | None:
    """The one unit in brackets within names, as of `Deviation [µm] j = 1`; None of several."""
    inside = (_BRACKETS.search(name) for name in sheet.columns if unit_of_column(name) is None)
    found = {m[1].replace("μ", "µ") for m in inside if m} & set(units)
    return found.pop() if len(found) == 1 else None


def _ways_of_parts(sheet: Sheet) -> IntArray:
    """Signs of directions from the words above the parts of a table, 0 without any."""
    ways = [1 if _WAY_OUT.search(a) else -1 if _WAY_BACK.search(a) else 0 for a in sheet.above]
    both = {1, -1} <= set(ways)
    return np.array(ways if both else np.zeros(len(sheet)), dtype=np.int64)


def _deviations(
    sheet: Sheet, column: int, target: int, at: Array, unit: str | None, units: dict[str, float]
) -> Array:
    """Deviations of one column, which may hold actual positions: those grow as the targets do."""
    if unit is None and _is_position(sheet.numbers(column), sheet.numbers(target)):
        unit = unit_of_column(sheet.columns[target]) or ("mm" if units is MM else "deg")
    values = sheet.quantity(column, units, unit)
    return values - at if _is_position(values, at) else values


def _is_position(values: Array, at: Array) -> bool:
    """Whether values are positions: they grow as the targets do, as no deviation does."""
    rows = np.isfinite(values) & np.isfinite(at)
    if rows.sum() < 2 or not np.ptp(at[rows]) > 0.0:
        return False
    slope = np.polyfit(at[rows] - at[rows].mean(), values[rows], 1)[0]
    return abs(float(slope) - 1.0) < SLOPE_TOLERANCE


def _without_gaps(sheet: Sheet, test: PositioningTest) -> PositioningTest:
    """The test without rows that lack a target or a reading."""
    rows = np.isfinite(test.target) & np.isfinite(test.deviation)
    if not rows.any():
        raise BadFile(sheet.path, "table", "no row with a target and a reading", "one or more")
    return picked(test, rows)
