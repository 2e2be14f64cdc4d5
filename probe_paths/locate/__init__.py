"""True place of a standard: a search from above, and programs planned again for that place.

In: a standard that stands roughly where it is believed to. Out: a plan of long touches from above
(`plan_search`), from the log of its program the place with its uncertainty (`find_standard`), and
the touches of earlier programs, or those of a planned visit (`read_visit`), planned again there
(`planned_again`). `companions` are the programs that are run beside those of a plan.
"""

from matstd.probe_paths.locate.beside import RAISED, Companions, companions
from matstd.probe_paths.locate.find import SPREADS, Found, Spread, find_standard
from matstd.probe_paths.locate.planned_visit import (
    PlannedVisit,
    VisitSchedule,
    planned_again,
    read_visit,
)
from matstd.probe_paths.locate.search_plan import plan_search

__all__ = [
    "RAISED",
    "SPREADS",
    "Companions",
    "Found",
    "PlannedVisit",
    "Spread",
    "VisitSchedule",
    "companions",
    "find_standard",
    "plan_search",
    "planned_again",
    "read_visit",
]
