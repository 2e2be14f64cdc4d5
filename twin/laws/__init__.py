"""Laws that are stated by what they look like: a carrier times shapes of variables.

In: the name of a variable, of a shape, of a carrier. Out: `Law`, an effect like any other, but
without a cause. `driver` gives variables of touches by name, `shape` the grammar of curves, `grids`
where their parameters are scanned.
"""

from matstd.twin.laws.carrier import Carrier as Carrier
from matstd.twin.laws.carrier import carrier_of as carrier_of
from matstd.twin.laws.driver import CLOCK as CLOCK
from matstd.twin.laws.driver import ON_BALL as ON_BALL
from matstd.twin.laws.driver import Driver as Driver
from matstd.twin.laws.driver import driver_of as driver_of
from matstd.twin.laws.driver import drivers as drivers
from matstd.twin.laws.grids import WORDS as WORDS
from matstd.twin.laws.grids import grid as grid
from matstd.twin.laws.grids import shapes_of as shapes_of
from matstd.twin.laws.law import KIND as KIND
from matstd.twin.laws.law import Factor as Factor
from matstd.twin.laws.law import Law as Law
from matstd.twin.laws.law import law_of as law_of
from matstd.twin.laws.shape import SHAPES as SHAPES
from matstd.twin.laws.shape import Shape as Shape
from matstd.twin.laws.shape import curve_columns as curve_columns
from matstd.twin.laws.shape import play as play
from matstd.twin.laws.surface import SURFACE_WAVES as SURFACE_WAVES
from matstd.twin.laws.surface import surface_columns as surface_columns
from matstd.twin.laws.surface import surface_products as surface_products
from matstd.twin.laws.surface import surface_waves as surface_waves
