"""Pictures in three dimensions, drawn in a process of their own."""

from report.scenes.standard_scene import draw_standard
from report.scenes.volume_scene import Scene, draw_volumes

__all__ = ["Scene", "draw_standard", "draw_volumes"]
