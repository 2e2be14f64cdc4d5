"""Identification: the parameters of a model from a run, with a prior, whatever the noise.

In: a `Run`, a `Model` and a `Prior`. Out: a `Fit` with estimates and their covariance, gross errors
set aside, the size of the noise, and errors of poses that were left out. `estimable` says which
combinations the run determines; `reported` gives parameters as a user reads them.
"""

from matstd.diagnosis.fit.describe import (
    SINE_PREFIX,
    Reported,
    Role,
    explained_rms,
    file_unit,
    inner_unit,
    reported,
)
from matstd.diagnosis.fit.estimability import Estimable, estimable
from matstd.diagnosis.fit.identification import (
    MAX_PASSES,
    MIN_POSES,
    MIN_TOUCHES,
    SETTLED_CHANGE,
    Fit,
    fit_run,
    prior_for,
)
from matstd.diagnosis.fit.inner import continuous_inner, shifted, spacing
from matstd.diagnosis.fit.learnt_fit import Learnt, averaged
from matstd.diagnosis.fit.prior import Prior
from matstd.diagnosis.fit.unit_mistakes import MistakenUnit, UnitMistake, unit_mistake

__all__ = [
    "MAX_PASSES",
    "MIN_POSES",
    "MIN_TOUCHES",
    "SETTLED_CHANGE",
    "SINE_PREFIX",
    "Estimable",
    "Fit",
    "Learnt",
    "MistakenUnit",
    "Prior",
    "Reported",
    "Role",
    "UnitMistake",
    "averaged",
    "continuous_inner",
    "estimable",
    "explained_rms",
    "file_unit",
    "fit_run",
    "inner_unit",
    "prior_for",
    "reported",
    "shifted",
    "spacing",
    "unit_mistake",
]
