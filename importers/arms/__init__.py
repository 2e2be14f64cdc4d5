"""Serial arms under a laser tracker: joints, reflectors, Denavit and Hartenberg's parameters."""

from matstd.importers.arms.arm_mistakes import coupled, likely_mistake
from matstd.importers.arms.serial_arm import arm_from_dh, joint_readings, misfit, tracker_run

__all__ = [
    "arm_from_dh",
    "coupled",
    "joint_readings",
    "likely_mistake",
    "misfit",
    "tracker_run",
]
