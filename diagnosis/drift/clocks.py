"""Whether displacements answer before what drives them: two clocks that do not agree."""

import numpy as np

from matstd.diagnosis.drift.lags import LAGS, first_order_lag
from matstd.diagnosis.drift.record import DriftRecord, is_speed
from matstd.twin.frames import Array
from matstd.twin.units import HOUR

MAX_LEAD = 2.0 * HOUR  # longest lead that is looked for, s

MAX_SHARE_LEFT = 0.8
"""Residual of the changes with the lead over the residual without it, below which the lead counts.
Records of a real and of a simulated spindle leave 0.98 and more at every lead."""


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
