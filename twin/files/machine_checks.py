"""Slips of units and digits in a machine file: values that no machine has, with what was meant.

Only what a slip explains and a machine does not is refused; each rule states its limits.
"""

from collections.abc import Iterator

import numpy as np

from matstd.twin.errors import BadValue
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Link
from matstd.twin.units import DEG, meant_in_radians

SHORTEST_TRAVEL = 5.0
"""A linear axis travels farther, mm; the smallest machining centres travel 20 mm. A travel in
metres is at most 5 or so."""

LONGEST_TRAVEL = 1e5
"""No linear axis travels farther, mm; a travel of 300 mm in micrometres does."""

ALONG_ITS_LETTER = 0.1
"""Least part of the line of A, B or C along X, Y or Z (ISO 841); inclined axes have half of it."""

ROOM = 500.0
"""A pivot lies at most so far beyond the box of all travels and the table, and their width, mm."""

NEAREST_PIVOT, FARTHEST_PIVOT = 0.05, 5.0
"""A coordinate of a pivot between these, mm, may be one in metres: 0.42 for 420 mm. Measured
centres of rotation differ from zero by hundredths of a millimetre."""

ROTARY_LETTERS = "ABC"
"""Rotary axes about X, Y and Z."""

LONGEST_IN_METRES = 5e3
"""In mm: no pivot lies farther."""

NEARER = 4.0
"""Times that a pivot in metres is nearer to the table, or farther from the spindle, once read so;
only then is it one."""


def machine_slips(chain: Chain) -> Iterator[BadValue]:
    """Values of a machine that a slip of units or digits explains, and no machine has."""
    for link in chain.links:
        if link.kind != "fixed" and link.programmed:
            yield from _travel(chain, link)
    if len(chain.linear_axes) == 3:  # an arm states its joints one by one
        for link in chain.links:
            if link.kind == "rotary" and link.programmed:
                yield from _letter(link)
                yield from _pivot(chain, link)


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


def _across(point: Array, link: Link) -> Array:
    """A point without its part along the line of an axis, (3,), mm."""
    along = link.direction / np.linalg.norm(link.direction)
    return np.asarray(point - (point @ along) * along)


def _box(chain: Chain) -> tuple[Array, Array]:
    """Smallest and largest coordinates of all that the tool reaches and of the table, mm."""
    low = np.minimum(0.0, chain.table_origin)
    high = np.maximum(0.0, chain.table_origin)
    for name in chain.linear_axes:
        link = chain.link(name)
        ends = np.outer(link.range, link.direction)
        low, high = low + ends.min(axis=0), high + ends.max(axis=0)
    return low, high


def _pair(low: float, high: float) -> str:
    return _list(np.array([low, high]))


def _list(values: Array) -> str:
    return f"[{', '.join(f'{v:.6g}' for v in values)}]"
