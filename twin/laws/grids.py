"""Where the parameters of every shape are scanned, from the values that a variable took.

Places lie between measured values, so that each can be distinguished from its neighbour;
widths go from two distances of neighbours to the whole range; periods from the sampling limit on.
"""

from collections.abc import Iterator
from itertools import combinations, product

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.laws.driver import Driver
from matstd.twin.laws.shape import SHAPES, Shape

BUMP_PLACES = 24  # places over the range of a variable at which a bump, a kink or a step is tried
EDGES = 18  # edges of a window or a ramp: 153 pairs of them

EVERY_GAP = 40
"""Up to so many gaps between the values of a variable every one is an edge of a window."""

PHASES = 10  # phases of waves with corners; refined afterwards

OVERSAMPLING = 2.0
"""Points per resolvable frequency, 1/range: a sine between two of them keeps 90 % of its size."""

MOST_PERIODS = {"time": 30.0, "linear": 15.0}
"""Waves within the range of a variable up to which they are tried, by its nature; quicker sines of
readings and of time have a scan of their own."""

FEW_PERIODS = 6.0  # the same of a variable of another nature

MIN_VALUES = 5
"""Of a variable with fewer different values nothing but a level, a line or a step is learnt."""

WORDS = {
    "sign": ("sign",),
    "linear": (
        "lin", "lin-from", "quad", "quad-about", "cubic", "power", "bump", "bump-before",
        "bump-after", "step", "window", "ramp", "plateau", "kink", "kink-before", "saturation",
        "dead-band", "exp", "sine", "square", "saw", "hysteresis",
    ),
    "rotary": (
        "lin", "quad", "bump", "bump-before", "bump-after", "step", "window", "ramp", "plateau",
        "kink", "kink-before", "saturation", "harmonic", "sine", "square", "saw", "half-wave",
        "hysteresis",
    ),
    "time": (
        "lin", "quad", "power", "bump", "bump-before", "bump-after", "pulse", "step", "window",
        "ramp", "plateau", "kink", "kink-before", "saturation", "exp", "settling", "two-exp", "log",
        "sine", "square", "saw",
    ),
    "level": (
        "lin", "lin-from", "quad", "quad-about", "power", "bump", "step", "window", "ramp", "kink",
        "kink-before", "saturation", "dead-band", "exp", "hysteresis", "play",
        "play-quad",
    ),
}  # fmt: skip
"""Shapes that make sense of a variable, by its nature."""


def shapes_of(driver: Driver, x: Array) -> list[Shape]:
    """Shapes that the values of a variable can show."""
    values = np.unique(np.round((x - x.min()) / max(np.ptp(x), 1e-300), 6))
    words = WORDS[driver.nature]
    if driver.nature != "sign" and len(values) < MIN_VALUES:
        words = tuple(w for w in words if w in ("lin", "step"))
    return [SHAPES[word] for word in words]


