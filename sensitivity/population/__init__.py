"""Random machines: distributions of errors, their dependence, and draws from them.

Ranges, shapes and correlations go in (`Population`); drawn machines come out as parameter vectors
of one model, so that their deviations are one product of matrices.
"""

from matstd.sensitivity.population.dependence import Dependence, Group, grouped, product_moment
from matstd.sensitivity.population.distributions import CLASSES, CONSTANT, Distributions, Mix
from matstd.sensitivity.population.sampling import (
    DRAWS_A_CHILD,
    Population,
    coefficients,
    draw,
    drawn_errors,
    drawn_in_chunks,
    drawn_scales,
    shape_columns,
)

__all__ = [
    "CLASSES", "CONSTANT", "DRAWS_A_CHILD", "Dependence", "Distributions", "Group", "Mix",
    "Population", "coefficients", "draw", "drawn_errors", "drawn_in_chunks", "drawn_scales",
    "grouped", "product_moment", "shape_columns",
]  # fmt: skip
