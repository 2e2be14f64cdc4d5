"""The one way in which the reports write numbers, times, units and columns of files."""

import math
import re

from matstd.twin.record import Touches
from matstd.twin.units import DAY, HOUR, MINUTE, UM, URAD

_SPANS = ((DAY, "days", 2.0), (HOUR, "h", 1.5), (MINUTE, "min", 1.5))
"""Units of time, the longest first, each with the smallest number for which it is used."""

_PLACES = {"px_mm": "x", "py_mm": "y", "pz_mm": "z"}
_NOUNS = {
    "time_s": "time",
    "spindle_rpm": "spindle speed",
    "setup": "set-up",
    "azimuth_deg": "azimuth of the normal about the tool axis",
    "inclination_deg": "angle between normal and tool axis",
    **{column: f"{letter} on the standard" for column, letter in _PLACES.items()},
    **{f"n{letter}": f"the normal's {letter}" for letter in "xyz"},
    **{f"F{letter}_N": f"load in {letter}" for letter in "xyz"},
}
_SHOWN = {"mm": ("µm", UM), "rad": ("µrad", URAD), "s": ("ms", 1e-3)}
"""Base unit -> unit of the reports, and its size in the base unit."""

_MAX_LOG10 = 12.0  # odds are not written with more zeros: beyond, their number means nothing

_UNITS = (("_mm", "mm"), ("_deg", "deg"), ("_degC", "°C"), ("_N", "N"), ("_rpm", "1/min"))

_SPELT = {"urad": "µrad", "um": "µm", "deg": "°"}  # units that reports write otherwise than files


def unit_words(unit: str) -> str:
    """A unit of the files as the reports write it.

    Example:
        >>> unit_words("um_per_K"), unit_words("um_per_m_K"), unit_words("deg"), unit_words("min")
        ('µm/K', 'µm/(m K)', '°', 'min')
    """
    above, _, below = unit.partition("_per_")
    words = _SPELT.get(above, above)
    if not below:
        return words
    return f"{words}/({below.replace('_', ' ')})" if "_" in below else f"{words}/{below}"


def digits(value: float | None, significant: int = 3) -> str:
    """A number with so many significant digits, without an exponent where it is readable.

    Example:
        >>> digits(0.012345), digits(9.996), digits(1.6e12)
        ('0.0123', '10.0', '1.60e+12')
    """
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    exponent = int(f"{value:.{significant - 1}e}".partition("e")[2])  # of the rounded number
    if not -4 <= exponent <= 6:
        return f"{value:.{significant - 1}e}"
    return f"{value:.{max(0, significant - 1 - exponent)}f}"


def with_uncertainty(value: float, u: float | None, unit: str = "") -> str:
    """A number to two digits of its uncertainty.

    Example:
        >>> with_uncertainty(11.137, 0.538, "µm")
        '11.14 ± 0.54 µm'
    """
    tail = f" {unit}" if unit else ""
    if u is None or not u > 0.0 or not math.isfinite(u):
        return f"{digits(value)}{tail}"
    places = max(0, 1 - math.floor(math.log10(u)))
    return f"{value:.{places}f} ± {u:.{places}f}{tail}"


def um(value: float, significant: int = 3) -> str:
    """A length with so many significant digits.

    Example:
        >>> um(0.0123456), um(0.0123456, 2)
        ('12.3 µm', '12 µm')
    """
    return f"{digits(value / UM, significant)} µm"


def microns(value: float) -> str:
    """A length in µm to two decimals; a smaller one to two digits."""
    return f"{value / UM:.2f} µm" if abs(value) >= 0.095 * UM else um(value, 2)


def signed(value: float, u: float | None, unit: str = "") -> str:
    """A difference, its sign always shown, to two digits of its uncertainty.

    Example:
        >>> signed(0.7914, 0.0812, "µm"), signed(-3.0, 0.5)
        ('+0.791 ± 0.081 µm', '-3.00 ± 0.50')
    """
    words = with_uncertainty(value, u, unit)
    return words if words.startswith("-") else f"+{words}"


def time_unit(span: float) -> tuple[float, str]:
    """The unit in which a span of time is written (s), and its name."""
    for unit, name, least in _SPANS:
        if abs(span) >= least * unit:
            return unit, name
    return 1.0, "s"


def span(seconds: float, significant: int = 3) -> str:
    """A span of time in a convenient unit.

    Example:
        >>> span(46710.0), span(847.7), span(12.0)
        ('13.0 h', '14.1 min', '12.0 s')
    """
    unit, name = time_unit(seconds)
    return f"{digits(seconds / unit, significant)} {name}"


def noun(column: str) -> str:
    """What a column of a run file holds.

    Example:
        >>> noun("B_deg"), noun("T_scaleX_degC"), noun("nz")
        ('B', 'temperature of scaleX', "the normal's z")
    """
    if column in _NOUNS:
        return _NOUNS[column]
    if column.startswith("T_") and column.endswith("_degC"):
        return f"temperature of {column.removeprefix('T_').removesuffix('_degC')}"
    if column.startswith("dir"):
        return f"direction of approach of {column.removeprefix('dir')}"
    for ending, _ in _UNITS:
        if column.endswith(ending):
            return column.removesuffix(ending)
    return column


def pose_word(touches: Touches) -> str:
    """What a number in the column `pose` counts: table poses, poses, else cycles or places."""
    if touches.chain.rotary_axes:
        return "table pose" if touches.chain.turns_workpiece else "pose"
    is_cycle = all(str(name).startswith("cycle") for name in set(touches.feature.tolist()))
    return "cycle" if is_cycle else "place"


