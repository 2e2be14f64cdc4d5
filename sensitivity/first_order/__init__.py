"""What needs no sampling: Jacobians, variance shares, lengths over a workspace, to first order.

Readings of a machine go in; out come the deviation of the tool point per unit of every error
parameter, its covariance over a population and the distribution of its length. `workspace` says
where is looked.
"""

from matstd.sensitivity.first_order.indices import covariance as covariance
from matstd.sensitivity.first_order.indices import rms as rms
from matstd.sensitivity.first_order.indices import variance_parts as variance_parts
from matstd.sensitivity.first_order.indices import variance_shares as variance_shares
from matstd.sensitivity.first_order.jacobians import jacobian as jacobian
from matstd.sensitivity.first_order.jacobians import jacobian_by_parameter as jacobian_by_parameter
from matstd.sensitivity.first_order.jacobians import sensitivity as sensitivity
from matstd.sensitivity.first_order.normal_lengths import NormalLength as NormalLength
from matstd.sensitivity.first_order.normal_lengths import normal_length as normal_length
from matstd.sensitivity.first_order.workspace import Box as Box
from matstd.sensitivity.first_order.workspace import Workspace as Workspace
from matstd.sensitivity.first_order.workspace import latin_hypercube as latin_hypercube
from matstd.sensitivity.first_order.workspace import section as section
