"""Which set of effects explains a run.

In: a `DiagnosisTask` (run, starting model, prior) and candidates. Out: a `SearchState`: the best
set of which every member stands, refined, and the structure that it leaves. `search_loop` is the
way through, `selection` the choice, `refine` and `regrid` what a grid is too coarse for,
`screening` what makes long runs affordable, `edges` gross errors that are none.
"""

from diagnosis.search.refine import refined
from diagnosis.search.search_loop import (
    DiagnosisTask,
    SearchState,
    most_evident,
    refined_named,
    search_until_stable,
)
from diagnosis.search.selection import CHANCE, LISTED, MOST_SETS, Search, Verified

__all__ = [
    "CHANCE",
    "LISTED",
    "MOST_SETS",
    "DiagnosisTask",
    "Search",
    "SearchState",
    "Verified",
    "most_evident",
    "refined",
    "refined_named",
    "search_until_stable",
]
