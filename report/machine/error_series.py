"""Errors of a machine as functions of its readings, exact enough to be evaluated elsewhere.

A page has no Python. So the six components that every error adds at every link are written as
Chebyshev series of the readings on which they depend, which reproduce smooth functions to the last
digits of a double. What a series leaves (steps, kinks) is measured and stated with it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.fft import dct

from matstd.compensation.field import MachineErrors
from matstd.report.effects import effect_title
from matstd.twin.frames import Array
from matstd.twin.machine import parse_symbol
from matstd.twin.numbers import rms_length
from matstd.twin.sampling import grid_points

EXACT = 1e-13
"""Error of a series, of the size of its function, from which it counts as the function itself."""

MOST_READINGS = 3
"""Of which one error may depend; of more there would be too many coefficients for a page."""

_DEGREES = {1: (4, 16, 64, 256, 1024), 2: (4, 16, 48), 3: (4, 8, 16)}
"""Degrees that are tried, by the number of readings."""

_CHECKED = 64  # poses at which dependence and error are looked at
_SEED = 20  # of these poses: the same machine gives the same page


@dataclass(frozen=True, eq=False)
class Series:
    """One component of one error at one link.

    ``E = sum_jk c_jk T_j(u) T_k(v)``, u and v readings scaled to [-1, 1].
    """

    part: str  # `twist` or `place`, as in a `Contribution`
    link: int  # index of the link
    component: int  # index in X Y Z A B C
    # columns of the readings that it depends on; one past the last axis is the time
    readings: tuple[int, ...]
    coefficients: Array  # one dimension a reading, mm or rad
    # axis and sign of the last motion with which it applies; None for always
    side: tuple[int, int] | None
    off: float  # largest error of the series at the poses that were checked, mm or rad


@dataclass(frozen=True, eq=False)
class ErrorFunction:
    """One error that is switched as a whole."""

    name: str  # symbol of ISO 230-1, or effect
    words: tuple[str, ...]  # under which it is switched: its axis, class and kind
    series: tuple[Series, ...]  # what it adds
    size: float  # rms of the deviation of the tool point that it makes over the workspace, mm
    u: float  # standard uncertainty of that from the model, mm
    title: str = ""  # in words; empty for that of its symbol
    left_out: bool = False  # whether it depends on more than a page can hold; then it has no series


@dataclass(frozen=True, eq=False)
class _Space:
    """Readings, and time behind them, over which the functions hold."""

    errors: MachineErrors
    # of the readings and the time, (A + 1,)
    low: Array
    high: Array

    def at(self, x: Array, sides: Array) -> Array:
        """Components at readings and time x (N, A + 1), twist before place, (N, 2 L 6)."""
        touches = self.errors.touches(x[:, :-1], 0.0, sides, x[:, -1])
        found = self.errors.contribution(touches)
        return np.concatenate(
            [np.asarray(part).reshape(len(x), -1) for part in (found.twist, found.place)], axis=1
        )

    def drawn(self, rng: np.random.Generator) -> Array:
        """Poses anywhere, (N, A + 1)."""
        return rng.uniform(self.low, self.high, (_CHECKED, len(self.low)))


def error_functions(errors: MachineErrors, length: float, duration: float) -> list[ErrorFunction]:
    """Groups of errors as functions, the largest first, for a tool length (mm) and a time (s)."""
    limits = np.array([errors.chain.link(a).range for a in errors.chain.axes] + [(0.0, duration)])
    rng = np.random.default_rng(_SEED)
    out = []
    for name in errors.groups:
        alone = errors.only(name)
        space = _Space(alone, limits[:, 0], limits[:, 1])
        series = _series(space, rng)
        x = space.drawn(rng)
        sides = rng.choice([-1.0, 1.0], (len(x), len(errors.chain.axes)))
        # sizes come from the model itself at random poses, not from the series that approximate it
        touches = alone.touches(x[:, :-1], length, sides, x[:, -1])
        columns = alone.columns(touches)
        theta = np.concatenate(alone.theta)
        spread = columns @ np.hstack([alone.root, alone.tool_root])
        out.append(
            ErrorFunction(
                name=name,
                words=tuple(sorted(alone.words(name) - {"all", name})),
                series=() if series is None else tuple(series),
                size=rms_length(columns @ theta),
                u=float(np.sqrt(np.einsum("nik,nik->", spread, spread) / len(spread))),
                title="" if parse_symbol(name) else effect_title(alone.effects[0]),
                left_out=series is None,
            )
        )
    return sorted(out, key=lambda one: -one.size)


def _series(space: _Space, rng: np.random.Generator) -> list[Series] | None:
    """All components of one error; None where it cannot be written so."""
    axes = len(space.low) - 1
    x, parts = space.drawn(rng), [_Part(space)]
    total = parts[0].at(x)
    sides = rng.choice([-1.0, 1.0], (_CHECKED, axes))
    for axis, sign in product(range(axes), (-1, 1)):
        part = _Part(space, (axis, sign))
        extra = part.at(x)
        if np.any(extra):
            parts.append(part)
            total += np.where(sides[:, [axis]] == sign, extra, 0.0)
    whole = space.at(x, sides)
    # sides of several axes have to add up, or no sum of functions is right
    if np.abs(whole - total).max() > 1e-9 * max(np.abs(whole).max(), 1e-12):
        return None
    out: list[Series] = []
    for part in parts:
        found = part.series(x, rng)
        if found is None:
            return None
        out += found
    return out


@dataclass(frozen=True, eq=False)
class _Part:
    """What one error adds whatever moved, or what an axis that comes from one side adds to it."""

    space: _Space
    side: tuple[int, int] | None = None  # as of `Series`

    def at(self, x: Array) -> Array:
        """Components at readings and time x (N, A + 1), as of `_Space`."""
        sides = np.zeros((len(x), len(self.space.low) - 1))
        plain = self.space.at(x, sides)
        if self.side is None:
            return plain
        axis, sign = self.side
        sides[:, axis] = sign
        return self.space.at(x, sides) - plain

    def series(self, x: Array, rng: np.random.Generator) -> list[Series] | None:
        """All components that are not zero everywhere; None for too many readings."""
        values, low, high = self.at(x), self.space.low, self.space.high
        alive = np.flatnonzero(np.any(values, axis=0))
        on: dict[int, list[int]] = {int(entry): [] for entry in alive}
        for reading in range(len(low)):
            moved = x.copy()
            moved[:, reading] = rng.uniform(low[reading], high[reading], len(x))
            change = np.abs(self.at(moved) - values).max(axis=0)
            for entry in on:
                if change[entry] > EXACT * np.abs(values[:, entry]).max():
                    on[entry].append(reading)
        out = []
        # components that depend on the same readings are sampled together
        for readings in sorted({tuple(r) for r in on.values()}):
            if len(readings) > MOST_READINGS:
                return None
            mine = [entry for entry, r in on.items() if tuple(r) == readings]
            for entry, c, off in self._fitted(readings, mine, x, values):
                part, rest = divmod(entry, values.shape[1] // 2)
                link, component = divmod(rest, 6)
                out.append(
                    Series(
                        part=("twist", "place")[part],
                        link=link,
                        component=component,
                        readings=readings,
                        coefficients=c,
                        side=self.side,
                        off=off,
                    )
                )
        return out

    def _fitted(
        self, readings: tuple[int, ...], entries: list[int], x: Array, values: Array
    ) -> Iterator[tuple[int, Array, float]]:
        """Coefficients of some components, of the lowest degree that is exact; what they leave."""
        size = np.abs(values[:, entries]).max(axis=0)
        if not readings:
            for entry in entries:
                yield entry, values[0, entry], float(np.ptp(values[:, entry]))
            return
        low, high = self.space.low[list(readings)], self.space.high[list(readings)]
        u = (2.0 * x[:, list(readings)] - (low + high)) / (high - low)
        for degree in _DEGREES[len(readings)]:
            c = self._coefficients(readings, entries, degree)
            found = series_at(c, u)
            off = np.abs(found - values[:, entries]).max(axis=0)
            if np.all(off <= EXACT * size):
                break
        for k, entry in enumerate(entries):
            yield entry, _shortened(c[..., k], size[k]), float(off[k])

    def _coefficients(self, readings: tuple[int, ...], entries: list[int], degree: int) -> Array:
        """Interpolation at the Chebyshev points of the first kind, one dimension a reading."""
        n = degree + 1
        points = np.cos(np.pi * (np.arange(n) + 0.5) / n)
        grid = grid_points(*[points] * len(readings))
        x = np.tile(0.5 * (self.space.low + self.space.high), (len(grid), 1))
        low, high = self.space.low[list(readings)], self.space.high[list(readings)]
        x[:, list(readings)] = 0.5 * ((low + high) + grid * (high - low))
        c = self.at(x)[:, entries].reshape(*[n] * len(readings), len(entries))
        for axis in range(len(readings)):
            c = dct(c, axis=axis) / n
            c[(slice(None),) * axis + (0,)] *= 0.5
        return np.asarray(c)


def series_at(c: Array, u: Array) -> Array:
    """Values of series at scaled readings, (N, ...).

    Args:
        c: Coefficients, one dimension a reading, then any others.
        u: Readings scaled to [-1, 1], (N, R).
    """
    out = c[None]
    for k in range(u.shape[1]):
        T = np.cos(np.arange(out.shape[1]) * np.arccos(np.clip(u[:, [k]], -1.0, 1.0)))
        out = np.einsum("nj,nj...->n...", T, np.broadcast_to(out, (len(u), *out.shape[1:])))
    return out


def _shortened(c: Array, size: float) -> Array:
    """Without the tail of the series that is rounding."""
    keep = np.abs(c) > 1e-3 * EXACT * size
    for axis in range(c.ndim):
        others = tuple(k for k in range(c.ndim) if k != axis)
        alive = np.flatnonzero(keep.any(axis=others))
        c = np.take(c, range(int(alive[-1]) + 1 if len(alive) else 1), axis=axis)
    return c
