"""Periodic errors: pitch of a screw or scale, higher harmonics of a rotary axis."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.twin.fields import (
    ComponentSymbol,
    check_count,
    component_symbol,
    components_of,
    refusal,
    travelling_axes,
)
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Amounts, Declared, Inner, Kind, Parameter, Wave, scanned
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

SHORTEST, LONGEST = 1.0, 50.0
"""Default range of scanned periods of a linear axis, mm; denser readings are scanned down to what
they resolve."""
MIN_PINION_TURNS, LONGEST_PINION = 6.0, 250.0
"""A pinion on a rack turns once in up to `LONGEST_PINION` mm: periods beyond `LONGEST` are scanned
where the travel holds `MIN_PINION_TURNS` of them; fewer are hard to distinguish from a curve."""
PITCH_FRACTIONS = 4
"""Whole fractions of a stated pitch that are scanned: starts of the thread, balls of the nut, lines
of the encoder."""
PERIOD_OVERSAMPLING = 4.0
"""Scanned frequencies per resolvable one; the nearest keeps 97 % of a sine between two of them."""
MAX_OVERTONES = 12  # largest number of sines of one period; more would follow single steps
FINEST_HARMONIC = 400
"""Highest harmonic in readings of angles: worms have up to 180 teeth, gears more."""
HIGHEST_HARMONIC = 12
"""A period of 30 degrees, which 26 readings of the axis distinguish from its neighbours."""
ENOUGH_READINGS = 40
"""Distinct readings from which teeth and gears are searched for in displacements; with fewer, one
of 400 waves fits by chance."""
ALIAS_RESULTANT = 0.999
"""From this mean resultant of n times the readings, n waves per turn look like a constant: readings
are within 2.6 degrees of a wave of an even grid."""
MIN_GRID_RESULTANT = 0.9
"""From this mean resultant over a distance, readings stand on a grid of that distance."""
GAP_QUANTILES = (0.01, 0.1, 0.5, 0.9)
"""Quantiles of the gaps between readings that are tried as grid distances, the widest first.

One row of every eight of an even log leaves a single distance in one gap of 64; in fewer rows no
period is looked for (`PERIODS_PER_READING`) that they show as a longer one."""
PERIODS_PER_READING, MAX_PERIODS = 4, 40_000
"""Periods scanned in dense uneven readings, for each reading and at most: 3000 readings along 60 mm
are scanned down to 5 µm."""
MAX_SAMPLED_READINGS = 4000
"""Readings from which the resultant is computed; more make no difference."""


@dataclass(frozen=True)
class _Repeating(Declared):
    """A component error that is a sine of free phase over the reading of its axis."""

    symbol: ComponentSymbol

    kind, called = "periodic", "{symbol.title}, which repeats"
    amplitudes = ("sin", "cos")
    usual = (3 * UM, 20 * URAD)

    def _wave(self, touches: Touches, factor: float) -> Sequence[Array]:
        """Sine and cosine of factor times the reading."""
        argument = factor * touches.reading(self.symbol.link)
        return (np.sin(argument), np.cos(argument))


def _periods(effect: "Periodic", touches: Touches) -> Array:
    """Evenly spaced in frequency, fine enough for the travel that was covered."""
    axis = effect.symbol.link
    return scanned_periods(touches.reading(axis), touches.chain.link(axis).pitch)


@dataclass(frozen=True)
class Periodic(_Repeating):
    """A sine of free phase and unknown period p (mm) over a linear axis.

    Screw and nut, or scale and head, repeat every pitch.
    """

    period: float = scanned("mm", _periods, default=10.0, acts="with a period")

    def amounts(self, touches: Touches) -> Amounts:
        return self._wave(touches, 2.0 * np.pi / self.period)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        (period,) = super().inner(touches)
        return (period._replace(over=self.symbol.link),)

    @property
    def wave(self) -> Wave:
        """A single sine."""
        return Wave(self.symbol, self.period, 1)

    def with_sines(self, period: float, sines: int) -> "Overtones":
        """Several sines of a period near this one."""
        return Overtones(self.symbol, period, sines, near=period)


@dataclass(frozen=True)
class Overtones(Periodic):
    """A periodic error of any shape: a sine of period p with those of its whole fractions.

    ``E = sum_k s_k sin(2 pi k q/p) + c_k cos(2 pi k q/p)``, k = 1 .. order. An encoder's lines, a
    worn thread or a stepping motor repeat exactly, but hardly ever as one sine. The k-th is
    expected to be smaller by ``k^1.5``.
    """

    order: int = 2
    # period around which p is looked for, mm; None for every one that can be seen
    near: float | None = None

    @cached_property
    def name(self) -> str:
        """`periodic(EXX,6)`."""
        return f"periodic({self.symbol.name},{self.order})"

    @property
    def wave(self) -> Wave:
        """All sines."""
        return Wave(self.symbol, self.period, self.order)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        orders = range(1, self.order + 1)
        return tuple(self.sized(f"{word}{k}", k**-1.5) for k in orders for word in ("sin", "cos"))

    def amounts(self, touches: Touches) -> Amounts:
        turn = 2.0 * np.pi / self.period * touches.reading(self.symbol.link)
        return [f(k * turn) for k in range(1, self.order + 1) for f in (np.sin, np.cos)]

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The period; near a known one only its neighbours on the grid."""
        (whole,) = super().inner(touches)
        if self.near is None:
            return (whole,)
        at = int(np.clip(np.searchsorted(whole.grid, self.near), 2, len(whole.grid) - 2))
        return (whole._replace(grid=whole.grid[at - 2 : at + 2]),)


