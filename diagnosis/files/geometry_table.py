"""The learnt geometry as it stands in diagnosis.json and comparison.json."""

from typing import Any

from matstd.diagnosis.geometry import Estimate, FoundNumber, GeometryRow, LearntGeometry
from matstd.twin.numbers import significant
from matstd.twin.units import UM, URAD

UNITS = {"mm": ("um", UM), "rad": ("urad", URAD), "1": ("ppm", 1e-6)}
"""Suffix in files of a unit, and one of it in the base unit."""


def geometry_table(geometry: LearntGeometry) -> dict[str, Any]:
    """Every quantity with its uncertainty, the ladder, and corrections to the machine file."""
    return {
        "quantities": [_row(row) for row in geometry.rows],
        "ladder": [
            {
                "model": step.rung.value,
                "rms_um": significant(step.rms / UM),
                "test_rms_um": significant(step.test_rms / UM),
            }
            for step in geometry.ladder
        ],
        "corrections": [
            {
                "key": c.key,
                "stated": list(c.stated),
                "found": [significant(v, 9) for v in c.found],
                "uncertainty": [None if u is None else significant(u) for u in c.u],
                "cannot_be_told_from": [number_table(n) for n in c.rivals],
            }
            for c in geometry.corrections
        ],
        "all_far_lines_cannot_be_told_from": [number_table(n) for n in geometry.together],
    }


def number_table(number: FoundNumber) -> dict[str, Any]:
    """A number of the description, mm or rad."""
    change, u = significant(number.change), significant(number.u)
    return {"name": number.name, "change": change, "uncertainty": u}


def _row(row: GeometryRow) -> dict[str, Any]:
    """One quantity; what the run does not determine has no value."""
    suffix, factor = UNITS[row.unit]
    out: dict[str, Any] = {
        "quantity": row.quantity.value,
        "symbol": row.symbol,
        "axes": list(row.axes),
        "is_determined": row.is_determined,
        f"expected_{suffix}": significant(row.expected / factor),
    }
    if not row.is_determined:
        return out | {
            f"uncertainty_{suffix}": significant(row.estimate.u / factor),
            "shared_with": list(row.shared_with),
        }
    out |= _estimate("", suffix, row.estimate, factor)
    if row.u_model:
        out[f"uncertainty_of_model_{suffix}"] = significant(row.u_model / factor)
    out |= _estimate("at_ends_", "um", row.at_ends, UM)
    out["is_beyond_expected"] = row.is_beyond_expected
    if row.before is not None and row.change is not None:
        out |= _estimate("before_", suffix, row.before, factor)
        out |= _estimate("change_", suffix, row.change, factor)
        out["has_changed"] = row.has_changed
    return out


def _estimate(name: str, suffix: str, estimate: Estimate, factor: float) -> dict[str, float]:
    return {
        f"{name or 'value_'}{suffix}": significant(estimate.value / factor),
        f"{name}uncertainty_{suffix}": significant(estimate.u / factor),
    }
