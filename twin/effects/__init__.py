"""The library of effects, one kind a file: a class with its formula and a `Kind` that describes it.

A new effect is a new file here and one line in `matstd.twin.library.catalogue`; the exact twin, the
fit, the search and the reports know it from then on.
"""

from matstd.twin.effects.geometric import ComponentError as ComponentError
from matstd.twin.effects.geometric import HigherOrder as HigherOrder
from matstd.twin.effects.geometric import component as component
from matstd.twin.effects.location import LocationError as LocationError
from matstd.twin.effects.periodic import MAX_OVERTONES as MAX_OVERTONES
from matstd.twin.effects.periodic import grid_distance as grid_distance
from matstd.twin.effects.periodic import usual_distance as usual_distance
from matstd.twin.effects.probe import ProbeRadius as ProbeRadius
from matstd.twin.effects.probe import normal_in_tool as normal_in_tool
from matstd.twin.effects.repeated import MARK as MARK
from matstd.twin.effects.repeated import Change as Change
from matstd.twin.effects.repeated import Repeated as Repeated
from matstd.twin.effects.repeated import repeat as repeat
from matstd.twin.effects.setup_error import SHIFT_SD as SHIFT_SD
from matstd.twin.effects.setup_error import TURN_SD as TURN_SD
from matstd.twin.effects.setup_error import Free as Free
from matstd.twin.effects.setup_error import body_errors as body_errors
from matstd.twin.effects.setup_error import further_styli as further_styli
from matstd.twin.effects.setup_error import placing_errors as placing_errors
from matstd.twin.effects.setup_error import setup_errors as setup_errors
