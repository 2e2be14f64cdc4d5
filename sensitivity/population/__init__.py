"""Random machines: distributions of errors, their dependence, and draws from them.

Ranges, shapes and correlations go in (`Population`); drawn machines come out as parameter vectors
of one model, so that their deviations are one product of matrices.
"""

from matstd.sensitivity.population.dependence import Dependence as Dependence
from matstd.sensitivity.population.dependence import Group as Group
from matstd.sensitivity.population.dependence import grouped as grouped
from matstd.sensitivity.population.dependence import product_moment as product_moment
from matstd.sensitivity.population.distributions import CLASSES as CLASSES
from matstd.sensitivity.population.distributions import CONSTANT as CONSTANT
from matstd.sensitivity.population.distributions import Distributions as Distributions
from matstd.sensitivity.population.distributions import Mix as Mix
from matstd.sensitivity.population.sampling import DRAWS_A_CHILD as DRAWS_A_CHILD
from matstd.sensitivity.population.sampling import Population as Population
from matstd.sensitivity.population.sampling import coefficients as coefficients
from matstd.sensitivity.population.sampling import draw as draw
from matstd.sensitivity.population.sampling import drawn_errors as drawn_errors
from matstd.sensitivity.population.sampling import drawn_in_chunks as drawn_in_chunks
from matstd.sensitivity.population.sampling import drawn_scales as drawn_scales
from matstd.sensitivity.population.sampling import shape_columns as shape_columns
