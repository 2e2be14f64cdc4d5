"""One machine over one workspace: everything computed once, and written as files.

`run_study` computes, `write_study` writes; trajectories and volumes are looked at by themselves.
"""

from matstd.sensitivity.study.machine_study import Study, run_study
from matstd.sensitivity.study.points_of_table import PointOverRotary, level, points_over_rotary
from matstd.sensitivity.study.study_file import write_study
from matstd.sensitivity.study.trajectory import AlongPath, Trajectory, along_path, paper_trajectory
from matstd.sensitivity.study.volume_map import Volume, has_volume, volume

__all__ = [
    "AlongPath", "PointOverRotary", "Study", "Trajectory", "Volume", "along_path", "has_volume",
    "level", "paper_trajectory", "points_over_rotary", "run_study", "volume", "write_study",
]  # fmt: skip
