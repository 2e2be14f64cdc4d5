"""Laws: what a model leaves, learnt as a carrier times shapes of variables, without a cause.

In: a fit of a model to a run. Out: `Learning`: laws with formula, uncertainty and rivals, and how
well touches that were left out are predicted with them. Curves over every variable screen what the
remainder depends on (`screening`), the grammar of shapes makes formulas of them (`formulas`), and a
formula is kept where it predicts at least as well as the curve (`search`).
"""

from matstd.diagnosis.laws.acceptance import HeldOut as HeldOut
from matstd.diagnosis.laws.acceptance import Refusal as Refusal
from matstd.diagnosis.laws.acceptance import memory_score as memory_score
from matstd.diagnosis.laws.beginning import log_odds as log_odds
from matstd.diagnosis.laws.estimates import REPEATED as REPEATED
from matstd.diagnosis.laws.estimates import Estimate as Estimate
from matstd.diagnosis.laws.estimates import SecondRun as SecondRun
from matstd.diagnosis.laws.estimates import amplitudes as amplitudes
from matstd.diagnosis.laws.estimates import curve_of as curve_of
from matstd.diagnosis.laws.estimates import error_left as error_left
from matstd.diagnosis.laws.estimates import fit_beside as fit_beside
from matstd.diagnosis.laws.estimates import partial_residual as partial_residual
from matstd.diagnosis.laws.estimates import places as places
from matstd.diagnosis.laws.estimates import second_run as second_run
from matstd.diagnosis.laws.estimates import surface_of as surface_of
from matstd.diagnosis.laws.learn import learn_laws as learn_laws
from matstd.diagnosis.laws.learnt import Learning as Learning
from matstd.diagnosis.laws.learnt import LearntLaw as LearntLaw
from matstd.diagnosis.laws.learnt import Rival as Rival
from matstd.diagnosis.laws.policy import POLICY as POLICY
from matstd.diagnosis.laws.policy import LawPolicy as LawPolicy
from matstd.diagnosis.laws.remainder import learn_remainder as learn_remainder
