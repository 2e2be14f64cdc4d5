"""Triangles of a body without needles, face by face in plane charts. No CAD kernel here.

In: edges as curves, faces as outlines in charts of their surfaces. Out: corners and triangles,
joined along the edges, that keep a chord and no small angles.
"""

from matstd.cad_out.triangles.charts import Chart as Chart
from matstd.cad_out.triangles.charts import Frame as Frame
from matstd.cad_out.triangles.charts import Map as Map
from matstd.cad_out.triangles.charts import arc_step as arc_step
from matstd.cad_out.triangles.charts import bisected as bisected
from matstd.cad_out.triangles.charts import cone as cone
from matstd.cad_out.triangles.charts import cylinder as cylinder
from matstd.cad_out.triangles.charts import plane_chart as plane_chart
from matstd.cad_out.triangles.charts import revolved_chart as revolved_chart
from matstd.cad_out.triangles.charts import scaled_chart as scaled_chart
from matstd.cad_out.triangles.charts import torus as torus
from matstd.cad_out.triangles.refinement import Edge as Edge
from matstd.cad_out.triangles.refinement import Face as Face
from matstd.cad_out.triangles.refinement import Side as Side
from matstd.cad_out.triangles.refinement import refined as refined
