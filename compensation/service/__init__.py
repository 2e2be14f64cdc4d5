"""Corrections while the machine moves: readings in, what is added to the linear axes out.

`PointCorrection` corrects one pose in some tens of microseconds from tables of the errors,
`Service` adds what operation needs (temperatures, limits, age, no jumps), `serve` is its OPC UA
server.
"""

from matstd.compensation.service.opcua_server import NAMESPACE as NAMESPACE
from matstd.compensation.service.opcua_server import prompt as prompt
from matstd.compensation.service.opcua_server import serve as serve
from matstd.compensation.service.output import OutputLimits as OutputLimits
from matstd.compensation.service.point_correction import PointCorrection as PointCorrection
from matstd.compensation.service.service import DRIVEN_EVERY as DRIVEN_EVERY
from matstd.compensation.service.service import Service as Service