def _harmonics(effect: "Harmonic", touches: Touches) -> Array:
    """Harmonics that the distinct readings of the axis can distinguish.

    For the positioning of an axis they go up to the resolution of the readings, since worms and
    gears turn many times per turn of their axis.
    """
    readings = np.unique(np.round(touches.reading(effect.symbol.link), 4))
    highest = int(np.clip(len(readings) // 2 - 1, 2, HIGHEST_HARMONIC))
    is_fine = touches.instrument.reads_angle or len(readings) >= ENOUGH_READINGS
    if is_fine and effect.is_positioning(touches.chain):
        highest = max(highest, finest_harmonic(readings))
    return np.arange(2.0, highest + 1.0)


@dataclass(frozen=True)
class Harmonic(_Repeating):
    """One harmonic, the second or a higher one, of a component error of a rotary axis.

    ``E = s sin(k q) + c cos(k q)``, k = 2, 3 ...; k = 1 is eccentricity and tilt, part of every
    geometric model. k = 2 comes from two reading heads or an oval seat, 4 from four screws, the
    line count from the encoder.
    """

    harmonic: float = scanned("1", _harmonics, default=2.0, continuous=False)

    def is_positioning(self, chain: Chain) -> bool:
        """Whether it is the rotation of the axis about itself."""
        return self.symbol.component == chain.link(self.symbol.link).own_component

    def amounts(self, touches: Touches) -> Amounts:
        return self._wave(touches, self.harmonic)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        (harmonic,) = super().inner(touches)
        over = self.symbol.link if self.is_positioning(touches.chain) else ""
        return (harmonic._replace(over=over),)


def scanned_periods(q: Array, pitch: float | None = None) -> Array:
    """Periods that some readings (N,) can show, mm, ascending, (G,), mm; a pitch may be stated.

    From half the travel (at most `LONGEST`, on a long axis `LONGEST_PINION`) down to `SHORTEST`, or
    to twice the distance of denser readings, for uneven ones further (`PERIODS_PER_READING`); and
    around whole fractions of a stated pitch beyond that. Frequencies 1/p are evenly spaced.
    """
    travel = float(np.ptp(q))
    shortest = min(SHORTEST, _resolved(q)) if travel > 0.0 else SHORTEST
    longest = max(
        min(LONGEST, 0.5 * travel), min(LONGEST_PINION, travel / MIN_PINION_TURNS), 2.0 * shortest
    )
    low, high = 1.0 / longest, 1.0 / shortest
    step = 1.0 / (PERIOD_OVERSAMPLING * max(travel, longest))
    frequencies = np.linspace(low, high, int(np.ceil((high - low) / step)) + 1)
    for k in range(1, PITCH_FRACTIONS + 1) if pitch else ():
        around = k / pitch + step * np.arange(-1.0, 2.0) if pitch else np.zeros(0)
        beyond = (around < low) | (around > high + step)
        if beyond.all() and around[0] > 0.5 / max(travel, longest):
            frequencies = np.concatenate([frequencies, around])
    return np.asarray(1.0 / np.unique(frequencies)[::-1])


def finest_harmonic(q: Array) -> int:
    """Highest harmonic without an alias among lower ones, at most `FINEST_HARMONIC`.

    Distinct readings (N,), rad, that stand on a grid of n to the turn show harmonic n as a
    constant, and n - k as k.

    Example:
        >>> finest_harmonic(np.radians(np.arange(0.0, 360.0, 15.0)))
        11
        >>> finest_harmonic(np.radians([0.0, 13.7, 31.2, 43.5, 62.9, 70.1, 91.3, 104.6]))
        400
    """
    if len(q) > MAX_SAMPLED_READINGS:
        q = np.random.default_rng(0).choice(q, MAX_SAMPLED_READINGS, replace=False)
    counts = np.arange(len(q) // 2, 2 * FINEST_HARMONIC + 1)
    alike = (n for n in counts if abs(np.exp(1j * n * q).mean()) > ALIAS_RESULTANT)
    return (int(next(alike, 2 * FINEST_HARMONIC + 1)) - 1) // 2


def _resolved(q: Array) -> float:
    """Shortest period that readings distinguish from longer ones, mm.

    Readings on an even grid, all of it or some, show every period below twice its distance as a
    longer one; dense uneven ones have no such period.
    """
    places, usual = np.unique(q), 2.0 * usual_distance(q)
    if usual >= SHORTEST:
        return usual
    finest = float(np.ptp(q)) / min(PERIODS_PER_READING * len(places), MAX_PERIODS)
    return min(usual, max(finest, 2.0 * grid_distance(places)))


def grid_distance(places: Array) -> float:
    """Distance of the even grid on which ascending readings (N,) stand, 0 where there is none, mm.

    A choice of an even log has gaps of one, two and more distances, few of them of one.
    """
    gaps = np.diff(places)
    for distance in np.unique(np.quantile(gaps, GAP_QUANTILES, method="nearest"))[::-1]:
        for _ in range(2):  # the second time by a distance that all of the travel determines
            count = np.r_[0.0, np.cumsum(np.round(gaps / distance))]
            if not count.any():
                break
            distance = float(count @ (places - places[0]) / (count @ count))
        if abs(np.exp(2j * np.pi * places / distance).mean()) > MIN_GRID_RESULTANT:
            return float(distance)
    return 0.0


def usual_distance(q: Array) -> float:
    """Median distance between neighbouring readings, weighted by travel, mm.

    Readings that nearly repeat, such as targets approached several times, count as one.

    Example:
        >>> usual_distance(np.array([0.0, 6.0, 12.0, 12.001, 18.0, 0.002]))
        5.999
    """
    gaps = np.sort(np.diff(np.unique(q)))
    covered = np.cumsum(gaps)
    return float(round(gaps[np.searchsorted(covered, 0.5 * covered[-1])], 9))


def make(chain: Chain, arguments: Sequence[str]) -> Periodic | Harmonic:
    """From the component error, and of a linear axis how many whole fractions of the period."""
    check_count(KIND.usage, arguments, 1, 2)
    symbol = component_symbol(chain, arguments[0])
    is_linear = chain.link(symbol.link).kind == "linear"
    if arguments[1:]:
        order = int(arguments[1]) if arguments[1].isdecimal() else 0
        if not is_linear or not 2 <= order <= MAX_OVERTONES:
            what = f"nothing, or of a linear axis 2 to {MAX_OVERTONES}"
            raise refusal(KIND.usage, arguments, f"{what} behind the component error")
        return Overtones(symbol, order=order)
    return Periodic(symbol) if is_linear else Harmonic(symbol)


def propose(touches: Touches) -> Iterable[Periodic | Harmonic]:
    """Positioning of every linear axis that moved; every component of a rotary axis."""
    chain, axes = touches.chain, travelling_axes(touches)
    for symbol in components_of(touches, axes):
        if chain.link(symbol.link).kind == "rotary":
            yield Harmonic(symbol)
        elif symbol.component == chain.link(symbol.link).own_component:
            yield Periodic(symbol)


KIND = Kind(
    word="periodic",
    arguments="symbol[,sines of one period]",
    title="screw pitch and other periodic errors",
    synonyms="pitch error, ball screw, lead error, cyclic error, encoder, interpolation "
    "error, graduation, wobble",
    formula="E = s sin(2 pi q/p) + c cos(2 pi q/p), p unknown (linear); k q, k >= 2 (rotary)",
    units="s, c: µm or µrad; p: mm; k: 1",
    typical="0.5 to 3 µm at the pitch of a ground ball screw, up to 10 µm of others; rotary 0.1 to "
    "1 µm, 5 to 20 µrad",
    source="ISO 230-2 and the makers' data of feed axes; ISO 230-7 (axes of rotation)",
    make=make,
    propose=propose,
    classes=(Periodic, Overtones, Harmonic),
    about="Error that repeats: pitch of a screw or scale, higher harmonics of a rotary axis.",
)
