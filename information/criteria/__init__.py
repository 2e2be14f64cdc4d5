"""What stays unknown after touches, and the design criteria made of it.

Whitened rows of touches go in; out come the posterior of a machine's parameters and criteria that a
choice of touches can be made for. A new criterion is a new `Measure` (`measures.py`) with one of
the two tangents (`tangents.py`).
"""

from matstd.information.criteria.design_criterion import DesignCriterion as DesignCriterion
from matstd.information.criteria.design_criterion import five_criteria as five_criteria
from matstd.information.criteria.design_criterion import mean_prediction as mean_prediction
from matstd.information.criteria.design_criterion import robust as robust
from matstd.information.criteria.design_criterion import with_potential as with_potential
from matstd.information.criteria.posterior import Posterior as Posterior
from matstd.information.criteria.posterior import prior_sd_of_tip as prior_sd_of_tip
from matstd.information.criteria.posterior import whitened as whitened
from matstd.information.criteria.tangents import RowStep as RowStep
from matstd.information.criteria.tangents import Tangent as Tangent
