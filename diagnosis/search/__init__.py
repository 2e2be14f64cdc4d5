"""Which set of effects explains a run.

In: a `DiagnosisTask` (run, starting model, prior) and candidates. Out: a `SearchState`: the best
set of which every member stands, refined, and the structure that it leaves. `search_loop` has the
idea and the way through, `selection` the moves, `members` the tests, `further_parts` what a finding
asks for, `screening` what makes long runs affordable, `edges` gross errors that are none.
"""

from matstd.diagnosis.search.further_parts import tables_along
from matstd.diagnosis.search.members import EffectSubset, Member, Verified, explained
from matstd.diagnosis.search.missing_driver import follows_driver, is_own_sensor, likeliest_drift
from matstd.diagnosis.search.refine import refined, refined_set
from matstd.diagnosis.search.screening import MOST_SETS, WHOLE_BELOW, Budget, Library
from matstd.diagnosis.search.search_loop import (
    SearchState,
    best_set,
    clearly_best,
    most_evident,
    refined_named,
    searched,
)
from matstd.diagnosis.search.selection import Search, is_series
from matstd.diagnosis.search.task import FOUND_PRIOR_FACTOR, DiagnosisTask

__all__ = [
    "FOUND_PRIOR_FACTOR",
    "MOST_SETS",
    "WHOLE_BELOW",
    "Budget",
    "DiagnosisTask",
    "EffectSubset",
    "Library",
    "Member",
    "Search",
    "SearchState",
    "Verified",
    "best_set",
    "clearly_best",
    "explained",
    "follows_driver",
    "is_own_sensor",
    "is_series",
    "likeliest_drift",
    "most_evident",
    "refined",
    "refined_named",
    "refined_set",
    "searched",
    "tables_along",
]
