"""What was measured: touches, set-ups and runs, as arrays."""

from twin.record.copies import counted_once
from twin.record.run import Run
from twin.record.touches import (
    IntArray,
    Labels,
    Setup,
    Touches,
    at_poses,
    computed_deviation,
    linear_approach,
)

__all__ = [
    "IntArray",
    "Labels",
    "Run",
    "Setup",
    "Touches",
    "at_poses",
    "computed_deviation",
    "counted_once",
    "linear_approach",
]
