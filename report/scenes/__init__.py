"""Pictures in three dimensions, drawn without a screen in a process of their own.

Files pass between the two processes, because a renderer without OpenGL ends the process it runs
in; `*_scene` speaks to the rest of the house, `*_render` runs over there.
"""

from matstd.report.scenes.standard_scene import draw_standard
from matstd.report.scenes.volume_scene import Scene, draw_volumes

__all__ = ["Scene", "draw_standard", "draw_volumes"]
