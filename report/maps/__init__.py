"""Pictures of sensitivities over a workspace."""

from report.maps.correlation_picture import draw_ties
from report.maps.maps import draw_maps, unsampled
from report.maps.rotary_picture import level
from report.maps.trajectory_pictures import draw_path

__all__ = [
    "draw_maps",
    "draw_path",
    "draw_ties",
    "level",
    "unsampled",
]
