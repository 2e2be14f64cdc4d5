"""Power of measurements to show an unmodelled, smooth field of deviations.

In: columns of what is explained already, and the field's covariance as a factor, at every
measurement. Out: a `FieldTest` with its threshold, and how probably it finds a given deviation, or
any deviation of a stated covariance. Exact up to a saddlepoint: nothing is simulated.
"""

from matstd.information.power.quadratic import exceedance as exceedance
from matstd.information.power.quadratic import quantile as quantile
from matstd.information.power.smooth_field import FieldTest as FieldTest
from matstd.information.power.smooth_field import decorrelated as decorrelated
from matstd.information.power.smooth_field import field_test as field_test
from matstd.information.power.smooth_field import low_rank as low_rank
