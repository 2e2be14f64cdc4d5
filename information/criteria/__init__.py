"""What stays unknown after touches, and the design criteria made of it.

Whitened rows of touches go in; out come the posterior of a machine's parameters and criteria that a
choice of touches can be made for. A new criterion is a new `Measure` (`measures.py`) with one of
the two tangents (`tangents.py`).
"""

from matstd.information.criteria.design_criterion import (
    DesignCriterion,
    five_criteria,
    mean_prediction,
    robust,
    with_potential,
)
from matstd.information.criteria.posterior import Posterior, prior_sd_of_tip, whitened
from matstd.information.criteria.tangents import RowStep, Tangent

__all__ = [
    "DesignCriterion", "Posterior", "RowStep", "Tangent", "five_criteria", "mean_prediction",
    "prior_sd_of_tip", "robust", "whitened", "with_potential",
]  # fmt: skip
