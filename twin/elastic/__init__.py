"""Elastic bodies: beams under weight and load, compliant axes, stiffness at the tool point.

One kind a file, as in `effects`; `section` and `beam` are the mechanics. Weights need a section and
a material, so a `beam` is stated by the user and never proposed.
"""

from matstd.twin.elastic.body import short_beams as short_beams
from matstd.twin.elastic.materials import MATERIALS as MATERIALS
from matstd.twin.elastic.materials import Material as Material
from matstd.twin.elastic.materials import material as material
