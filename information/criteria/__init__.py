"""What stays unknown after touches, and the design criteria made of it."""

from information.criteria.design_criterion import (
    DesignCriterion,
    Tangent,
    determinant,
    parameters,
    purpose,
    robust,
    with_potential,
    without_potential,
    worst_pattern,
    worst_pose,
)
from information.criteria.posterior import Posterior, prior_sd_of_tip, whitened

__all__ = [
    "DesignCriterion",
    "Posterior",
    "Tangent",
    "determinant",
    "parameters",
    "prior_sd_of_tip",
    "purpose",
    "robust",
    "whitened",
    "with_potential",
    "without_potential",
    "worst_pattern",
    "worst_pose",
]
