"""Serial arms under a laser tracker: joints, reflectors, Denavit and Hartenberg's parameters."""

from matstd.importers.arms.dh import arm_from_dh
from matstd.importers.arms.orientation import oriented
from matstd.importers.arms.table import read_arm
from matstd.importers.arms.tracker import import_arm, tracker_run

__all__ = [
    "arm_from_dh", "import_arm", "oriented", "read_arm", "tracker_run",
]  # fmt: skip
