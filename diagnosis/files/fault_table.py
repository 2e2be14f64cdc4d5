"""Mistakes in a description as they stand in diagnosis.json and comparison.json."""

from collections.abc import Sequence
from typing import Any

from matstd.diagnosis.faults import DescriptionFault
from matstd.diagnosis.files.geometry_table import number_table
from matstd.twin.numbers import significant
from matstd.twin.units import UM


def fault_table(faults: Sequence[DescriptionFault]) -> list[dict[str, Any]]:
    """Every mistake with its numbers and what undoing it does; lengths in mm, angles in rad."""
    return [_fault(f) | {"cannot_be_told_from": [_fault(a) for a in f.alike]} for f in faults]


def _fault(fault: DescriptionFault) -> dict[str, Any]:
    return {
        "mistake": fault.fault.value,
        "axes": list(fault.axes),
        "chain": fault.notation or None,
        "numbers": [number_table(n) for n in fault.numbers],
        "log_odds": significant(fault.log_odds),
        "test_rms_um": [significant(v / UM) for v in fault.test_rms],
        "errors_over_expected": [significant(v) for v in fault.widened],
    }
