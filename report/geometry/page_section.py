"""The section of a page on the machine's geometry."""

from typing import Any

from matstd.diagnosis.geometry import LearntGeometry
from matstd.report.geometry.copied_numbers import file_lines
from matstd.report.geometry.geometry_words import geometry_lines
from matstd.twin.record import Touches
from matstd.twin.units import UM


def geometry_section(touches: Touches, geometry: LearntGeometry) -> dict[str, Any]:
    """What the template of a page's section on geometry needs."""
    lines = geometry_lines(geometry)
    return {
        "lines": [line for line in lines if line.value != "not determined"],
        "open": [line for line in lines if line.value == "not determined"],
        "ladder": [(s.rung.value, s.rms / UM, s.test_rms / UM) for s in geometry.ladder],
        "corrections": file_lines(touches, geometry),
        "has_before": any(row.before is not None for row in geometry.rows),
    }
