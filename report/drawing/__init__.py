"""The drawing of a standard as a workshop and a calibration laboratory get it, PDF and SVG.

In: a `Standard` with its `Details`. Out: one sheet of three views, two sections, dimensions,
datums, tolerances, roughness, tables of faces, balls and holes with their purpose, title block.
Everything is drawn from the design itself, at its scale, and not from a mesh.
"""

from matstd.report.drawing.drawing import write_drawing as write_drawing
from matstd.report.drawing.tables import Issuer as Issuer
