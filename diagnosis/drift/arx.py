"""The ARX law: a drift that depends on its own past and on a few temperatures.

``y(t) = c + sum_i a_i y(t-i) + sum_j sum_k b_jk T_j(t-k+1)``, i = 1 ... p, k = 1 ... q. It is
fitted as it is used: running freely, its own past and not the measured one fed back. Heat spreads
without ringing, so its poles are ``exp(-step/tau)`` with time constants of a grid, inside the unit
circle whatever the data; with them given, the free run is linear in b and c.

Reference: D-MT paper, eq. (4); output-error identification, Ljung, System Identification.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from matstd.diagnosis.drift.lags import followed
from matstd.diagnosis.drift.linear import LinearLaw, Sums, fitted, standardised, sums
from matstd.diagnosis.drift.record import DriftRecord, IntArray
from matstd.twin.frames import Array
from matstd.twin.units import HOUR, MINUTE

SHORTEST, LONGEST, STEPS = 10.0 * MINUTE, 12.0 * HOUR, 6
"""Time constants that are tried, s: neighbours differ by a factor of 2.4."""

MOST_DRIVES = 5
"""Drives of one law: "few sensors"."""

ORDERS = (1, 2)
"""Of the past of drives, q."""

WEIGHTS = (1e-4, 1e-2)
"""Of the ridge beside so few columns."""


@dataclass(frozen=True)
class ArxInputs:
    """Columns of the free run of an ARX law with given poles.

    Attributes:
        drives: That it follows.
        time_constants: Of its poles, s; their number is p.
        order: Present and past values of every drive, q.
    """

    drives: tuple[str, ...]
    time_constants: tuple[float, ...]
    order: int

    def poles(self, step: float) -> tuple[float, ...]:
        """Inside the unit circle."""
        return tuple(float(np.exp(-step / tau)) for tau in self.time_constants)

    def __call__(self, record: DriftRecord) -> Array:
        """Every drive through 1/A, and its differences over 1 ... q - 1 steps, (N, D q)."""
        out = []
        for name in self.drives:
            after = followed(record, name, self.poles(record.step))
            out.append(after)
            out.extend(after - _delayed(record, after, k) for k in range(1, self.order))
        return np.column_stack(out)


def _delayed(record: DriftRecord, values: Array, steps: int) -> Array:
    """Values some steps before; at the start of a stretch its first one."""
    at = np.arange(len(values)) - steps
    first = record.starts[np.searchsorted(record.starts, np.arange(len(values)), "right") - 1]
    return values[np.maximum(at, first)]


@dataclass(frozen=True, eq=False)
class ArxCoefficients:
    """The law as its equation is written, for one step of time.

    Attributes:
        a: Of the past of the drift, (p,).
        b: Of present and past drives, (D, q, K), base units per unit of the drive.
        constant: (K,).
    """

    a: Array
    b: Array
    constant: Array


def coefficients(law: LinearLaw, step: float) -> ArxCoefficients:
    """The coefficients of the difference equation of a fitted ARX law."""
    inputs = law.inputs
    assert isinstance(inputs, ArxInputs)
    denominator: Array = np.asarray(np.poly(inputs.poles(step)), dtype=float)
    per_unit = law.coefficients / law.scale[:, None]
    own = per_unit.reshape(len(inputs.drives), inputs.order, -1)
    b = -own
    b[:, 0] = own.sum(axis=1)
    constant = law.intercept - law.mean @ per_unit
    gain = denominator.sum()
    return ArxCoefficients(-denominator[1:], gain * b, gain * constant)


@dataclass(frozen=True)
class _Choice:
    """One law that was tried: its left-out error, the spread of it, and what it is."""

    error: float
    standard_error: float
    inputs: ArxInputs
    weight: float

    @property
    def complexity(self) -> tuple[float, ...]:
        """Fewer drives before fewer poles before fewer past values."""
        inputs = self.inputs
        return len(inputs.drives), len(inputs.time_constants), inputs.order, self.error


def arx(record: DriftRecord, parts: Sequence[IntArray]) -> LinearLaw:
    """The ARX law of all components together, chosen and fitted inside the blocks.

    Drives are added one by one, each the one that predicts left-out blocks best, for all poles and
    orders; of all that lie within one standard error of the best, the simplest is taken.
    """
    tried = [choice for shape in _shapes(record) for choice in _forward(record, parts, *shape)]
    best = min(tried, key=lambda c: c.error)
    within = [c for c in tried if c.error <= best.error + best.standard_error]
    chosen = min(within, key=lambda c: c.complexity)
    return fitted(record, chosen.inputs, parts, chosen.weight)


def _shapes(record: DriftRecord) -> Iterator[tuple[tuple[float, ...], int]]:
    """Time constants and orders that are tried."""
    span = record.step * max(s.stop - s.start for s in record.stretches())
    low = max(SHORTEST, 2.0 * record.step)
    grid = np.geomspace(low, max(min(LONGEST, 3.0 * span), 2.0 * low), STEPS).tolist()
    for constants in [*((tau,) for tau in grid), *combinations(grid, 2)]:
        for order in ORDERS:
            yield constants, order


def _forward(
    record: DriftRecord, parts: Sequence[IntArray], constants: tuple[float, ...], order: int
) -> Iterator[_Choice]:
    """Laws with one drive, two, and so on."""
    inputs = ArxInputs(record.drives, constants, order)
    Z, _, _ = standardised(inputs(record), np.concatenate(parts))
    added = sums(record, Z, parts)
    for weight in WEIGHTS:
        for drives, error, spread in _grown(added, len(record.drives), order, weight):
            names = tuple(record.drives[d] for d in drives)
            yield _Choice(error, spread, ArxInputs(names, constants, order), weight)


def _grown(
    added: Sums, count: int, order: int, weight: float
) -> Iterator[tuple[list[int], float, float]]:
    """Drives added one by one, with the left-out error and its standard error."""
    chosen: list[int] = []
    share = added.count / added.count.sum()
    while len(chosen) < min(MOST_DRIVES, count):
        left = [d for d in range(count) if d not in chosen]
        sets = np.array([[0, *_columns([*chosen, d], order)] for d in left])
        errors = added.left_out(sets, weight)  # (B, C)
        total = share @ errors
        best = int(np.argmin(total))
        chosen = [*chosen, left[best]]
        spread = float(errors[:, best].std(ddof=1)) / np.sqrt(len(errors))
        yield chosen, float(total[best]), spread


def _columns(drives: Sequence[int], order: int) -> list[int]:
    return [1 + order * d + k for d in drives for k in range(order)]
