"""Serial arms under a laser tracker: joints, reflectors, Denavit and Hartenberg's parameters."""

from matstd.importers.arms.dh import arm_from_dh
from matstd.importers.arms.orientation import oriented
from matstd.importers.arms.table import ArmTable, read_arm
from matstd.importers.arms.tracker import ArmImport, import_arm, tracker_run

__all__ = [
    "ArmImport", "ArmTable", "arm_from_dh", "import_arm", "oriented", "read_arm", "tracker_run",
]  # fmt: skip
