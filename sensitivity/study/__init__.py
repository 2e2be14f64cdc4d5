"""One machine over one workspace: everything computed once, and written as files.

`run_study` computes, `write_study` writes; trajectories and volumes are looked at by themselves.
"""

from matstd.sensitivity.study.machine_study import Study as Study
from matstd.sensitivity.study.machine_study import run_study as run_study
from matstd.sensitivity.study.points_of_table import PointOverRotary as PointOverRotary
from matstd.sensitivity.study.points_of_table import level as level
from matstd.sensitivity.study.points_of_table import points_over_rotary as points_over_rotary
from matstd.sensitivity.study.study_file import write_study as write_study
from matstd.sensitivity.study.trajectory import AlongPath as AlongPath
from matstd.sensitivity.study.trajectory import Trajectory as Trajectory
from matstd.sensitivity.study.trajectory import along_path as along_path
from matstd.sensitivity.study.trajectory import paper_trajectory as paper_trajectory
from matstd.sensitivity.study.volume_map import Volume as Volume
from matstd.sensitivity.study.volume_map import has_volume as has_volume
from matstd.sensitivity.study.volume_map import volume as volume
