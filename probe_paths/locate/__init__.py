"""True place of a standard: a search from above, and programs planned again for that place.

In: a standard that stands roughly where it is believed to. Out: a plan of long touches from above
(`plan_search`), from the log of its program the place with its uncertainty (`find_standard`), and
the touches of earlier programs, or those of a planned visit (`read_visit`), planned again there
(`planned_again`). `companions` are the programs that are run beside those of a plan.
"""

from matstd.probe_paths.locate.beside import RAISED as RAISED
from matstd.probe_paths.locate.beside import Companions as Companions
from matstd.probe_paths.locate.beside import companions as companions
from matstd.probe_paths.locate.find import SPREADS as SPREADS
from matstd.probe_paths.locate.find import Found as Found
from matstd.probe_paths.locate.find import Spread as Spread
from matstd.probe_paths.locate.find import find_standard as find_standard
from matstd.probe_paths.locate.planned_visit import PlannedVisit as PlannedVisit
from matstd.probe_paths.locate.planned_visit import VisitSchedule as VisitSchedule
from matstd.probe_paths.locate.planned_visit import planned_again as planned_again
from matstd.probe_paths.locate.planned_visit import read_visit as read_visit
from matstd.probe_paths.locate.search_plan import plan_search as plan_search