def unit_of(column: str) -> str:
    """Unit of a column of a run file, "" where it has none."""
    if column == "time_s":
        return "s"
    return next((unit for ending, unit in _UNITS if column.endswith(ending)), "")


def quantity(column: str, value: float) -> str:
    """A value of a column with its unit; times in a convenient unit.

    Example:
        >>> quantity("B_deg", 60.0), quantity("time_s", 2400.0), quantity("nz", 0.85)
        ('60 deg', '40 min', '0.85')
    """
    if column == "time_s":
        unit, name = time_unit(value)
        return f"{value / unit:.3g} {name}"
    unit_name = unit_of(column)
    return f"{value:.6g} {unit_name}" if unit_name else f"{value:.6g}"


def condition(column: str, low: float, high: float) -> str:
    """A range of a column in words; infinite ends are open.

    A column such as `feature = pad4` holds 1 where that is true, else 0.

    Example:
        >>> condition("B_deg", 60.0, math.inf), condition("time_s", -math.inf, 2400.0)
        ('B > 60 deg', 'time < 40 min')
        >>> condition("feature = pad4", 0.5, math.inf)
        'on pad4'
    """
    key, is_label, label = column.partition(" = ")
    if is_label:
        at = {"feature": "on", "setup": "in set-up"}.get(key, f"{key} =")
        return f"{at} {label}" if low > -math.inf else f"not {at} {label}"
    name = noun(column)
    if math.isinf(low):
        return f"{name} < {quantity(column, high)}"
    if math.isinf(high):
        return f"{name} > {quantity(column, low)}"
    return f"{name} from {quantity(column, low)} to {quantity(column, high)}"


def shown(unit: str) -> tuple[str, float]:
    """Unit in which reports write a quantity, and its size in the base unit.

    Example:
        >>> shown("mm/K")
        ('µm/K', 0.001)
        >>> shown("1/K")
        ('µm/(m K)', 1e-06)
    """
    if unit == "1/K":
        return "µm/(m K)", 1e-6
    head, slash, tail = unit.partition("/")
    label, factor = _SHOWN.get(head, (head, 1.0))
    return label + slash + tail, factor


def percent(value: float) -> str:
    """A share in percent."""
    return f"{100.0 * value:.1f} %" if abs(value) < 0.1 else f"{100.0 * value:.0f} %"


def p_value(value: float) -> str:
    """A probability; below 1e-12 its digits mean nothing."""
    return "< 1e-12" if value < 1e-12 else f"{value:.2g}"


def odds_words(log_odds: float) -> str:
    """Odds for the first against the second.

    Example:
        >>> odds_words(0.0), odds_words(math.log(25.0)), odds_words(40.0), odds_words(-1.0)
        ('1 : 1', '25 : 1', '> 1e12 : 1', '1 : 2.7')
    """
    power = abs(log_odds) / math.log(10.0)
    if power > _MAX_LOG10:
        most = f"1e{_MAX_LOG10:.0f}"
        return f"> {most} : 1" if log_odds > 0.0 else f"< 1 : {most}"
    times = digits(10.0**power, 2) if power < 4.0 else f"1e{power:.0f}"
    times = times.removesuffix(".0")
    return f"{times} : 1" if log_odds >= 0.0 else f"1 : {times}"


def euros(value: float, u: float) -> str:
    """A price with its standard uncertainty, in hundreds of euros."""
    return f"{round(value, -2):.0f} ± {max(round(u, -2), 100.0):.0f} EUR"


_FLAT = 10_000.0  # mm: a ball of 3 mm cannot distinguish such a face from a plane


def concave_radius_words(value: float) -> str:
    """Smallest concave radius, mm; a face that is convex everywhere has none, one of 10 m is flat.

    Example:
        >>> concave_radius_words(41.27), concave_radius_words(2e4), concave_radius_words(math.inf)
        ('41.3', 'flat', 'convex')
    """
    if math.isinf(value):
        return "convex"
    return "flat" if value >= _FLAT else f"{value:.{1 if value < 1e3 else 0}f}"


def plural(number: int, word: str) -> str:
    """A number of things: `1 touch`, `2 touches`."""
    ending = "" if number == 1 else "es" if word.endswith("ch") else "s"
    return f"{number} {word}{ending}"


def capital(words: str) -> str:
    """Words at the beginning of a sentence; names of columns keep their small letter.

    Example:
        >>> capital("touches scatter"), capital("time_s is 0")
        ('Touches scatter', 'time_s is 0')
    """
    return words if "_" in words.split(" ", 1)[0] else words[:1].upper() + words[1:]


def sentence(words: str) -> str:
    """A clause of the console as a sentence of a page."""
    return capital(words) + ("" if words.endswith((".", "?")) else ".")


_MINUS = re.compile(r"(?<![^\s(,])-(?=\d)")
_APART = re.compile(r"(?<=[\d.]) (?=±|[µ%°]|min\b|h\b|mm\b|deg\b)|(?<=±) ")
"""Spaces between a number and its uncertainty or its unit."""


def unbroken(words: str) -> str:
    """Words whose numbers stay on a line with their uncertainties and units, minus signs as such.

    Example:
        >>> unbroken("X -3 to 5") == "X \u22123 to 5"
        True
        >>> unbroken("lag 11.1 ± 0.5 min") == "lag 11.1\u00a0±\u00a00.5\u00a0min"
        True
    """
    return _APART.sub("\u00a0", _MINUS.sub("\u2212", words))
