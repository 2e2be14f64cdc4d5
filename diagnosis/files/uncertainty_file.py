"""uncertainty.json ("uncertainty/1"): the budget of a measuring task, for other programs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matstd.diagnosis.task import LEVEL, TaskUncertainty, guarded
from matstd.twin.files.whole import write_json
from matstd.twin.numbers import in_um

FORMAT = "uncertainty/1"


def uncertainty_table(
    task: str, budgets: Mapping[str, TaskUncertainty], tolerance: float | None = None
) -> dict[str, Any]:
    """Everything of `uncertainty.json`, in the units that stand in its names.

    Args:
        budgets: By what results are corrected with: nothing, a model.
        tolerance: Width of the zone, mm; None for none.
    """
    return {
        "format": FORMAT,
        "task": task,
        "level": LEVEL,
        "tolerance_um": None if tolerance is None else in_um(tolerance, 4),
        "budgets": [_budget(name, one, tolerance) for name, one in budgets.items()],
    }


def write_uncertainty(
    path: str | Path,
    task: str,
    budgets: Mapping[str, TaskUncertainty],
    tolerance: float | None = None,
) -> None:
    """Write `uncertainty.json`, whole or not at all; arguments as of `uncertainty_table`."""
    table = uncertainty_table(task, budgets, tolerance)
    write_json(path, table)


def _budget(name: str, one: TaskUncertainty, tolerance: float | None) -> dict[str, Any]:
    out = {
        "model": name,
        "visits": one.visits,
        "places": one.places,
        "faces": one.faces,
        "poses": one.poses,
        "b_um": in_um(one.bias, 4),
        "u_cal_um": in_um(one.u_cal, 4),
        "u_p_um": in_um(one.u_p, 4),
        "u_b_um": in_um(one.u_b, 4),
        "u_w_um": in_um(one.u_w, 4),
        "spread_um": in_um(one.spread, 4),
        "spread_by_calibration_um": in_um(one.expected, 4),
        "u_um": in_um(one.u, 4),
        "degrees_of_freedom": round(one.dof, 1),
        "k": round(one.k, 3),
        "U_um": in_um(one.U, 4),
        "U_uncorrected_um": in_um(one.U_uncorrected, 4),
        "by_face": [
            {"feature": face, "mean_um": in_um(mean, 4), "spread_um": in_um(spread, 4)}
            for face, mean, spread in one.by_face
        ],
    }
    if tolerance is not None:
        zone = guarded(tolerance, one.u, one.dof)
        out["conforms_within_um"] = in_um(zone.accepted, 4) if zone.accepted > 0.0 else None
        out["does_not_conform_beyond_um"] = in_um(zone.rejected, 4)
    return out
