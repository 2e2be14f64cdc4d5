"""Machines in ISO chain notation, error parameters by their ISO 230-1 names, and kinematics.

In: a chain notation and what is known of each axis; readings (N, A). Out: poses and tool points,
exact and to first order in every error. A new shape over a reading goes to `shapes`, a new class of
errors to `ranges`; signs and letters are defined in `symbols` and nowhere else.
"""

from matstd.twin.machine.chain import Axis, Chain, make_chain
from matstd.twin.machine.contribution import Contribution, Where
from matstd.twin.machine.kinematics import (
    Reach,
    checked_readings,
    exact_tip,
    inverse_linear,
    linear_directions,
    linear_motion,
    reach,
    table_to_tool,
    tip,
    tool_and_directions,
)
from matstd.twin.machine.link import Link
from matstd.twin.machine.ranges import (
    DEFAULT_RANGES,
    Ranges,
    ShapeName,
    error_class,
    shape,
    sine_argument,
)
from matstd.twin.machine.symbols import LETTERS, Family, Symbol, parse_symbol

__all__ = [
    "DEFAULT_RANGES", "LETTERS", "Axis", "Chain", "Contribution", "Family", "Link",
    "Ranges", "Reach", "ShapeName", "Symbol", "Where", "checked_readings", "error_class",
    "exact_tip", "inverse_linear", "linear_directions", "linear_motion", "make_chain",
    "parse_symbol", "reach", "shape", "sine_argument", "table_to_tool", "tip",
    "tool_and_directions",
]  # fmt: skip
