"""Which set of effects explains a run.

In: a `DiagnosisTask` (run, starting model, prior) and candidates. Out: a `SearchState`: the best
set of which every member stands, refined, and the structure that it leaves. `search_loop` is the
way through, `selection` the choice, `refine` and `regrid` what a grid is too coarse for,
`screening` what makes long runs affordable, `edges` gross errors that are none.
"""

from matstd.diagnosis.search.budget import MOST_SETS, Budget
from matstd.diagnosis.search.members import Member, Verified
from matstd.diagnosis.search.missing_driver import follows_driver, unrecorded
from matstd.diagnosis.search.refine import refined, refined_set, with_moved_points
from matstd.diagnosis.search.screened import best_set, scaled
from matstd.diagnosis.search.screening import WHOLE_BELOW, Library
from matstd.diagnosis.search.search_loop import (
    SearchState,
    most_evident,
    refined_named,
    search_until_stable,
)
from matstd.diagnosis.search.selection import MAX_LISTED, Search
from matstd.diagnosis.search.tables import tables_along
from matstd.diagnosis.search.task import FREEDOM, DiagnosisTask

__all__ = [
    "FREEDOM",
    "MAX_LISTED",
    "MOST_SETS",
    "WHOLE_BELOW",
    "Budget",
    "DiagnosisTask",
    "Library",
    "Member",
    "Search",
    "SearchState",
    "Verified",
    "best_set",
    "follows_driver",
    "most_evident",
    "refined",
    "refined_named",
    "refined_set",
    "scaled",
    "search_until_stable",
    "tables_along",
    "unrecorded",
    "with_moved_points",
]
