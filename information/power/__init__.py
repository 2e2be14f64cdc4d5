"""Power of measurements to show an unmodelled, smooth field of deviations.

In: columns of what is explained already, and the field's covariance as a factor, at every
measurement. Out: a `FieldTest` with its threshold, and how probably it finds a given deviation, or
any deviation of a stated covariance. Exact up to a saddlepoint: nothing is simulated.
"""

from matstd.information.power.quadratic import exceedance, quantile
from matstd.information.power.smooth_field import FieldTest, decorrelated, field_test, low_rank

__all__ = ["FieldTest", "decorrelated", "exceedance", "field_test", "low_rank", "quantile"]
