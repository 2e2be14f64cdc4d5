"""Poses and the statistics at them as columns, in the units of files."""

import numpy as np

from matstd.sensitivity.first_order import NormalLength
from matstd.sensitivity.montecarlo import Volumetric
from matstd.twin.files import reading_columns
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.units import UM


def pose_columns(chain: Chain, q: Array) -> dict[str, Array]:
    """Readings (N, A) of the programmed axes."""
    return {
        column: q[:, chain.axis_index(axis)] / factor
        for axis, (column, factor) in reading_columns(chain).items()
        if chain.link(axis).programmed
    }


def statistics_columns(v: Volumetric, closed: NormalLength) -> dict[str, Array]:
    """Statistics of the volumetric error with their standard errors by sampling."""
    each = {"mean": v.mean, "mean_u": v.mean_u, "sd": v.sd, "rms": closed.rms}
    each["p95_normal"] = closed.p95
    for i, level in enumerate(v.levels):
        each[f"p{100 * level:g}"] = v.quantile[i]
        each[f"p{100 * level:g}_u"] = v.quantile_u[i]
    table = {f"{name}_um": value / UM for name, value in each.items()}
    table |= {"recurrence": v.recurrence, "recurrence_u": v.recurrence_u}
    if np.isfinite(v.tolerance):
        table |= {"exceedance": v.exceedance, "exceedance_u": v.exceedance_u}
    return table
