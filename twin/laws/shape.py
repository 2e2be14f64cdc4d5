"""Shapes of a law: functions of one variable, with the values of their parameters to be scanned.

A shape gives one column per linear coefficient at every touch and is of order one, so that the
amplitude of a law is a size. Parameters that stand in the formula otherwise than as a factor are
`places` of it, in the unit of the variable or a number. Times count from the start of what they are
measured from; `log`, `decay` and `settling` begin there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.frames import Array

Values = Callable[..., Sequence[Array]]
"""Columns at values x (N,) of the variable for the parameters of the shape, (N,) each."""


@dataclass(frozen=True)
class Shape:
    """One family of curves."""

    word: str  # its name, as in `law(EZX,bump Y)`
    formula: str  # with x the variable
    # the same as Python expressions on arrays, one per coefficient: x is the variable; none of a
    # curve without a formula
    code: tuple[str, ...]
    values: Values
    # names of its parameters: ending in `0` to `9` or named `phase` they are places, `zero` and
    # `unit` are fixed with the machine, others are widths
    places: tuple[str, ...] = ()
    # words of its linear coefficients; one empty word where there is one alone
    coefficients: tuple[str, ...] = ("",)
    # whether the curve jumps at its places, so that only touches on either side fix them
    jumps: bool = False
    remembers: bool = False  # whether the order of touches matters
    # whether it begins at the start of what its variable is counted from, and comes to rest
    relaxes: bool = False

    @property
    def is_placed(self) -> bool:
        """Whether it acts at a place, a phase or a course of its variable."""
        return any(name[-1].isdigit() or name in ("phase", "low") for name in self.places)

    @property
    def free(self) -> tuple[int, ...]:
        """Which of the parameters a run determines; the others follow from the machine."""
        return tuple(i for i, name in enumerate(self.places) if name not in FIXED)

    @property
    def edges(self) -> tuple[int, ...]:
        """Places at which the curve jumps."""
        return tuple(i for i in self.free if self.jumps and self.places[i][0] == "x")

    @property
    def smooth(self) -> tuple[int, ...]:
        """Free parameters with which the curve changes smoothly; a wave that jumps has none."""
        return tuple(i for i in self.free if not self.jumps or self.places[i] == "w")


FIXED = ("zero", "unit", "k", "low", "high", "length", "size")
"""Parameters that follow from the machine or from the data before a formula is fitted."""

WAVES = 32  # waves of a curve without a formula: half waves over its domain, from none on


def play(x: Array, width: float) -> Array:
    """Output of a play of half width w: it follows x only while x pushes it, (N,).

    Reference:
        Krasnoselskii and Pokrovskii, Systems with Hysteresis (1989): the play operator.
    """
    out = np.empty(len(x))
    last = float(x[0]) if len(x) else 0.0
    for i, value in enumerate(x.tolist()):
        last = min(max(last, value - width), value + width)
        out[i] = last
    return out


def curve_waves(length: float) -> Array:
    """Weights of the waves of a smooth curve of a correlation length, sum of squares 1, (WAVES,).

    The finer a wave, the less is expected of it: ``w_k ~ 1/(1 + (k pi l)^2)``, the spectral density
    of a Matern process of smoothness 3/2, l as a share of the domain.
    """
    weight = 1.0 / (1.0 + (np.pi * np.arange(WAVES) * length) ** 2)
    return np.asarray(weight / np.linalg.norm(weight))


def curve_columns(x: Array, low: float, high: float, length: float) -> Array:
    """Waves of a smooth curve over its domain, (N, WAVES); beyond it those at its edge.

    Reference:
        Solin and Sarkka, Statistics and Computing 30 (2020): Gaussian processes by waves.
    """
    share = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(np.cos(np.pi * share[:, None] * np.arange(WAVES)) * curve_waves(length))


def _curve(x: Array, low: float, high: float, length: float, size: float) -> Sequence[Array]:
    """Waves within the domain; beyond it what was learnt dies away, and what was not comes back.

    With d the distance from the edge the curve keeps ``k = (1 + z) exp(-z)``, ``z = sqrt(3) d/l``,
    of its value there (the correlation of the same process), and two coefficients of their own,
    which no touch within the domain determines, add the variance that is lost: ``1 - k^2``.
    """
    kept = kept_beyond(x, low, high, length)
    waves = size * kept[:, None] * curve_columns(x, low, high, length)
    return [*waves.T, *_beyond(x, low, high, length, size)]


def kept_beyond(x: Array, low: float, high: float, length: float) -> Array:
    """Share of a curve that is left beyond its domain; 1 within, (N,)."""
    z = np.sqrt(3.0) * np.maximum(np.maximum(low - x, x - high), 0.0) / ((high - low) * length)
    return np.asarray((1.0 + z) * np.exp(-z))


def _beyond(x: Array, low: float, high: float, length: float, size: float) -> Sequence[Array]:
    """Two coefficients of order one that act beyond the domain alone, on either side."""
    new = size * np.sqrt(np.maximum(1.0 - kept_beyond(x, low, high, length) ** 2, 0.0))
    return new * (x < low), new * (x > high)


def _of(code: Sequence[str], places: Sequence[str]) -> Values:
    """Columns by expressions: what is fitted is what the file of an effect is written with."""
    columns = ", ".join(code).format(**{name: name for name in places})
    return eval(f"lambda {', '.join(('x', *places))}: ({columns},)", {"np": np, "play": play})


def _shape(
    word: str,
    formula: str,
    code: str | tuple[str, ...],
    *places: str,
    coefficients: tuple[str, ...] = ("",),
    values: Values | None = None,
    jumps: bool = False,
    remembers: bool = False,
    relaxes: bool = False,
) -> Shape:
    expressions = (code,) if isinstance(code, str) else code
    return Shape(
        word=word,
        formula=formula,
        code=expressions,
        values=values or _of(expressions, places),
        places=places,
        coefficients=coefficients,
        jumps=jumps,
        remembers=remembers,
        relaxes=relaxes,
    )


_CURVE = ("low", "high", "length", "size")
_FREE_CURVE = (*(f"c{k}" for k in range(WAVES)), "below", "above")

# before `zero`, the edge of the values that were seen, an exponential would grow without a bound:
# another run that began 1 K colder was predicted worse by 9 um
SHAPES: dict[str, Shape] = {
    shape.word: shape
    for shape in (
        _shape("sign", "sgn(x)", "x"),
        _shape("lin", "u, u = (x - zero)/unit", "(x - {zero}) / {unit}", "zero", "unit"),
        _shape("lin-from", "a u + b, u = (x - zero)/unit",
               ("(x - {zero}) / {unit}", "x * 0 + 1"), "zero", "unit",
               coefficients=("slope", "constant")),
        _shape("quad", "u^2, u = (x - zero)/unit", "((x - {zero}) / {unit}) ** 2", "zero", "unit"),
        _shape("quad-about", "((x - x0)/unit)^2", "((x - {x0}) / {unit}) ** 2", "x0", "unit"),
        _shape("cubic", "u^3, u = (x - zero)/unit", "((x - {zero}) / {unit}) ** 3",
               "zero", "unit"),
        _shape("power", "|u|^p, u = (x - zero)/unit",
               "np.maximum(np.abs(x - {zero}) / {unit}, 1e-9) ** {p}", "zero", "unit", "p",
               relaxes=True),
        _shape("bump", "exp(-((x - x0)/w)^2)", "np.exp(-(((x - {x0}) / {w}) ** 2))", "x0", "w"),
        _shape("bump-before", "exp(-((x - x0)/w)^2) for x < x0, else 0",
               "np.exp(-(((x - {x0}) / {w}) ** 2)) * (x < {x0})", "x0", "w", jumps=True),
        _shape("bump-after", "exp(-((x - x0)/w)^2) for x > x0, else 0",
               "np.exp(-(((x - {x0}) / {w}) ** 2)) * (x > {x0})", "x0", "w", jumps=True),
        _shape("pulse", "max(0, x - x0)/w exp(1 - max(0, x - x0)/w)",
               "np.maximum(x - {x0}, 0.0) / {w} * np.exp(1.0 - np.maximum(x - {x0}, 0.0) / {w})",
               "x0", "w"),
        _shape("step", "1 for x > x0, else 0", "(x > {x0}) * 1.0", "x0", jumps=True),
        _shape("window", "1 for x1 < x < x2, else 0", "((x > {x1}) & (x < {x2})) * 1.0",
               "x1", "x2", jumps=True),
        _shape("ramp", "0 before x1, 1 after x2, a line between",
               "np.clip((x - {x1}) / np.maximum({x2} - {x1}, 1e-9), 0.0, 1.0)", "x1", "x2"),
        _shape("plateau", "1 between x1 and x2, gone a width w outside (half cosine)",
               "0.5 + 0.5 * np.cos(np.pi * np.clip(np.maximum({x1} - x, x - {x2}) / {w}, 0, 1))",
               "x1", "x2", "w"),
        _shape("kink", "max(0, x - x0)/unit", "np.maximum(x - {x0}, 0.0) / {unit}", "x0", "unit"),
        _shape("kink-before", "max(0, x0 - x)/unit", "np.maximum({x0} - x, 0.0) / {unit}",
               "x0", "unit"),
        _shape("saturation", "tanh((x - x0)/w)", "np.tanh((x - {x0}) / {w})", "x0", "w"),
        _shape("dead-band", "max(0, |x - x0| - w) sgn(x - x0)/unit",
               "np.maximum(np.abs(x - {x0}) - {w}, 0.0) * np.sign(x - {x0}) / {unit}",
               "x0", "w", "unit"),
        _shape("exp", "exp(-(x - zero)/w)", "np.exp(-np.maximum((x - {zero}) / {w}, 0.0))",
               "zero", "w", relaxes=True),
        _shape("settling", "1 - exp(-(x - zero)/w)",
               "-np.expm1(-np.maximum((x - {zero}) / {w}, 0.0))", "zero", "w", relaxes=True),
        _shape("two-exp", "a exp(-(x - zero)/wa) + b exp(-(x - zero)/wb)",
               ("np.exp(-np.maximum((x - {zero}) / {wa}, 0.0))",
                "np.exp(-np.maximum((x - {zero}) / {wb}, 0.0))"), "zero", "wa", "wb",
               coefficients=("fast", "slow"), relaxes=True),
        _shape("log", "log(1 + (x - zero)/w)", "np.log1p(np.maximum(x - {zero}, 0.0) / {w})",
               "zero", "w", relaxes=True),
        _shape("sine", "a sin(2 pi x/period) + b cos(2 pi x/period)",
               ("np.sin(2 * np.pi * x / {period})", "np.cos(2 * np.pi * x / {period})"), "period",
               coefficients=("sin", "cos")),
        _shape("harmonic", "a sin(k x) + b cos(k x)", ("np.sin({k} * x)", "np.cos({k} * x)"), "k",
               coefficients=("sin", "cos")),
        _shape("square", "sgn sin(2 pi x/period + phase)",
               "np.sign(np.sin(2 * np.pi * x / {period} + {phase}))", "period", "phase",
               jumps=True),
        _shape("saw", "2 frac(x/period + phase/(2 pi)) - 1",
               "2.0 * np.mod(x / {period} + {phase} / (2 * np.pi), 1.0) - 1.0", "period", "phase",
               jumps=True),
        _shape("half-wave", "max(0, sin(x + phase))", "np.maximum(np.sin(x + {phase}), 0.0)",
               "phase"),
        _shape("hysteresis", "x less a play of half width w, over unit",
               "(x - play(x, {w})) / {unit}", "w", "unit", remembers=True),
        _shape("play", "play of half width w that follows x, from zero, over unit",
               "(play(x, {w}) - {zero}) / {unit}", "zero", "w", "unit", remembers=True),
        _shape("play-quad", "square of a play of half width w that follows x, from zero, over unit",
               "((play(x, {w}) - {zero}) / {unit}) ** 2", "zero", "w", "unit", remembers=True),
        _shape("curve", "smooth curve without a formula, dying away beyond its domain", (),
               *_CURVE, values=_curve, coefficients=_FREE_CURVE),
        _shape("surface", "smooth surface without a formula over", (), *_CURVE, values=_curve),
        _shape("course", "what a driver that was not recorded does in another run", (),
               *_CURVE, values=_curve, coefficients=_FREE_CURVE),
        _shape("beyond", "what is not known beyond the domain of a law", (), *_CURVE,
               values=_beyond, coefficients=("below", "above")),
    )
}  # fmt: skip
"""Every shape by its word; a new one is a line here and its grid in `matstd.twin.laws.grids`."""
