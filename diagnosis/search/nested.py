"""Candidates that hold a member of a set, and so stand in its place or not at all."""

from collections.abc import Iterable

from matstd.twin.model import Effect, traits


def would_hold(effect: Effect, members: Iterable[Effect]) -> bool:
    """Whether an effect is a table by direction of what a member is the plain table of."""
    own = traits(effect)
    if not own.is_table or own.reversal is None:
        return False
    return own.symbol in {traits(m).symbol for m in members if traits(m).is_table}
