"""Pictures in three dimensions, drawn without a screen in a process of their own.

A renderer without OpenGL ends the process it runs in, so `renderer` starts another one.
"""

from matstd.report.scenes.standard_scene import draw_standard as draw_standard
from matstd.report.scenes.volume_scene import Scene as Scene
from matstd.report.scenes.volume_scene import draw_volumes as draw_volumes
