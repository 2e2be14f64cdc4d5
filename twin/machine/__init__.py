"""Machines in ISO chain notation, error parameters by their ISO 230-1 names, and kinematics.

In: a chain notation and what is known of each axis; readings (N, A). Out: poses and tool points,
exact and to first order in every error. A new shape over a reading goes to `shapes`, a new class of
errors to `ranges`; signs and letters are defined in `symbols` and nowhere else.
"""

from matstd.twin.machine.chain import Axis as Axis
from matstd.twin.machine.chain import Chain as Chain
from matstd.twin.machine.chain import make_chain as make_chain
from matstd.twin.machine.contribution import Contribution as Contribution
from matstd.twin.machine.contribution import Where as Where
from matstd.twin.machine.kinematics import Reach as Reach
from matstd.twin.machine.kinematics import checked_readings as checked_readings
from matstd.twin.machine.kinematics import exact_tip as exact_tip
from matstd.twin.machine.kinematics import inverse_linear as inverse_linear
from matstd.twin.machine.kinematics import linear_directions as linear_directions
from matstd.twin.machine.kinematics import linear_motion as linear_motion
from matstd.twin.machine.kinematics import reach as reach
from matstd.twin.machine.kinematics import table_to_tool as table_to_tool
from matstd.twin.machine.kinematics import tip as tip
from matstd.twin.machine.kinematics import tool_and_directions as tool_and_directions
from matstd.twin.machine.link import Link as Link
from matstd.twin.machine.ranges import DEFAULT_RANGES as DEFAULT_RANGES
from matstd.twin.machine.ranges import Ranges as Ranges
from matstd.twin.machine.ranges import ShapeName as ShapeName
from matstd.twin.machine.ranges import error_class as error_class
from matstd.twin.machine.ranges import shape as shape
from matstd.twin.machine.ranges import sine_argument as sine_argument
from matstd.twin.machine.symbols import LETTERS as LETTERS
from matstd.twin.machine.symbols import Family as Family
from matstd.twin.machine.symbols import Symbol as Symbol
from matstd.twin.machine.symbols import parse_symbol as parse_symbol
