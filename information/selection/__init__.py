"""Choosing touches: the rows that determine most, among all that could be measured.

Rows of candidates and a criterion go in, a choice comes out: greedy and mended by exchanges
(`touch_selection`), of groups that belong together (`groups`), or by fractions that are nearly the
best possible (`relaxation`), which also bound what any choice could reach (`certificate`). `Quota`
limits how many of a kind are chosen.
"""

from matstd.information.selection.certificate import Certificate, rounded
from matstd.information.selection.groups import best_groups
from matstd.information.selection.relaxation import relaxed
from matstd.information.selection.shares import heaviest
from matstd.information.selection.touch_selection import Quota, Selection, exchange, fill

__all__ = [
    "Certificate", "Quota", "Selection", "best_groups", "exchange", "fill", "heaviest",
    "relaxed", "rounded",
]  # fmt: skip
