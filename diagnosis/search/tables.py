"""Tables of positions: where an axis is wrong, and not why."""

from collections.abc import Iterable, Iterator

from matstd.twin.library import parse_effect
from matstd.twin.machine import LETTERS
from matstd.twin.model import Effect, traits
from matstd.twin.record import Touches


def contains(effect: Effect, members: Iterable[Effect]) -> bool:
    """Whether an effect is a table by direction, and a member its plain table."""
    own = traits(effect)
    if not own.is_table or own.reversal is None:
        return False
    return own.symbol in {traits(m).symbol for m in members if traits(m).is_table}


def tables_along(touches: Touches, variables: Iterable[str]) -> Iterator[Effect]:
    """Tables of every component of the axes that are among some variables, `X_mm` or `B_deg`."""
    for variable in dict.fromkeys(variables):
        axis, _, unit = variable.rpartition("_")
        if unit in ("mm", "deg") and axis in touches.chain.programmed_axes:
            for letter in LETTERS:
                yield parse_effect(f"position-table(E{letter}{axis})", touches.chain)
