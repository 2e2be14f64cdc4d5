"""Candidates that contain a member of a set, and so replace it or stay out."""

from collections.abc import Iterable

from matstd.twin.model import Effect, traits


def contains(effect: Effect, members: Iterable[Effect]) -> bool:
    """Whether an effect is a table by direction, and a member its plain table."""
    own = traits(effect)
    if not own.is_table or own.reversal is None:
        return False
    return own.symbol in {traits(m).symbol for m in members if traits(m).is_table}
