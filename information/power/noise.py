"""Noise with memory, as a scan has it, turned into independent noise of size one."""

import numpy as np

from matstd.twin.frames import Array


def decorrelated(columns: Array, u: Array, memory: Array) -> Array:
    """Columns in units of independent noise, (N, K).

    The noise of row i is ``e_i = m_i e_(i-1) u_i / u_(i-1) + sqrt(1 - m_i^2) u_i z_i``, z
    independent; what the row before already showed of it is subtracted.

    Args:
        columns: Deviations in mm, (N, K), in the order of the measurement.
        u: Standard uncertainty of every row, (N,), mm.
        memory: Correlation of the noise with that of the row before, (N,); 0 for a touch and at the
            start of a line.
    """
    scaled = columns / u[:, None]
    before = np.concatenate([np.zeros((1, scaled.shape[1])), scaled[:-1]])
    return np.asarray((scaled - memory[:, None] * before) / np.sqrt(1.0 - memory**2)[:, None])
