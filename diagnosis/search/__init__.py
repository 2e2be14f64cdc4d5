"""Which set of effects explains a run."""

from diagnosis.search.refine import refined
from diagnosis.search.rounds import Round, Task, rounds, strongest, tuned
from diagnosis.search.selection import CHANCE, LISTED, MOST_SETS, Search, Verified

__all__ = [
    "CHANCE",
    "LISTED",
    "MOST_SETS",
    "Round",
    "Search",
    "Task",
    "Verified",
    "refined",
    "rounds",
    "strongest",
    "tuned",
]
