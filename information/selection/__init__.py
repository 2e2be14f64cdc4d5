"""Choosing touches: the rows that determine most, among all that could be measured.

Rows of candidates and a criterion go in, a choice comes out: greedy and mended by exchanges
(`touch_selection`), of groups that belong together (`groups`), or by fractions that are nearly the
best possible (`relaxation`), which also bound what any choice could reach (`certificate`). `Quota`
limits how many of a kind are chosen.
"""

from matstd.information.selection.certificate import Certificate as Certificate
from matstd.information.selection.certificate import rounded as rounded
from matstd.information.selection.groups import best_groups as best_groups
from matstd.information.selection.relaxation import relaxed as relaxed
from matstd.information.selection.shares import heaviest as heaviest
from matstd.information.selection.touch_selection import Quota as Quota
from matstd.information.selection.touch_selection import Selection as Selection
from matstd.information.selection.touch_selection import exchange as exchange
from matstd.information.selection.touch_selection import fill as fill
