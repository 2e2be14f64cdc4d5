"""Which set of effects explains a run."""

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
