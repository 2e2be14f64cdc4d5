"""What a dynamic law has to beat: a constant, and the ARX law as it is fitted in many papers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.drift.linear import memory_of
from matstd.diagnosis.drift.record import DriftRecord, IntArray
from matstd.twin.frames import Array

LARGEST_POLE = 1.0 - 1e-6
"""A free run with a pole beyond it grows, or remembers its first reading for ever."""


@dataclass(frozen=True, eq=False)
class Constant:
    """The mean of the training part.

    Attributes:
        value: (K,), base units.
        residual: Standard deviation of what is left in training, (K,).
        memory: Time in which what is left forgets itself, s.
    """

    value: Array
    residual: Array
    memory: float

    def predicted(self, record: DriftRecord) -> Array:
        """The same everywhere, (N, K)."""
        return np.tile(self.value, (len(record), 1))

    def leverage(self, record: DriftRecord) -> Array:
        """Nothing: one number of so many rows is known, (N,)."""
        return np.zeros(len(record))


def constant(record: DriftRecord, parts: Sequence[IntArray]) -> Constant:
    """The mean over blocks."""
    rows = np.concatenate(parts)
    y = record.displacement[rows]
    left = record.centred(y - y.mean(axis=0), rows)
    return Constant(y.mean(axis=0), left.std(axis=0), memory_of(left / record.size, record.step))


@dataclass(frozen=True, eq=False)
class OneStepArx:
    """``y(t) = a y(t-1) + b . drives(t) + c`` of each component, by least squares of one step.

    Attributes:
        a: Its pole, (K,).
        b: (D, K), base units per unit of the drive.
        constant: (K,).
        residual: Standard deviation of what a free run leaves in training, (K,).
        memory: Time in which that forgets itself, s.
    """

    a: Array
    b: Array
    constant: Array
    residual: Array
    memory: float

    @property
    def pole(self) -> float:
        """The largest; 1 and more is unstable."""
        return float(np.abs(self.a).max())

    @property
    def is_stable(self) -> bool:
        """Whether a free run forgets where it began."""
        return self.pole < LARGEST_POLE

    def predicted(self, record: DriftRecord) -> Array:
        """Free run from the first displacement of every stretch, (N, K)."""
        added = record.drive @ self.b + self.constant
        out = record.displacement.copy()
        for rows in record.stretches():
            for t in range(rows.start + 1, rows.stop):
                out[t] = self.a * out[t - 1] + added[t]
        return out

    def one_step(self, record: DriftRecord) -> Array:
        """Every row from the measured displacement of the row before, (N, K)."""
        before = record.displacement[np.maximum(np.arange(len(record)) - 1, 0)]
        return self.a * before + record.drive @ self.b + self.constant

    def leverage(self, record: DriftRecord) -> Array:
        """Not known, so nothing, (N,)."""
        return np.zeros(len(record))


def one_step_arx(record: DriftRecord, parts: Sequence[IntArray]) -> OneStepArx:
    """The law with all drives, p = q = 1."""
    rows = np.concatenate(parts)
    known = np.zeros(len(record), dtype=bool)
    known[rows] = True
    starts = np.zeros(len(record), dtype=bool)
    starts[record.starts] = True
    t = np.flatnonzero(known & np.roll(known, 1) & ~starts)
    mean = record.drive[t].mean(axis=0)
    y = record.displacement
    theta = [
        np.linalg.lstsq(
            np.column_stack([y[t - 1, k], np.ones(len(t)), record.drive[t] - mean]), y[t, k]
        )[0]
        for k in range(y.shape[1])
    ]
    a, c = np.array([v[0] for v in theta]), np.array([v[1] for v in theta])
    b = np.transpose([v[2:] for v in theta])
    law = OneStepArx(a=a, b=b, constant=c - mean @ b, residual=np.zeros(len(a)), memory=record.step)
    if not law.is_stable:
        return law
    left = y[rows] - law.predicted(record)[rows]
    memory = memory_of(left / record.size, record.step)
    return replace(law, residual=left.std(axis=0), memory=memory)
