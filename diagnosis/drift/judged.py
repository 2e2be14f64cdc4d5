"""Laws of a drift beside one another: judged by blocks left out, then by hours never seen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from matstd.diagnosis.drift.constant import constant
from matstd.diagnosis.drift.lags import at_once, lagged_drives
from matstd.diagnosis.drift.linear import ridge
from matstd.diagnosis.drift.record import DriftRecord, blocks, is_speed
from matstd.twin.compute import Progress
from matstd.twin.frames import Array, IntArray
from matstd.twin.numbers import rms_of_columns

BLOCKS = 4  # parts of the training hours that are left out in turn: each must hold a load cycle


class Law(Protocol):
    """A law of a drift; `residual` and `memory` are those of what it leaves in training."""

    @property
    def residual(self) -> Array: ...  # noqa: D102

    @property
    def memory(self) -> float: ...  # noqa: D102

    def predicted(self, record: DriftRecord) -> Array:
        """Free run, (N, K), base units."""
        ...

    def leverage(self, record: DriftRecord) -> Array:
        """Variance by unknown coefficients, per unit variance of the residual, (N,)."""
        ...


Fits = Callable[[DriftRecord, Sequence[IntArray]], Law]


@dataclass(frozen=True, eq=False)
class Judged:
    """One law and how it did, root mean squares by component, (K,), base units."""

    name: str
    law: Law  # fitted to all of the training part
    one_step: Array  # in the held-out hours, the displacement of the row before given
    left_out: Array  # free run in blocks of the training part that neither fit nor choice had seen
    free_run: Array
    noisy: Array | None  # the same with noise on the temperatures; None where none was asked for
    factor: Array  # by which left-out blocks miss more than residual and leverage say

    def u(self, record: DriftRecord) -> Array:
        """Standard uncertainty of the free run at every row, (N, K), base units."""
        spread = np.sqrt(1.0 + self.law.leverage(record))
        return self.factor * self.law.residual * spread[:, None]


@dataclass(frozen=True, eq=False)
class JudgedLaws:
    """Laws of a drift beside one another."""

    record: DriftRecord  # all logs as one
    train: IntArray  # rows that the laws were learnt from
    held: IntArray  # rows that were held out
    judged: Sequence[Judged]  # every law with its errors
    best: Judged  # the one that is chosen

    @property
    def hold(self) -> Array:
        """What holding the last value leaves one step ahead, (K,)."""
        step = self.record.displacement[self.held] - self.record.displacement[self.held - 1]
        return rms_of_columns(step)


def offered(record: DriftRecord) -> dict[str, Fits]:
    """Every law that suits a record, by name."""
    laws: dict[str, Fits] = {
        "constant": constant,
        "static-ridge": lambda r, p: ridge(r, at_once(r), p),
    }
    if any(map(is_speed, record.drives)):
        laws["speed-lags"] = lambda r, p: ridge(r, lagged_drives(r, temperatures=False), p)
    laws["lags"] = lambda r, p: ridge(r, lagged_drives(r, temperatures=True), p)
    return laws


def judge(
    record: DriftRecord,
    train: IntArray,
    held: IntArray,
    laws: dict[str, Fits],
    show: Progress,
    noisy: DriftRecord | None = None,
) -> list[Judged]:
    """Fit and judge laws; the choice among them never sees a held-out row.

    Args:
        show: Told which law is at work.
    """
    out = []
    for k, (name, fits) in enumerate(laws.items()):
        show("laws of the drift", k, len(laws))
        out.append(_judged(name, fits, record, train, held, noisy))
    return out


def chosen(judged: Sequence[Judged], record: DriftRecord) -> Judged:
    """The law that predicts left-out blocks of the training part best."""
    return min(judged, key=lambda j: record.together(j.left_out))


def _judged(
    name: str,
    fits: Fits,
    record: DriftRecord,
    train: IntArray,
    held: IntArray,
    noisy: DriftRecord | None,
) -> Judged:
    parts = blocks(train, BLOCKS)
    law = fits(record, parts)
    errors, ratios = [], []
    for i, part in enumerate(parts):
        own = fits(record, [b for j, b in enumerate(parts) if j != i])
        error = record.centred((own.predicted(record) - record.displacement)[part], part)
        errors.append(error)
        spread = np.sqrt(1.0 + own.leverage(record)[part])[:, None]
        ratios.append(error / np.maximum(own.residual * spread, 1e-12))
    free = law.predicted(record)

    def missed(predicted: Array) -> Array:
        return rms_of_columns(record.centred((predicted - record.displacement)[held], held))

    return Judged(
        name=name,
        law=law,
        one_step=rms_of_columns((_one_step(record, free) - record.displacement)[held]),
        left_out=rms_of_columns(np.concatenate(errors)),
        free_run=missed(free),
        noisy=missed(law.predicted(noisy)) if noisy else None,
        factor=rms_of_columns(np.concatenate(ratios)),
    )


def _one_step(record: DriftRecord, free: Array) -> Array:
    """With the displacement of the row before: that plus the change that the law predicts."""
    before = np.maximum(np.arange(len(record)) - 1, 0)
    if record.zeros is not None:  # nothing is known at the first row of a log
        before = np.where(np.diff(record.zeros, prepend=-1) != 0, np.arange(len(record)), before)
    return record.displacement[before] + free - free[before]
