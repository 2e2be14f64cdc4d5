"""Errors of a touch probe: lobes, effective radius, bending of the stylus."""

from dataclasses import dataclass

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.model import Amounts, Declared, Kind, Parameter, scanned
from matstd.twin.record import Touches
from matstd.twin.units import UM


def normal_in_tool(touches: Touches) -> Array:
    """Outward normals in the tool frame, (N, 3); the probe approaches against them."""
    tool_axes = touches.reach.twist[:, touches.chain.link_index("t"), :3]
    return np.einsum("nki,ni->nk", tool_axes, touches.normal_table)


@dataclass(frozen=True)
class ProbeLobing(Declared):
    """Pre-travel that varies with the direction in which the stylus is deflected.

    theta and phi are latitude from the tool axis and azimuth of the surface normal in the tool
    frame; k = 3 for the three seats of a kinematic probe.
    """

    # one lobe is the offset of the stylus
    lobes: float = scanned("1", np.arange(2.0, 7.0), default=3.0, continuous=False)

    kind, called, carrier, acts_on = "probe-lobing", "lobes of the probe", "probe", "bias"
    parameters = (Parameter("cos", "mm", 3 * UM), Parameter("sin", "mm", 3 * UM))

    def amounts(self, touches: Touches) -> Amounts:
        n = normal_in_tool(touches)
        sideways = np.hypot(n[:, 0], n[:, 1])
        phi = np.arctan2(n[:, 1], n[:, 0])
        return (sideways * np.cos(self.lobes * phi), sideways * np.sin(self.lobes * phi))


@dataclass(frozen=True)
class ProbeRadius(Declared):
    """Effective radius of the ball minus the radius that is stated.

    A larger ball meets the surface earlier, by as much along every normal; a pre-travel v t_d that
    is the same in every direction makes it smaller.
    """

    kind, called, carrier, acts_on = "probe-radius", "effective radius of the ball", "probe", "bias"
    stated_number = "radius"
    parameters = (Parameter("amplitude", "mm", 5 * UM),)

    def amounts(self, touches: Touches) -> Amounts:
        return (np.ones(len(touches)),)


@dataclass(frozen=True)
class StylusBending(Declared):
    """Bending of the stylus, which grows with the latitude of the touch.

    The trigger force bends a stylus of length l by ``F l^3/(3 E I)`` times sin(theta), of which
    sin(theta) lies along the normal. Positive where the surface is seen outside.
    """

    kind, called, carrier, acts_on = "stylus-bending", "bending of the stylus", "probe", "bias"
    parameters = (Parameter("amplitude", "mm", 5 * UM),)

    def amounts(self, touches: Touches) -> Amounts:
        n = normal_in_tool(touches)
        return (n[:, 0] ** 2 + n[:, 1] ** 2,)


def _touching(touches: Touches) -> bool:
    """Whether a ball touched a standard; a laser or a tracker has no stylus."""
    return touches.instrument.is_ball_on_standard


LOBING = Kind.of(
    ProbeLobing,
    title="lobes of the probe",
    synonyms="pre-travel variation, triggering, kinematic probe, tri-lobing",
    formula="bias = sin(theta) (a cos(k phi) + b sin(k phi)), k = 2 to 6 lobes, tool frame",
    units="a, b: µm; k: 1",
    typical="3 to 8 µm with three lobes (kinematic), below 1 µm (strain gauge)",
    source="Estler et al., Precision Engineering 19 (1996): pre-travel of touch probes",
    when=_touching,
    belongs_to="probe",
)
RADIUS = Kind.of(
    ProbeRadius,
    title="effective radius of the ball",
    synonyms="probe calibration, ball diameter, stylus tip size, pre-travel",
    formula="bias = a, effective minus stated radius",
    units="a: µm",
    typical="1 to 5 µm",
    source="ISO 10360-5 (effective size of the stylus tip)",
    when=_touching,
    belongs_to="probe",
)
BENDING = Kind.of(
    StylusBending,
    title="bending of the stylus",
    synonyms="stylus deflection, probe bending",
    formula="bias = a sin^2(theta), theta between normal and tool axis",
    units="a: µm",
    typical="0.5 to 3 µm",
    source="cantilever F l^3/(3 E I); Estler et al. 1996",
    when=_touching,
    belongs_to="probe",
)
