"""Corrections while the machine moves: readings in, what is added to the linear axes out.

`PointCorrection` corrects one pose in some tens of microseconds from tables of the errors,
`Service` adds what operation needs (temperatures, limits, age, no jumps), `serve` is its OPC UA
server.
"""

from matstd.compensation.service.opcua_server import NAMESPACE, prompt, serve
from matstd.compensation.service.output import OutputLimits
from matstd.compensation.service.point_correction import PointCorrection
from matstd.compensation.service.service import DRIVEN_EVERY, Service

__all__ = [
    "DRIVEN_EVERY",
    "NAMESPACE",
    "OutputLimits",
    "PointCorrection",
    "Service",
    "prompt",
    "serve",
]
