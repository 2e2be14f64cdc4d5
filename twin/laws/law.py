"""`law(carrier, shape variable, ...)`: an effect that is stated by what it looks like.

A law moves a carrier (a component of a link, the standard, the reading of the probe) by an
amplitude times one or two shapes, each a function of one variable:

    law(EZX,bump Y)            EZX = a exp(-((Y - x0)/w)^2)
    law(EXY,lin T-scaleX,quad Y)    EXY = a u_T u_Y^2
    law(shift,exp since-setup)      the standard moves by (a, b, c) exp(-t/tau)
    law(EBY,curve Y)           a smooth curve without a formula
    law(EZX,surface X,surface Y)    a smooth surface over both
    law(EZX,beyond Y)          what a law may do beyond the Y that were probed: zero ± its size
    law(EZX,course time)       what a driver that was not recorded may do in another run: the same

The library has effects with a cause; a law has none. It is learnt from what a model leaves, and
predicts as any effect does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from matstd.twin.fields import check_count, refusal
from matstd.twin.frames import Array
from matstd.twin.laws.carrier import BIAS, Carrier, carrier_of
from matstd.twin.laws.driver import CLOCK, Driver, driver_of
from matstd.twin.laws.grids import grid
from matstd.twin.laws.shape import SHAPES, Shape, curve_waves
from matstd.twin.laws.surface import SURFACE_WORDS, surface_columns
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import Effect, Inner, Kind, Parameter, Term, Title
from matstd.twin.record import Touches
from matstd.twin.units import DEG, HOUR, T_REF, UM, URAD

FREE_LENGTH, FREE_ANGLE = 1000.0 * UM, 10000.0 * URAD
"""Prior standard deviation of an amplitude: what is learnt is not drawn towards zero. Of a curve
its own `size` is the prior."""

BEYOND_LENGTH = 0.3  # share of its domain within which a law has lost its force beyond it

AT_REST = 0.75
"""Share of its motion that a law of time makes in the first half of a run if it comes to rest in
it: an exponential whose time constant is below 0.46 of the run."""

COURSE_TIME, COURSE_LENGTH = 3.0 * HOUR, 0.05
"""Length of a run, and share of it within which a driver that was not recorded changes."""

FREE_FORMS = ("curve", "surface")  # shapes without a formula

MARGINS = ("beyond", "course")
"""Shapes of what is not known of a law: zero, with its size as uncertainty."""


class Factor(NamedTuple):
    """A shape of one variable."""

    shape: Shape
    driver: Driver

    @property
    def name(self) -> str:
        """`bump Y`."""
        return f"{self.shape.word} {self.driver.name}"


@dataclass(frozen=True)
class Law:
    """Amplitudes times one or two shapes, at a carrier."""

    carrier: Carrier
    factors: tuple[Factor, ...]  # shapes with their variables, one or two
    places: tuple[float, ...]  # values of their parameters, one after the other, base units
    # whether they are still to be found: by a scan over all that makes sense
    is_sought: bool = False
    # whether it belongs to its run for what else that run leaves open, whatever its variables
    is_of_run: bool = False

    kind = "law"

    @cached_property
    def name(self) -> str:
        """`law(EZX,bump Y)`."""
        return f"law({','.join([self.carrier.name, *(f.name for f in self.factors)])})"

    @property
    def title(self) -> Title:
        """What it looks like, and what carries it."""
        each = " times ".join(f"{f.shape.word} over {f.driver.name}" for f in self.factors)
        both = f"surface over {' and '.join(d.name for d in self.drivers)}"
        text = both if self.is_surface else each
        return Title(f"{self.carrier.name}: {text}", _bearer(self.carrier))

    @property
    def drivers(self) -> tuple[Driver, ...]:
        """Its variables: one where both shapes are of the same."""
        return tuple(dict.fromkeys(f.driver for f in self.factors))

    @cached_property
    def parts(self) -> tuple[tuple[Factor, slice], ...]:
        """Every factor with the range of its parameters in `places`."""
        out, start = [], 0
        for factor in self.factors:
            end = start + len(factor.shape.places)
            out.append((factor, slice(start, end)))
            start = end
        return tuple(out)

    @property
    def explanation(self) -> tuple[str, ...]:
        """Carrier and variables: other shapes of the same are no other explanation."""
        return (self.carrier.name, *sorted(driver.name for driver in self.drivers))

    @property
    def symbol(self) -> Symbol | None:
        """Component error that it acts on."""
        return self.carrier.symbol

    @property
    def is_of_reading(self) -> bool:
        """Whether it is a part of a component error: a function of the reading of its own axis."""
        symbol = self.symbol
        return symbol is not None and {driver.name for driver in self.drivers} == {symbol.link}

    @property
    def is_curve_alone(self) -> bool:
        """Whether it has no formula."""
        return any(f.shape.word in FREE_FORMS for f in self.factors)

    @property
    def is_surface(self) -> bool:
        """Whether it is a smooth surface over two variables, which no product of two shapes is."""
        return self.factors[0].shape.word == "surface"

    @property
    def is_margin(self) -> bool:
        """Whether it is what another law may do beyond its domain, or in another run."""
        return any(f.shape.word in MARGINS for f in self.factors)

    @property
    def belongs_to(self) -> str:
        """Of what it is to be expected again: "run" of a law whose clock is that of one run.

        Readings, temperatures, speeds, own columns, and times since a set-up, a pose or a change of
        speed come back in other runs. The time of a run does where the start of the run is what
        drives the law: where it relaxes from there, with or without an oscillation. An instant, a
        phase or a course within the run is that of a driver which was not recorded, even if it
        relaxes: a step times an exponential predicted another run with 3.44 um instead of 2.35.
        """
        if self.is_of_run:
            return "run"
        clocked = [f.shape for f in self.factors if f.driver == CLOCK]
        is_of_start = any(s.relaxes for s in clocked) and not any(s.is_placed for s in clocked)
        return "run" if clocked and not self.is_margin and not is_of_start else "machine"

    def rests(self, touches: Touches) -> bool:
        """Whether a law that relaxes from the start of a run has come to rest at its end.

        What has not may be a drift as well.
        """
        times = np.linspace(0.0, float(np.ptp(touches.since_start)), 201)
        for factor, own in self.parts:
            if factor.driver == CLOCK and factor.shape.relaxes:
                moved = np.abs(np.diff(factor.shape.values(times, *self.places[own]), axis=1))
                if np.any(moved[:, :100].sum(axis=1) < AT_REST * moved.sum(axis=1)):
                    return False
        return True

    def elsewhere(self, theta: Array, largest: float) -> "Law":
        """What its driver may do in another run: zero, as unsure as it is large.

        A law without the clock that belongs to its run stands for a driver that was not recorded,
        of which another run may have any course.

        Args:
            theta: Its amplitudes, base units.
            largest: Its largest amount in its run, base unit; asked of a law without the clock.
        """
        others: list[tuple[Factor, tuple[float, ...]]] = []
        if any(f.driver == CLOCK for f in self.factors):
            others = [(f, self.places[own]) for f, own in self.parts if f.driver != CLOCK]
            largest = self._largest_over_time(theta)
        # waves of one size have this share of its square as variance, on average over the time
        waves = 0.5 * (1.0 + curve_waves(COURSE_LENGTH)[0] ** 2)
        factors = (*(f for f, _ in others), Factor(SHAPES["course"], CLOCK))
        course = (0.0, COURSE_TIME, COURSE_LENGTH, largest / float(np.sqrt(waves)))
        return Law(self.carrier, factors, (*(v for _, own in others for v in own), *course))

    def _largest_over_time(self, theta: Array) -> float:
        """Largest amount over the time per unit of its other factors, base unit."""
        times = np.linspace(0.0, COURSE_TIME, 401)
        ways = theta.reshape(self.carrier.count, *(len(f.shape.coefficients) for f in self.factors))
        moved = np.broadcast_to(ways[..., None], (*ways.shape, len(times)))
        for i, (factor, own) in enumerate(self.parts, start=1):
            if factor.driver == CLOCK:
                S = np.stack(factor.shape.values(times, *self.places[own]))
                around = [1] * ways.ndim
                around[i] = len(S)
                moved = (moved * S.reshape(*around, -1)).sum(axis=i, keepdims=True)
        return float(np.abs(moved).max())

    @property
    def is_tensor(self) -> bool:
        """Reported by the rms that it explains where coefficients have no meaning."""
        return self.is_curve_alone

    def beyond(self, theta: Array, touches: Touches) -> tuple["Law", ...]:
        """What it may do beyond the values that its variables had: of its own size, either way.

        Args:
            theta: Its amplitudes, base units.
            touches: From which it was learnt.
        """
        ways = theta.reshape(self.carrier.count, -1)
        size = float(np.abs(np.stack(self.amounts(touches), axis=1) @ ways.T).max())
        out = []
        for driver in self.drivers:
            x = driver.values(touches)
            low, high = float(x.min()), float(x.max())
            is_whole = driver.nature == "sign" or (driver.unit == "rad" and high - low > np.pi)
            if not is_whole:
                places = (low, high, BEYOND_LENGTH, size)
                out.append(Law(self.carrier, (Factor(SHAPES["beyond"], driver),), places))
        return tuple(out)

    @property
    def needs_history(self) -> bool:
        """Whether the order of touches matters."""
        return any(f.shape.remembers for f in self.factors)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """Amplitudes: of every direction of the carrier, for every coefficient of the shapes."""
        is_sized = self.is_curve_alone or self.is_margin
        unit = "1" if is_sized else self.carrier.unit
        free = FREE_ANGLE if unit == "rad" else FREE_LENGTH
        sd = 1.0 if is_sized else free
        return tuple(
            Parameter(" ".join(w for w in (way, word) if w) or "amplitude", unit, sd)
            for way in self.carrier.words
            for word in self._coefficients
        )

    @property
    def _coefficients(self) -> list[str]:
        words = list(SURFACE_WORDS) if self.is_surface else [""]
        for factor in () if self.is_surface else self.factors:
            words = [f"{w} {c}".strip() for w in words for c in factor.shape.coefficients]
        return words

    def amounts(self, touches: Touches) -> list[Array]:
        """What the carrier does per unit of every coefficient, (N,) each."""
        if self.is_surface:
            x, y = (driver.values(touches) for driver in self.drivers)
            return surface_columns(x, y, *self.places)
        out = [np.ones(len(touches))]
        for factor, own in self.parts:
            found = factor.shape.values(factor.driver.values(touches), *self.places[own])
            out = [a * b for a in out for b in found]
        return out

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Amounts at the entries of the carrier."""
        return self.carrier.terms(touches, self.amounts(touches))

    @cached_property
    def place_names(self) -> tuple[str, ...]:
        """Name of every parameter of the shapes: `x0`, of a second shape of one name `x0-2`."""
        names = [name for f in self.factors for name in f.shape.places]
        first = len(self.factors[0].shape.places)
        return tuple(
            f"{n}-2" if i >= first and n in names[:first] else n for i, n in enumerate(names)
        )

    @cached_property
    def units(self) -> tuple[str, ...]:
        """Base unit of every parameter of the shapes; "1" of a number."""
        return tuple(
            "rad" if name == "phase" else "1" if _is_number(name, f.driver) else f.driver.unit
            for f in self.factors
            for name in f.shape.places
        )

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The parameters of the shapes: about where they are, or the scan that looks for them."""
        out, i = [], 0
        for factor in self.factors:
            x = factor.driver.values(touches)
            span = float(np.ptp(x))
            scan = grid(factor.shape, factor.driver, x) if self.is_sought else None
            for k, name in enumerate(factor.shape.places):
                if scan is None:
                    value = self.places[i]
                    values = value + _spacing(name, value, span) * np.array([-1.0, 0.0, 1.0])
                else:
                    values = np.unique(scan[:, k])
                is_free = k in factor.shape.smooth
                unit = self.units[i] if self.units[i] in ("mm", "rad", "s") else "1"
                is_instant = factor.driver.nature == "time" and k in factor.shape.edges
                made = Inner(self.place_names[i], unit, values, is_free)
                out.append(made._replace(acts="at an instant") if is_instant else made)
                i += 1
        return tuple(out)

    def tuned(self, *values: float) -> Self:
        """The same law with these parameters of its shapes."""
        return replace(self, places=tuple(float(v) for v in values))

    @property
    def tuning(self) -> Mapping[str, float]:
        """Present parameters of its shapes, base units."""
        return dict(zip(self.place_names, self.places, strict=True))

    @property
    def free(self) -> tuple[int, ...]:
        """Which of the parameters of the shapes a run determines."""
        return tuple(own.start + k for factor, own in self.parts for k in factor.shape.free)


def law_of(effect: Effect) -> Law | None:
    """The law that an effect is; None of an effect with a cause."""
    return effect if isinstance(effect, Law) else None


def _is_number(name: str, driver: Driver) -> bool:
    return name in ("p", "length", "size") or not driver.unit


def _spacing(name: str, value: float, span: float) -> float:
    """Step of a scan about a parameter: places by shares of the range, widths of themselves."""
    if name == "phase":
        return 10.0 * DEG
    if name[-1].isdigit() and name[0] == "x":
        return 0.03 * span
    if name == "period":
        return min(0.1 * abs(value), 0.1 * value**2 / max(span, 1e-300))
    return 0.2 * abs(value) or 0.03 * span or 1.0


def _bearer(carrier: Carrier) -> str:
    """Axis or body that carries it."""
    if carrier.symbol is not None:
        return carrier.symbol.link
    return "probe" if carrier.name == BIAS else "standard"


_USUAL = {"time": (0.0, 3.0 * HOUR), "level": (T_REF, T_REF + 10.0), "sign": (-1.0, 1.0),
          "rotary": (-np.pi, np.pi)}  # fmt: skip
"""Range of a variable before any touches are known."""


def make(chain: Chain, arguments: Sequence[str]) -> Law:
    """From the carrier and one or two factors; raises a child of DesignError."""
    check_count(KIND.usage, arguments, 2, 3)
    factors = []
    for text in arguments[1:]:
        word, _, name = text.strip().partition(" ")
        if word not in SHAPES:
            raise refusal(KIND.usage, arguments, f"a shape of {', '.join(SHAPES)}")
        factors.append(Factor(SHAPES[word], driver_of(name.strip(), chain)))
    if len({f.driver for f in factors if f.shape.word == "surface"}) == 1:
        raise refusal(KIND.usage, arguments, "a surface over two variables")
    places = [v for f in factors for v in _middle(f, chain)]
    return Law(carrier_of(arguments[0].strip(), chain), tuple(factors), tuple(places), True)


def _middle(factor: Factor, chain: Chain) -> tuple[float, ...]:
    """Parameters of a shape in the middle of what makes sense over the travel of its variable."""
    driver = factor.driver
    low, high = (
        chain.link(driver.name).range if driver.name in chain.axes else _USUAL[driver.nature]
    )
    points = grid(factor.shape, driver, np.linspace(low, high, 50))
    return tuple(float(v) for v in points[len(points) // 2])


KIND = Kind(
    word="law",
    arguments="carrier,shape variable[,shape variable]",
    title="law that was learnt",
    synonyms="discrepancy, empirical law, curve, unknown cause",
    formula="E = a f(variable), or a f(variable) g(variable); f, g: bump, step, ramp, kink, power, "
    "exp, log, sine, square, window, hysteresis, curve ... (matstd learn finds them)",
    units="a: µm or µrad; of the shapes the unit of their variable",
    typical="what matstd learn found",
    source="learnt from measurements: no cause is stated",
    make=make,
    propose=lambda touches: (),
    classes=(Law,),
)
