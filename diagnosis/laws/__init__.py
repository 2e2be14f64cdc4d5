"""Laws: what a model leaves, learnt as a carrier times shapes of variables, without a cause.

In: a fit of a model to a run. Out: `Learning`: laws with formula, uncertainty and rivals, and how
well touches that were left out are predicted with them. Curves over every variable screen what the
remainder depends on (`screening`), the grammar of shapes makes formulas of them (`formulas`), and a
formula is kept where it predicts at least as well as the curve (`search`).
"""

from matstd.diagnosis.laws.acceptance import HeldOut, Refusal
from matstd.diagnosis.laws.beginning import log_odds
from matstd.diagnosis.laws.estimates import (
    REPEATED,
    Estimate,
    SecondRun,
    amplitudes,
    curve_of,
    error_left,
    fit_beside,
    partial_residual,
    places,
    second_run,
)
from matstd.diagnosis.laws.learn import learn_laws
from matstd.diagnosis.laws.learnt import Learning, LearntLaw, Rival
from matstd.diagnosis.laws.policy import POLICY, LawPolicy
from matstd.diagnosis.laws.remainder import learn_remainder

__all__ = [
    "POLICY",
    "REPEATED",
    "Estimate",
    "HeldOut",
    "LawPolicy",
    "Learning",
    "LearntLaw",
    "Refusal",
    "Rival",
    "SecondRun",
    "amplitudes",
    "curve_of",
    "error_left",
    "fit_beside",
    "learn_laws",
    "learn_remainder",
    "log_odds",
    "partial_residual",
    "places",
    "second_run",
]
