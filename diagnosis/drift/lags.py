"""Drives at once, and drives that are followed with time constants: columns of linear laws."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.drift.record import DriftRecord, is_speed
from matstd.twin.frames import Array
from matstd.twin.units import MINUTE

LAGS = tuple(minutes * MINUTE for minutes in (4.0, 16.0, 64.0, 256.0))
"""Time constants of first-order lags, s; neighbours, a factor of four apart, imitate any between
them to 5 % of a step.
"""


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
