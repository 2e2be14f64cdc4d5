"""What a law of the drives has to beat: a constant."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.drift.linear import memory_of
from matstd.diagnosis.drift.record import DriftRecord
from matstd.twin.frames import Array, IntArray


@dataclass(frozen=True, eq=False)
class Constant:
    """The mean of the training part."""

    value: Array  # (K,), base units
    residual: Array  # standard deviation of what is left in training, (K,)
    memory: float  # time in which what is left forgets itself, s

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
