"""Which set of effects explains a run.

In: a `DiagnosisTask` (run, starting model, prior) and candidates. Out: a `SearchState`: the best
set of which every member stands, refined, and the structure that it leaves. `search_loop` has the
idea and the way through, `selection` the moves, `members` the tests, `further_parts` what a finding
asks for, `screening` what makes long runs affordable, `edges` gross errors that are none.
"""

from matstd.diagnosis.search.further_parts import tables_along as tables_along
from matstd.diagnosis.search.members import EffectSubset as EffectSubset
from matstd.diagnosis.search.members import Verified as Verified
from matstd.diagnosis.search.members import explained as explained
from matstd.diagnosis.search.missing_driver import follows_driver as follows_driver
from matstd.diagnosis.search.missing_driver import is_own_sensor as is_own_sensor
from matstd.diagnosis.search.missing_driver import likeliest_drift as likeliest_drift
from matstd.diagnosis.search.refine import refined as refined
from matstd.diagnosis.search.refine import refined_set as refined_set
from matstd.diagnosis.search.screening import MOST_SETS as MOST_SETS
from matstd.diagnosis.search.screening import WHOLE_BELOW as WHOLE_BELOW
from matstd.diagnosis.search.screening import Budget as Budget
from matstd.diagnosis.search.screening import Library as Library
from matstd.diagnosis.search.search_loop import SearchState as SearchState
from matstd.diagnosis.search.search_loop import clearly_best as clearly_best
from matstd.diagnosis.search.search_loop import most_evident as most_evident
from matstd.diagnosis.search.search_loop import refined_named as refined_named
from matstd.diagnosis.search.search_loop import searched as searched
from matstd.diagnosis.search.selection import Search as Search
from matstd.diagnosis.search.selection import is_series as is_series
from matstd.diagnosis.search.task import FOUND_PRIOR_FACTOR as FOUND_PRIOR_FACTOR
from matstd.diagnosis.search.task import DiagnosisTask as DiagnosisTask
