"""uncertainty.json ("uncertainty/1"): the budget of a measuring task, for other programs."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matstd.diagnosis.task import LEVEL, TaskUncertainty, guarded
from matstd.twin.files import write_whole
from matstd.twin.units import UM

FORMAT = "uncertainty/1"


def uncertainty_table(
    task: str, budgets: Mapping[str, TaskUncertainty], tolerance: float | None = None
) -> dict[str, Any]:
    """Everything of `uncertainty.json`, in the units that stand in its names.

    Args:
        task: Its name.
        budgets: By what results are corrected with: nothing, a model.
        tolerance: Width of the zone, mm; None for none.
    """
    return {
        "format": FORMAT,
        "task": task,
        "level": LEVEL,
        "tolerance_um": None if tolerance is None else _um(tolerance),
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
    write_whole(path, json.dumps(table, indent=1, ensure_ascii=False) + "\n")


def _budget(name: str, one: TaskUncertainty, tolerance: float | None) -> dict[str, Any]:
    out = {
        "model": name,
        "visits": one.visits,
        "places": one.places,
        "faces": one.faces,
        "poses": one.poses,
        "b_um": _um(one.bias),
        "u_cal_um": _um(one.u_cal),
        "u_p_um": _um(one.u_p),
        "u_b_um": _um(one.u_b),
        "u_w_um": _um(one.u_w),
        "spread_um": _um(one.spread),
        "spread_by_calibration_um": _um(one.expected),
        "u_um": _um(one.u),
        "degrees_of_freedom": round(one.dof, 1),
        "k": round(one.k, 3),
        "U_um": _um(one.U),
        "U_uncorrected_um": _um(one.U_uncorrected),
        "by_face": [
            {"feature": face, "mean_um": _um(mean), "spread_um": _um(spread)}
            for face, mean, spread in one.by_face
        ],
    }
    if tolerance is not None:
        zone = guarded(tolerance, one.u, one.dof)
        out["conforms_within_um"] = _um(zone.accepted) if zone.accepted > 0.0 else None
        out["does_not_conform_beyond_um"] = _um(zone.rejected)
    return out


def _um(value: float) -> float:
    return round(value / UM, 4)
