"""Identification: the parameters of a model from a run, with a prior, whatever the noise.

In: a `Run`, a `Model` and a `Prior`. Out: a `Fit` with estimates and their covariance, gross errors
set aside, the size of the noise, and errors of poses that were left out. `estimable` says which
combinations the run determines; `reported` gives parameters as a user reads them.
"""

from matstd.diagnosis.fit.describe import SINE_PREFIX as SINE_PREFIX
from matstd.diagnosis.fit.describe import Reported as Reported
from matstd.diagnosis.fit.describe import Role as Role
from matstd.diagnosis.fit.describe import explained_rms as explained_rms
from matstd.diagnosis.fit.describe import file_unit as file_unit
from matstd.diagnosis.fit.describe import inner_unit as inner_unit
from matstd.diagnosis.fit.describe import reported as reported
from matstd.diagnosis.fit.estimability import Estimable as Estimable
from matstd.diagnosis.fit.estimability import estimable as estimable
from matstd.diagnosis.fit.identification import MAX_PASSES as MAX_PASSES
from matstd.diagnosis.fit.identification import MIN_POSES as MIN_POSES
from matstd.diagnosis.fit.identification import MIN_TOUCHES as MIN_TOUCHES
from matstd.diagnosis.fit.identification import SETTLED_CHANGE as SETTLED_CHANGE
from matstd.diagnosis.fit.identification import Fit as Fit
from matstd.diagnosis.fit.identification import fit_run as fit_run
from matstd.diagnosis.fit.identification import prior_for as prior_for
from matstd.diagnosis.fit.inner import continuous_inner as continuous_inner
from matstd.diagnosis.fit.inner import shifted as shifted
from matstd.diagnosis.fit.inner import spacing as spacing
from matstd.diagnosis.fit.learnt_fit import Learnt as Learnt
from matstd.diagnosis.fit.learnt_fit import averaged as averaged
from matstd.diagnosis.fit.prior import Prior as Prior
from matstd.diagnosis.fit.suited_prior import evidence_of as evidence_of
from matstd.diagnosis.fit.unit_mistakes import MistakenUnit as MistakenUnit
from matstd.diagnosis.fit.unit_mistakes import UnitMistake as UnitMistake
from matstd.diagnosis.fit.unit_mistakes import unit_mistake as unit_mistake
