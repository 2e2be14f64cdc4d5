"""Drives at once, and drives that are followed with time constants: columns of linear laws.

Displacements that change before the speed that drives them show two clocks that do not agree.
"""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.drift.record import DriftRecord, is_speed
from matstd.twin.frames import Array
from matstd.twin.units import HOUR, MINUTE

LAGS = tuple(minutes * MINUTE for minutes in (4.0, 16.0, 64.0, 256.0))
"""Time constants of first-order lags, s; neighbours, a factor of four apart, imitate any between
them to 5 % of a step.
"""

MAX_LEAD = 2.0 * HOUR  # longest lead that is looked for, s

MAX_SHARE_LEFT = 0.8
"""Residual of the changes with the lead over the residual without it, below which the lead counts.
Records of a real and of a simulated spindle leave 0.98 and more at every lead."""


@dataclass(frozen=True)
class Lagged:
    """Drives, each at once (time constant zero) or with a lag."""

    places: tuple[tuple[str, float], ...]  # drive and time constant, s, of every column

    def __call__(self, record: DriftRecord) -> Array:
        """What has followed of every drive, (N, M)."""
        drive = record.columns([name for name, _ in self.places])
        out = np.empty_like(drive)
        for k, (name, tau) in enumerate(self.places):
            out[:, k] = first_order_lag(record, name, tau) if tau > 0.0 else drive[:, k]
        return out


def first_order_lag(record: DriftRecord, drive: str, tau: float) -> Array:
    """A drive after a first-order lag of gain 1, (N,).

    In every stretch anew: at its first row the machine has settled at the temperatures that it has
    there, and is cold where speeds are concerned.

    Args:
        tau: Time constant of the lag, s.
    """
    values = record.columns([drive])[:, 0]
    from scipy.signal import lfilter  # half a second, for lags alone

    pole = np.exp(-record.step / tau)
    out = np.empty_like(values)
    for rows in record.stretches():
        start = 0.0 if is_speed(drive) else values[rows.start]
        out[rows] = start + lfilter([1.0 - pole], [1.0, -pole], values[rows] - start)
    return out


def at_once(record: DriftRecord) -> Lagged:
    """Every drive without memory."""
    return Lagged(tuple((name, 0.0) for name in record.drives))


def lagged_drives(record: DriftRecord, temperatures: bool) -> Lagged:
    """Every temperature at once, and speeds with every lag.

    Args:
        temperatures: Whether temperatures are followed with lags too.
    """
    speeds = [name for name in record.drives if is_speed(name)]
    lagged = list(record.drives) if temperatures else speeds
    plain = tuple((name, 0.0) for name in record.drives if name not in speeds)
    return Lagged((*plain, *((name, tau) for tau in LAGS for name in lagged)))


def lead(record: DriftRecord) -> float:
    """Time by which displacements change before the speed does, s; 0 where they do not.

    Heat cannot come before the speed that makes it. Changes of all displacements from row to row
    are explained by those of lagged speeds, as they are and with the speeds moved to earlier rows.
    A clock that is wrong the other way looks like slow heat and cannot be seen.
    """
    speeds = [d for d in record.drives if is_speed(d) and np.ptp(record.columns([d])) > 0.0]
    if not speeds or not len(record.components):
        return 0.0
    columns = [first_order_lag(record, d, tau) for d in speeds for tau in LAGS[:3]]
    X = np.diff(np.column_stack(columns), axis=0)
    y = np.diff(record.displacement / record.size, axis=0)
    inside = np.diff(record.stretch) == 0
    most = min(int(MAX_LEAD / record.step), len(y) // 4)
    left = [_left(X, y, inside, k, most) for k in range(most + 1)]
    best = int(np.argmin(left))
    return best * record.step if best >= 2 and left[best] < MAX_SHARE_LEFT * left[0] else 0.0


def _left(X: Array, y: Array, inside: np.ndarray, shift: int, most: int) -> float:
    """Sum of squares that speeds leave which are moved to earlier rows."""
    n = len(y) - most
    rows = inside[:n] & inside[shift : shift + n]
    A = np.column_stack([np.ones(rows.sum()), X[shift : shift + n][rows]])
    theta = np.linalg.lstsq(A, y[:n][rows])[0]
    return float(((y[:n][rows] - A @ theta) ** 2).sum() / max(int(rows.sum()), 1))
