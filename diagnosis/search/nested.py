"""Candidates that hold a member of a set, and so stand in its place or not at all."""

from collections.abc import Iterable

from matstd.twin.effects import PositionTable
from matstd.twin.model import Effect


def would_hold(effect: Effect, members: Iterable[Effect]) -> bool:
    """Whether an effect is a table by direction of what a member is the plain table of."""
    if not (isinstance(effect, PositionTable) and effect.by_direction):
        return False
    tables = {m.symbol for m in members if isinstance(m, PositionTable)}
    return effect.symbol in tables
