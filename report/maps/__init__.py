"""Pictures of sensitivities and volumetric error: over a workspace, and along a trajectory.

Each takes a `Study` and a folder, and returns files with captions; none computes more than what it
draws. A new map goes into the list in `study_maps.draw_maps`.
"""

from matstd.report.maps.correlation_picture import draw_ties as draw_ties
from matstd.report.maps.regions_picture import draw_regions as draw_regions
from matstd.report.maps.study_maps import draw_maps as draw_maps
from matstd.report.maps.study_maps import shows_more as shows_more
from matstd.report.maps.trajectory_pictures import draw_path as draw_path
