"""Serial arms under a laser tracker: joints, reflectors, Denavit and Hartenberg's parameters."""

from matstd.importers.arms.dh import arm_from_dh as arm_from_dh
from matstd.importers.arms.orientation import oriented as oriented
from matstd.importers.arms.table import read_arm as read_arm
from matstd.importers.arms.tracker import import_arm as import_arm
from matstd.importers.arms.tracker import tracker_run as tracker_run
