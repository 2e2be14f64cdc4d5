"""What needs no sampling: Jacobians, variance shares, lengths over a workspace, to first order.

Readings of a machine go in; out come the deviation of the tool point per unit of every error
parameter, its covariance over a population and the distribution of its length. `workspace` says
where is looked.
"""

from matstd.sensitivity.first_order.indices import covariance, rms, variance_parts, variance_shares
from matstd.sensitivity.first_order.jacobians import jacobian, jacobian_by_parameter, sensitivity
from matstd.sensitivity.first_order.normal_lengths import NormalLength, normal_length
from matstd.sensitivity.first_order.workspace import Box, Workspace, latin_hypercube, section

__all__ = [
    "Box", "NormalLength", "Workspace", "covariance", "jacobian", "jacobian_by_parameter",
    "latin_hypercube", "normal_length", "rms", "section", "sensitivity", "variance_parts",
    "variance_shares",
]  # fmt: skip
