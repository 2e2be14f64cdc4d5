"""Triangles of a body without needles, face by face in plane charts. No CAD kernel here.

In: edges as curves, faces as outlines in charts of their surfaces. Out: corners and triangles,
joined along the edges, that keep a chord and no small angles.
"""

from matstd.cad_out.triangles.charts import (
    Chart,
    Frame,
    Map,
    arc_step,
    bisected,
    cone,
    cylinder,
    plane_chart,
    revolved_chart,
    scaled_chart,
    torus,
)
from matstd.cad_out.triangles.refinement import Edge, Face, Side, refined

__all__ = [
    "Chart",
    "Edge",
    "Face",
    "Frame",
    "Map",
    "Side",
    "arc_step",
    "bisected",
    "cone",
    "cylinder",
    "plane_chart",
    "refined",
    "revolved_chart",
    "scaled_chart",
    "torus",
]