def grid(shape: Shape, driver: Driver, x: Array) -> Array:
    """Values of the parameters of a shape to be scanned, (G, parameters)."""
    low, high = float(x.min()), float(x.max())
    span, scale = high - low, driver.scale
    start = driver.zero if driver.nature == "time" else low
    is_time = driver.nature == "time"
    widths = span * np.geomspace(0.03, 1.0, 9)
    tails = span * np.geomspace(0.02, 3.0, 14)
    between = _between(x, BUMP_PLACES)
    made: dict[str, Iterator[tuple[float, ...]] | list[tuple[float, ...]]] = {
        "sign": [()],
        "lin": [(driver.zero, scale)],
        "lin-from": [(driver.zero, scale)],
        "quad": [(driver.zero, scale)],
        "quad-about": [(p, scale) for p in np.linspace(low, high, 16)],
        "cubic": [(driver.zero, scale)],
        "power": [
            (z, scale, p)
            for z in dict.fromkeys((start,) if is_time else (low, high, driver.zero))
            for p in (0.25, 0.4, 0.6, 0.8, 1.4, 1.7, 2.5, 3.0, 4.0)
        ],
        "bump": product(np.linspace(low, high, BUMP_PLACES), widths),
        "bump-before": product(between, widths[2:]),
        "bump-after": product(between, widths[2:]),
        "pulse": product((low, *between[::2]), widths),
        "step": [(p,) for p in _between(x, 3 * BUMP_PLACES)],
        "window": combinations(_edges(x), 2),
        "ramp": combinations(np.linspace(low, high, EDGES), 2),
        "plateau": [
            (a, b, share * (b - a))
            for a, b in combinations(np.linspace(low, high, EDGES), 2)
            for share in (0.2, 0.6)
        ],
        "kink": [(p, scale) for p in between],
        "kink-before": [(p, scale) for p in between],
        "saturation": product(np.linspace(low, high, 12), widths[:7]),
        "dead-band": [
            (p, w, scale)
            for p in np.linspace(low, high, 9)
            for w in span * np.linspace(0.05, 0.4, 5)
        ],
        "exp": [(start, w) for w in tails] + ([] if driver.nature == "time" else
                                            [(high, -w) for w in tails]),
        "settling": [(start, w) for w in tails],
        "two-exp": [(start, a, b) for a, b in combinations(tails, 2)],
        "log": [(start, w) for w in span * np.geomspace(0.003, 1.0, 14)],
        "sine": [(p,) for p in _periods(driver, x)],
        "harmonic": [(float(k),) for k in range(1, 1 + min(24, len(np.unique(x)) // 2))],
        "square": product(_periods(driver, x), _phases()),
        "saw": product(_periods(driver, x), 2.0 * _phases()),
        "half-wave": [(p,) for p in 2.0 * _phases()],
        "hysteresis": [(w, scale) for w in span * np.geomspace(0.01, 0.4, 10)],
        "curve": [(low - 0.1 * span, high + 0.1 * span, 0.1, 10e-3)],
        "surface": [(low - 0.1 * span, high + 0.1 * span, 0.2, 10e-3)],
        "course": [(low, high, 0.1, 10e-3)],
        "beyond": [(low, high, 0.3, 10e-3)],
        "play-quad": [(driver.zero, w, scale) for w in span * np.geomspace(0.01, 0.4, 10)],
        "play": [(driver.zero, w, scale) for w in span * np.geomspace(0.01, 0.4, 10)],
    }  # fmt: skip
    points = list(made[shape.word])
    return np.array(points, dtype=float).reshape(len(points), len(shape.places))


def _phases() -> Array:
    """Over half a turn: the other half is the same with the other sign."""
    return np.pi * np.arange(PHASES) / PHASES


def _between(x: Array, count: int) -> Array:
    """Places in the gaps between measured values, evenly through their order."""
    values = np.unique(x)
    gaps = 0.5 * (values[1:] + values[:-1])
    if len(gaps) <= count:
        return gaps
    return gaps[np.linspace(0, len(gaps) - 1, count + 2).astype(int)[1:-1]]


def _edges(x: Array) -> Array:
    gaps = _between(x, EVERY_GAP)
    return gaps if len(gaps) < EVERY_GAP else _between(x, EDGES)


def _periods(driver: Driver, x: Array) -> Array:
    """Periods from twice the range down to the sampling limit, evenly in frequency.

    Readings of a run are uneven, so that waves up to one in two touches can be distinguished; of a
    rotary axis whole waves of a turn are `harmonic`.
    """
    span = float(np.ptp(x))
    count = len(np.unique(np.round(x / max(span, 1e-300), 5)))
    nature = driver.nature if driver.name == "time" or driver.nature != "time" else ""
    most = min(0.5 * count, MOST_PERIODS.get(nature, FEW_PERIODS))
    return np.asarray(span / np.arange(0.5, most + 1e-9, 1.0 / OVERSAMPLING))
