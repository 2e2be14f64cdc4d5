"""The section of a page that tells what was learnt of the machine's geometry."""

from typing import Any

from diagnosis.geometry import LearntGeometry
from report.geometry import correction_line, geometry_lines
from twin.units import UM


def geometry_section(geometry: LearntGeometry) -> dict[str, Any]:
    """What `geometry.html` needs: lines of the table, the ladder, corrections to copy."""
    lines = geometry_lines(geometry)
    return {
        "lines": [line for line in lines if line.value != "not determined"],
        "open": [line for line in lines if line.value == "not determined"],
        "ladder": [(s.rung.value, s.rms / UM, s.test_rms / UM) for s in geometry.ladder],
        "corrections": [correction_line(c) for c in geometry.corrections],
        "has_before": any(row.before is not None for row in geometry.rows),
    }
