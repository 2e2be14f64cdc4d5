"""What changed between several runs as it stands in diagnosis.json."""

from typing import Any

from matstd.diagnosis.answer import RunErrors, Trend
from matstd.diagnosis.files.geometry_table import UNITS
from matstd.diagnosis.geometry import Estimate
from matstd.twin.numbers import significant
from matstd.twin.units import UM


def trend_table(trend: Trend) -> dict[str, Any]:
    """Every run with its errors, and every quantity of the geometry run by run."""
    return {
        "runs": [_run(run, i in trend.changed) for i, run in enumerate(trend.runs)],
        "quantities": [_row(trend, k) for k, row in enumerate(trend.rows) if any(row.course)],
    }


def _run(run: RunErrors, has_changed: bool) -> dict[str, Any]:
    return {
        "run": run.name,
        "touches": run.touches,
        "is_held_out": run.is_held_out,
        "has_changed": has_changed,
        "rms_um": _um(run.rms),
        "test_rms_um": _um(run.test_rms),
        "left_out_rms_um": _um(run.left_out),
    }


def _um(value: float | None) -> float | None:
    return None if value is None else significant(value / UM)


def _row(trend: Trend, k: int) -> dict[str, Any]:
    """One quantity; what a run does not determine is null."""
    row, later = trend.rows[k], range(1, len(trend.runs))
    suffix, factor = UNITS[row.unit]
    best = {i: trend.known_best(i)[k] for i in later}
    changes = [None, *(best[i].steps[i - 1] for i in later)]
    return {
        "quantity": row.quantity.value,
        "symbol": row.symbol,
        "axes": list(row.axes),
        f"value_{suffix}": [_number(e, factor) for e in row.course],
        f"value_uncertainty_{suffix}": [_u(e, factor) for e in row.course],
        f"change_{suffix}": [_number(e, factor) for e in changes],
        f"change_uncertainty_{suffix}": [_u(e, factor) for e in changes],
        "has_changed_into": [trend.runs[i].name for i in later if best[i].has_changed_into(i)],
    }


def _number(estimate: Estimate | None, factor: float) -> float | None:
    return None if estimate is None else significant(estimate.value / factor)


def _u(estimate: Estimate | None, factor: float) -> float | None:
    return None if estimate is None else significant(estimate.u / factor)
