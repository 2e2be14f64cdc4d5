"""Laws that are stated by what they look like: a carrier times shapes of variables.

In: the name of a variable, of a shape, of a carrier. Out: `Law`, an effect like any other, but
without a cause. `driver` gives variables of touches by name, `shape` the grammar of curves, `grids`
where their parameters are scanned.
"""

from matstd.twin.laws.carrier import Carrier, carrier_of
from matstd.twin.laws.driver import CLOCK, ON_BALL, Driver, driver_of, drivers
from matstd.twin.laws.grids import WORDS, grid, shapes_of
from matstd.twin.laws.law import KIND, Factor, Law, law_of
from matstd.twin.laws.shape import SHAPES, Shape, curve_columns, play

__all__ = [
    "CLOCK",
    "KIND",
    "ON_BALL",
    "SHAPES",
    "WORDS",
    "Carrier",
    "Driver",
    "Factor",
    "Law",
    "Shape",
    "carrier_of",
    "curve_columns",
    "driver_of",
    "drivers",
    "grid",
    "law_of",
    "play",
    "shapes_of",
]
