"""What a model leaves: patterns, regions, tests for structure.

In: a `Fit` or an `EffectSet`. Out: the `Structure` and the `Region`s of its
residual and a `Remark` for everything noteworthy; `partial` is what the run shows of one effect.
A new test is a module beside `waves` and `crowds`, called by `structure`.
"""

from matstd.diagnosis.residual.boxes import Condition as Condition
from matstd.diagnosis.residual.boxes import Side as Side
from matstd.diagnosis.residual.carriers import Bearer as Bearer
from matstd.diagnosis.residual.carriers import apart_elsewhere as apart_elsewhere
from matstd.diagnosis.residual.carriers import bearers as bearers
from matstd.diagnosis.residual.failing_regions import Region as Region
from matstd.diagnosis.residual.failing_regions import Wrong as Wrong
from matstd.diagnosis.residual.failing_regions import observed_error as observed_error
from matstd.diagnosis.residual.failing_regions import regions as regions
from matstd.diagnosis.residual.mean_displacements import has_poses as has_poses
from matstd.diagnosis.residual.mean_displacements import pose_vectors as pose_vectors
from matstd.diagnosis.residual.partial_residuals import MIN_VIEW as MIN_VIEW
from matstd.diagnosis.residual.partial_residuals import Partial as Partial
from matstd.diagnosis.residual.partial_residuals import Seen as Seen
from matstd.diagnosis.residual.partial_residuals import partial as partial
from matstd.diagnosis.residual.pattern_tests import PatternTests as PatternTests
from matstd.diagnosis.residual.patterns import directions as directions
from matstd.diagnosis.residual.patterns import groups as groups
from matstd.diagnosis.residual.patterns import variables as variables
from matstd.diagnosis.residual.ranked_variables import RankedVariable as RankedVariable
from matstd.diagnosis.residual.ranked_variables import binned as binned
from matstd.diagnosis.residual.ranked_variables import rank_variables as rank_variables
from matstd.diagnosis.residual.ranked_variables import standardised as standardised
from matstd.diagnosis.residual.structure import Shape as Shape
from matstd.diagnosis.residual.structure import Structure as Structure
from matstd.diagnosis.residual.structure import find_structure as find_structure
