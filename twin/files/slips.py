"""Values of a file that a mistake explains: a number in another unit, a table beside its axis.

Every key states its unit in its name, and a usual value as its default or its example. One rule
holds for all keys; a key without a usual value is asked about only where the numbers are whole in
another unit. Of a machine the values are compared with one another.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from matstd.twin.errors import BadFile, BadValue
from matstd.twin.files.keys import unit_of
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Link
from matstd.twin.text import toml_value
from matstd.twin.units import DEG, LENGTHS, TOOL_LENGTHS, in_another_unit, meant_in_radians

SHORTEST_TRAVEL = 5.0
"""A linear axis travels farther, mm; the smallest machining centres travel 20 mm. A travel in
metres is at most 5 or so."""
LONGEST_TRAVEL = 1e5  # no linear axis travels farther, mm; a travel of 300 mm in micrometres does
ROTARY_LETTERS, ALONG_ITS_LETTER = "ABC", 0.1
"""Rotary axes about X, Y and Z, and the least part of their lines along these (ISO 841); that of
inclined axes is half or more."""
ROOM = 500.0
"""A pivot lies at most so far beyond the box of all travels and the table, and their width, mm."""
NEAREST_PIVOT, FARTHEST_PIVOT = 0.05, 5.0
"""A coordinate of a pivot between these, mm, may be one in metres: 0.42 for 420 mm. Measured
centres of rotation differ from zero by hundredths of a millimetre."""
LONGEST_IN_METRES = 5e3  # in mm: no pivot lies farther
MOST_BELOW = 0.5  # share of the travel of the gauge point that may lie below the table's face
LEAST_AWAY = 50.0  # of a table from the line about which it turns, before that is strange, mm
SMALLER = 5.0
"""Times by which a travel is smaller than all others before it may be one in centimetres; of the
machines that come with this program the smallest travel is 0.4 of the next."""
FARTHEST_TABLE, TRAVELS_AWAY = 400.0, 3.0
"""Distance of the table's centre from the travels, mm, up to which a probe with a standard bridges
it; and in travels, from which on these are in centimetres."""
FARTHEST_BESIDE = 100.0  # of a table's line beside the travels across the tool, mm
OFF_CENTRE = 5.0
"""Distance of the centre of a table from the line about which it turns, mm; centres are known to
tenths."""
NEARLY_QUARTER = 1e-6  # of quarters of a degree
NEARER = 4.0
"""Times that a pivot in metres is nearer to the table, or farther from the spindle, once read so;
only then is it one."""


def refuse_unit_slips(
    table: BaseModel,
    path: str | Path,
    questions: Iterable[BadFile] = (),
    confirmed: Collection[str] = (),
) -> None:
    """Refuse a file with numbers that were typed in another unit, or look like a mistake.

    Args:
        questions: What else is asked about values of the file.
        confirmed: Keys whose values are meant: those questions are answered.

    Raises:
        BadFile: All of them, with what each was taken for; a confirmed key that is not asked about.
    """
    if slips := list(_slips(table, path, "")):
        raise BadFile.several(slips)
    asked: dict[str, BadFile] = {}
    for one in questions:
        asked.setdefault(str(one.facts["where"]), one)
    for key in confirmed:
        if key not in asked:
            expected = f"keys that are asked about: {', '.join(asked) or 'none is'}"
            raise BadFile(path, "confirmed", repr(key), expected)
    left = [
        BadFile(path, where, one.facts["found"], f"{one.facts['expected']} ({_meant(where)})")
        for where, one in asked.items()
        if where not in confirmed
    ]
    if left:
        raise BadFile.several(left)


def _meant(key: str) -> str:
    return f"if it is meant: confirmed = {toml_value([key])}"


def _slips(table: BaseModel, path: str | Path, within: str) -> Iterator[BadFile]:
    """Those of a table under a key."""
    for name, field in type(table).model_fields.items():
        if name in table.model_fields_set:
            key = field.alias or name
            where = f"{within}.{key}" if within else key
            yield from _slips_of(getattr(table, name), field, key, path, where)


def _slips_of(
    value: Any, field: FieldInfo, key: str, path: str | Path, where: str
) -> Iterator[BadFile]:
    """Of one value: numbers, or tables with keys of their own."""
    if isinstance(value, BaseModel):
        yield from _slips(value, path, where)
    elif isinstance(value, dict):
        for name, inner in value.items():
            yield from _slips_of(inner, field, key, path, f"{where}.{name}")
    elif isinstance(value, list) and all(isinstance(inner, BaseModel) for inner in value):
        for i, inner in enumerate(value):
            yield from _slips(inner, path, f"{where}.{i}")
    elif numbers := _numbers(value):
        unit, usual = unit_of(key), _usual(field)
        other = in_another_unit(numbers, unit, usual)
        if other is not None:
            name, size = other
            meant = f"{_listed([size * v for v in numbers])} {unit}"
            about = "" if usual is None else f", usually about {usual:g}"
            expected = f"{unit}{about}; is it in {name}, {meant}?"
            yield BadFile(path, where, _listed(numbers), expected)


def _numbers(value: Any) -> list[float]:
    """The numbers of a value; none of anything else, or of a table of numbers."""
    values = value if isinstance(value, tuple | list) else [value]
    is_number = [isinstance(v, int | float) and not isinstance(v, bool) for v in values]
    return list(values) if values and all(is_number) else []


def _usual(field: FieldInfo) -> float | None:
    """The usual value of a key, the largest of several: its default, or its example."""
    for said in (field.default, *(field.examples or ())):
        if (numbers := _numbers(said)) and 0.0 < max(numbers) < float("inf"):
            return max(numbers)
    return None


def _listed(values: Sequence[float]) -> str:
    """As in a file."""
    texts = [f"{v:.4g}" for v in values]
    return f"[{', '.join(texts)}]" if len(texts) > 1 else texts[0]


def machine_slips(chain: Chain) -> Iterator[BadValue]:
    """Values of a machine that a slip of units or digits explains, and no machine has."""
    for link in chain.links:
        if link.kind != "fixed" and link.programmed:
            yield from _travel(chain, link)
    if len(chain.linear_axes) == 3:  # an arm states its joints one by one
        yield from _table(chain)
        for link in chain.links:
            if link.kind == "rotary" and link.programmed:
                yield from _letter(link)
                yield from _pivot(chain, link)


def machine_questions(chain: Chain, is_placed: bool = True) -> Iterator[BadValue]:
    """Values that a mistake explains, and few machines have: the file may confirm them.

    Args:
        is_placed: Whether the place of the table is stated.
    """
    if len(chain.linear_axes) == 3:
        placed = (_far_table, _mirrored_pivot, _table_off_centre) if is_placed else ()
        rules = (_small_turn, _small_travel, *placed, _line_beside_travels)
        # what a rule finds explains what the later ones would
        yield from next(filter(None, (list(rule(chain)) for rule in rules)), [])


def _travel(chain: Chain, link: Link) -> Iterator[BadValue]:
    """Travels in metres and in radians; the one linear axis of a test bench may travel 2 mm."""
    low, high = link.range
    key = f"axis.{link.name}.range"
    is_bench = len(chain.linear_axes) == 1
    if link.kind == "linear" and not is_bench and 0.0 < high - low < SHORTEST_TRAVEL:
        found = f"{_pair(low, high)}, a travel of {high - low:.4g} mm"
        yield BadValue(key, found, f"mm; is it in metres, {_pair(1e3 * low, 1e3 * high)}?")
    if link.kind == "linear" and high - low > LONGEST_TRAVEL:
        found = f"{_pair(low, high)}, a travel of {1e-3 * (high - low):.4g} m"
        yield BadValue(key, found, f"mm; is it in µm, {_pair(1e-3 * low, 1e-3 * high)}?")
    if link.kind == "rotary":
        meant = meant_in_radians(low / DEG, high / DEG)
        if meant is not None:
            found = f"{_pair(low / DEG, high / DEG)}, a travel of {(high - low) / DEG:.3g} degrees"
            yield BadValue(key, found, f"degrees; is it in radians, {_pair(*meant)}?")


def _letter(link: Link) -> Iterator[BadValue]:
    """Rotary axes whose line is square to that of their letter."""
    parts = np.abs(link.direction) / np.linalg.norm(link.direction)
    if link.name not in ROTARY_LETTERS or parts[ROTARY_LETTERS.index(link.name)] > ALONG_ITS_LETTER:
        return
    along, turns = "XYZ"[ROTARY_LETTERS.index(link.name)], ROTARY_LETTERS[int(np.argmax(parts))]
    expected = f"a part along {along}, which {link.name} turns about; is it {turns}?"
    yield BadValue(f"axis.{link.name}.direction", _list(link.direction), expected)


def _pivot(chain: Chain, link: Link) -> Iterator[BadValue]:
    """Lines of rotary axes outside the machine, and in metres."""
    key = f"axis.{link.name}.point"
    low, high = _box(chain)
    point = _across(link.point, link)
    outside = np.maximum(low - point, point - high)
    outside[np.abs(point) < ROOM] = 0.0
    room = ROOM + float(np.max(high - low))
    if outside.max() > room:
        axis = int(np.argmax(outside))
        found = f"{_list(link.point)}, {outside[axis]:.0f} mm outside the travels along "
        yield BadValue(key, found + "XYZ"[axis], "a point within the machine, in mm")
    largest = float(np.abs(point).max())
    if not NEAREST_PIVOT < largest < FARTHEST_PIVOT or 1e3 * largest > LONGEST_IN_METRES:
        return
    mm = _list(1e3 * link.point)
    if link.carries_workpiece:
        table = _across(chain.table_origin, link)
        away = np.linalg.norm(table - point), np.linalg.norm(table - 1e3 * point)
        if away[0] > NEARER * away[1]:
            expected = f"mm, a point near the table at {_list(chain.table_origin)}"
            yield BadValue(key, _list(link.point), f"{expected}; is it in metres, {mm}?")
    elif abs(link.direction[2]) < 0.5:  # a head turns about a line far above the gauge point
        expected = "mm, a point tens of millimetres from the gauge point"
        yield BadValue(key, _list(link.point), f"{expected}; is it in metres, {mm}?")


def _table(chain: Chain) -> Iterator[BadValue]:
    """A table in metres: most travel of the gauge point lies below, or its line is far away."""
    origin, mm = chain.table_origin, 1e3 * chain.table_origin
    if not NEAREST_PIVOT < np.abs(origin).max() < FARTHEST_PIVOT:
        return
    low, high = _travels(chain)
    below = [(o[2] - low[2]) / max(high[2] - low[2], SHORTEST_TRAVEL) for o in (origin, mm)]
    is_above = below[0] > MOST_BELOW > below[1]
    lines, both = _table_axes(chain), (origin, mm)
    away = [[np.linalg.norm(_across(o - k.point, k)) for o in both] for k in lines]
    is_far = any(stated > NEARER * meant and stated > LEAST_AWAY for stated, meant in away)
    if is_above or is_far:
        expected = f"mm, the centre of the table's face; is it in metres, {_list(mm)}?"
        yield BadValue("workpiece.origin", _list(origin), expected)


def _small_turn(chain: Chain) -> Iterator[BadValue]:
    """A travel of whole degrees if read as radians; small ones that are meant end in quarters."""
    for link in (k for k in chain.links if k.kind == "rotary" and k.programmed):
        ends = np.array(link.range) / DEG
        low, high = ends.tolist()
        meant = meant_in_radians(low, high, whole=1.0)
        if meant is not None and np.abs(4.0 * ends - np.round(4.0 * ends)).max() > NEARLY_QUARTER:
            expected = f"degrees; is it in radians, {_pair(*meant)}?"
            yield BadValue(f"axis.{link.name}.range", _pair(*ends), expected)


def _small_travel(chain: Chain) -> Iterator[BadValue]:
    """A travel in centimetres beside others in mm."""
    travels = {name: float(np.ptp(chain.link(name).range)) for name in chain.linear_axes}
    for name, travel in travels.items():
        least = min(size for other, size in travels.items() if other != name)
        if SHORTEST_TRAVEL <= travel < least / SMALLER:
            yield _in_centimetres(chain, name, f"beside {least:g} mm of the next axis")


def _in_centimetres(chain: Chain, name: str, beside: str) -> BadValue:
    """The question whether a travel is in centimetres, or in inches."""
    low, high = chain.link(name).range
    found = f"{_pair(low, high)}, a travel of {high - low:.4g} mm {beside}"
    mm = dict(LENGTHS)
    cm, inches = (_pair(mm[unit] * low, mm[unit] * high) for unit in ("cm", "inches"))
    expected = f"mm; is it in inches, {inches}, or in cm, {cm}?"
    return BadValue(f"axis.{name}.range", found, expected)


def _far_table(chain: Chain) -> Iterator[BadValue]:
    """A table that no tool reaches: its place, travels in centimetres, or of the other sign."""
    low, high = _travels(chain)
    origin = chain.table_origin
    outside = np.maximum(low - origin, origin - high)
    axis = int(np.argmax(outside))
    if (away := float(outside[axis])) <= FARTHEST_TABLE:
        if high[2] - origin[2] < TOOL_LENGTHS[0]:
            found = f"{_list(origin)}, with Z up to {high[2]:.6g}"
            expected = "a table's face above which a tool has room"
            yield BadValue("workpiece.origin", found, expected)
        return
    small = [a for a in chain.linear_axes if TRAVELS_AWAY * np.ptp(chain.link(a).range) < away]
    if any(abs(chain.link(a).direction[axis]) > 0.5 for a in small):
        words = f"and a table {away:.0f} mm beyond"
        yield from (_in_centimetres(chain, name, words) for name in small)
        return
    for name in chain.linear_axes:
        link = chain.link(name)
        low_end, high_end = np.sort(np.negative(link.range) * link.direction[axis])
        is_mirrored = low_end - FARTHEST_TABLE <= origin[axis] <= high_end + FARTHEST_TABLE
        if abs(link.direction[axis]) < 0.5 or not is_mirrored:
            continue
        beside = f"{_pair(*link.range)}, {away:.0f} mm from the table"
        if link.direction[link.own] < 0.0:
            found = f"{_list(link.direction)}, with the range {beside}"
            meant = _list(0.0 - link.direction)
            expected = f"the motion of the tool relative to the workpiece; is it {meant}?"
            yield BadValue(f"axis.{name}.direction", found, expected)
            return
        if link.carries_workpiece:
            meant = _pair(0.0 - link.range[1], 0.0 - link.range[0])
            expected = f"readings that move the tool relative to the workpiece; is it {meant}?"
            yield BadValue(f"axis.{name}.range", beside, expected)
            return
    found = f"{_list(origin)}, {away:.0f} mm beyond the travel along {'XYZ'[axis]}"
    yield BadValue(
        "workpiece.origin", found, "the centre of the table's face, within the reach of a tool"
    )


def _table_off_centre(chain: Chain) -> Iterator[BadValue]:
    """A table whose centre, seen along the tool, lies beside the line about which it turns."""
    if (link := next(_table_axes(chain), None)) is None:
        return
    away = chain.table_origin - link.point
    across = np.cross(link.direction, [0.0, 0.0, 1.0])
    square = float(np.linalg.norm(across))  # sine of the angle between line and tool
    off = abs(away @ across) / square if square > 0.1 else np.linalg.norm(_across(away, link))
    if off > OFF_CENTRE and link.name in chain.assumed_points:
        found = f"none, which puts the line of {link.name} {off:.4g} mm off the table's centre"
        expected = "a point on its line, mm, machine frame, every axis at zero"
        yield BadValue(f"axis.{link.name}.point", found, expected)
    elif off > OFF_CENTRE:
        found = f"{_list(chain.table_origin)}, {off:.4g} mm off the line of {link.name}"
        expected = f"the centre of the table's face, on that line, through {_list(link.point)}"
        yield BadValue("workpiece.origin", found, expected)


def _table_axes(chain: Chain) -> Iterator[Link]:
    return (k for k in chain.links if k.kind == "rotary" and k.carries_workpiece and k.programmed)


def _line_beside_travels(chain: Chain) -> Iterator[BadValue]:
    """A line of a table far beside it and a travel, across line and tool: no tool bridges that."""
    low, high = _box(chain)
    for link in _table_axes(chain):
        outside = np.maximum(low - link.point, link.point - high)[:2]
        outside[np.abs(link.direction[:2]) > ALONG_ITS_LETTER] = 0.0
        if (away := outside.max()) > FARTHEST_BESIDE and link.name not in chain.assumed_points:
            found = f"{_list(link.point)}, {away:.0f} mm outside the travels along "
            expected = "a line that the spindle reaches, in mm"
            yield BadValue(f"axis.{link.name}.point", found + "XY"[outside.argmax()], expected)


def _mirrored_pivot(chain: Chain) -> Iterator[BadValue]:
    """A line of the other sign: far from the table that it turns, or below the spindle of a head.

    With every axis at zero a head turns about a line above the gauge point, and a table lies nearer
    to its line than to the mirrored one.
    """
    last = max((i for i, k in enumerate(chain.links) if k.kind == "linear"), default=-1)
    for i, link in enumerate(chain.links):
        if link.kind != "rotary" or not link.programmed:
            continue
        meant = np.where(np.arange(3) == np.argmax(np.abs(link.point)), -link.point, link.point)
        ends = np.array([_across(point, link) for point in (link.point, meant)])
        if link.carries_workpiece:
            away = np.linalg.norm(ends - _across(chain.table_origin, link), axis=1)
            is_mirrored = away[0] > max(NEARER * away[1], FARTHEST_TABLE)
            words, other = f"near the table at {_list(chain.table_origin)}", ""
        else:
            is_mirrored = i > last and ends[0, 2] < -LEAST_AWAY and not ends[:, :2].any()
            words = "above the gauge point of the spindle"
            other = f" Or does {link.name} turn the table, {link.name}'?"
        if is_mirrored:
            expected = f"a point {words}, every axis at zero; is it {_list(meant)}?{other}"
            yield BadValue(f"axis.{link.name}.point", _list(link.point), expected)


def _across(point: Array, link: Link) -> Array:
    """A point without its part along the line of an axis, (3,), mm."""
    along = link.direction / np.linalg.norm(link.direction)
    return np.asarray(point - (point @ along) * along)


def _box(chain: Chain) -> tuple[Array, Array]:
    """Smallest and largest coordinates of all that the tool reaches and of the table, mm."""
    low, high = _travels(chain)
    return np.minimum(low, chain.table_origin), np.maximum(high, chain.table_origin)


def _travels(chain: Chain) -> tuple[Array, Array]:
    """Smallest and largest coordinates of the gauge point, rotary axes at zero, mm."""
    low, high = np.zeros(3), np.zeros(3)
    for name in chain.linear_axes:
        link = chain.link(name)
        ends = np.outer(link.range, link.direction)
        low, high = low + ends.min(axis=0), high + ends.max(axis=0)
    return low, high


def _pair(low: float, high: float) -> str:
    return _list(np.array([low, high]))


def _list(values: Array) -> str:
    return f"[{', '.join(f'{v:.6g}' for v in values)}]"
