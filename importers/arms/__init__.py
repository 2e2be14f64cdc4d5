"""Serial arms under a laser tracker: joints, reflectors, Denavit and Hartenberg's parameters."""

from matstd.importers.arms.arm_import import ArmImport, import_arm
from matstd.importers.arms.serial_arm import arm_from_dh, joint_readings, tracker_run

__all__ = ["ArmImport", "arm_from_dh", "import_arm", "joint_readings", "tracker_run"]
