"""`DriftRecord`: what drives a machine thermally and how it drifts, at equal steps of time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array, IntArray
from matstd.twin.numbers import rms
from matstd.twin.units import UM, URAD

SIZE = {"mm": UM, "rad": URAD}
"""Sizes that weigh equally where several components are judged together: 1 µm and 1 µrad."""


@dataclass(frozen=True, eq=False)
class DriftRecord:
    """Temperatures, speeds and displacements of one or several logs at equal steps."""

    time: Array  # of every row since the start of its log, (N,), s
    stretch: IntArray  # number of the stretch without a gap that a row belongs to, (N,), rising
    step: float  # between rows of a stretch, s
    drives: tuple[str, ...]
    drive: Array  # their values, (N, D); degC, 1/min, or the unit of an own column
    components: tuple[str, ...]  # names of the displacements, without unit
    units: tuple[str, ...]  # of each, "mm" or "rad"
    displacement: Array  # (N, K), base units
    remarks: tuple[str, ...] = ()  # what a reader noticed
    # number of the zero that the displacement of a row counts from, (N,); None where all count from
    # one
    zeros: IntArray | None = None

    def __len__(self) -> int:
        return len(self.time)

    @property
    def size(self) -> Array:
        """One micrometre or microradian of every component in base units, (K,)."""
        return np.array([SIZE[unit] for unit in self.units])

    def together(self, values: Array) -> float:
        """Root mean square of values (..., K) over all components, µm or µrad."""
        return rms(values / self.size)

    @property
    def starts(self) -> IntArray:
        """First row of every stretch."""
        return np.flatnonzero(np.diff(self.stretch, prepend=-1))

    def stretches(self) -> list[slice]:
        """Rows of every stretch."""
        ends = [*self.starts[1:].tolist(), len(self)]
        return [slice(a, b) for a, b in zip(self.starts.tolist(), ends, strict=True)]

    def columns(self, names: Sequence[str]) -> Array:
        """Values of some drives, (N, len(names))."""
        return self.drive[:, [self.drives.index(name) for name in names]]

    def centred(self, values: Array, rows: IntArray) -> Array:
        """Values of some rows, (n, M), less their mean where zeros are not known: within each.

        Where all displacements count from one zero they stay as they are.
        """
        if self.zeros is None:
            return values
        out = values.copy()
        zeros = self.zeros[rows]
        for zero in np.unique(zeros):
            own = zeros == zero
            out[own] -= values[own].mean(axis=0)
        return out

    def rezeroed(self, predicted: Array, rows: IntArray | None = None) -> "DriftRecord":
        """The same with every zero of its own moved to where a prediction fits best.

        Args:
            predicted: (N, K), base units.
            rows: At which it shall fit; None for all.
        """
        if self.zeros is None:
            return self
        out = self.displacement.copy()
        rows = np.arange(len(self)) if rows is None else rows
        for zero in np.unique(self.zeros[rows]):
            own = rows[self.zeros[rows] == zero]
            out[self.zeros == zero] += (predicted - self.displacement)[own].mean(axis=0)
        return replace(self, displacement=out)

    def with_noise(self, sd: float, rng: np.random.Generator) -> "DriftRecord":
        """The same with normal noise on every temperature, degC; speeds stay."""
        noise = np.where([is_speed(d) for d in self.drives], 0.0, sd)
        return replace(self, drive=self.drive + noise * rng.standard_normal(self.drive.shape))


def varying(record: DriftRecord, rows: IntArray) -> DriftRecord:
    """The record without drives that are constant over some rows; a remark names them.

    Raises:
        NotEnoughData: None varies.
    """
    varies = np.ptp(record.drive[rows], axis=0) > 0.0
    still = [d for d, v in zip(record.drives, varies, strict=True) if not v]
    if len(still) == len(record.drives):
        raise NotEnoughData("every temperature and speed is constant in the training hours")
    said = (f"{', '.join(still)}: constant in the training hours, left out",) if still else ()
    return replace(
        record,
        drives=tuple(d for d in record.drives if d not in still),
        drive=record.drive[:, varies],
        remarks=(*record.remarks, *said),
    )


def is_speed(drive: str) -> bool:
    """Whether a drive is a speed: of it a cold machine has followed nothing."""
    return drive.endswith("_rpm")


def joined(records: Sequence[DriftRecord], own_zeros: bool = False) -> DriftRecord:
    """Several logs of one machine, one after the other; their drives and components are equal.

    Args:
        own_zeros: Whether displacements of each log count from a zero of its own.
    """
    first = records[0]
    offsets = np.cumsum([0, *(int(r.stretch[-1]) + 1 for r in records[:-1])])
    return replace(
        first,
        time=np.concatenate([r.time for r in records]),
        stretch=np.concatenate([r.stretch + o for r, o in zip(records, offsets, strict=True)]),
        drive=np.concatenate([r.drive for r in records]),
        displacement=np.concatenate([r.displacement for r in records]),
        remarks=tuple(remark for r in records for remark in r.remarks),
        zeros=np.repeat(np.arange(len(records)), [len(r) for r in records]) if own_zeros else None,
    )


def blocks(rows: IntArray, count: int) -> list[IntArray]:
    """Rows cut into blocks of neighbours, which are left out one after the other."""
    return [np.asarray(b) for b in np.array_split(rows, count)]
