"""Choosing touches: exchange, groups, relaxed optimum and certificate."""

from information.selection.certificate import Certificate, relaxed, rounded
from information.selection.groups import best_groups
from information.selection.shares import heaviest
from information.selection.touch_selection import (
    DesignCriterion,
    Mask,
    Quota,
    Selection,
    exchange,
    fill,
)

__all__ = [
    "Certificate",
    "DesignCriterion",
    "Mask",
    "Quota",
    "Selection",
    "best_groups",
    "exchange",
    "fill",
    "heaviest",
    "relaxed",
    "rounded",
]
