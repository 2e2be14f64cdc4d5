"""Which set of effects explains a run."""

from diagnosis.search.refine import refined
from diagnosis.search.search_loop import SearchState, Task, rounds, strongest, tuned
from diagnosis.search.selection import CHANCE, LISTED, MOST_SETS, Search, Verified

__all__ = [
    "CHANCE",
    "LISTED",
    "MOST_SETS",
    "Search",
    "SearchState",
    "Task",
    "Verified",
    "refined",
    "rounds",
    "strongest",
    "tuned",
]
