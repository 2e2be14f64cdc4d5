"""What a touch probe adds of its own: lobes, its effective radius, a stylus that bends."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.model import Effect, Inner, Kind, Parameter, Term, Title, Where
from matstd.twin.record import Touches
from matstd.twin.units import UM


def normal_in_tool(touches: Touches) -> Array:
    """Outward normals in the tool frame, (N, 3); the probe approaches against them."""
    tool_axes = touches.reach.twist[:, touches.chain.link_index("t"), :3]
    return np.einsum("nki,ni->nk", tool_axes, touches.normal_table)


@dataclass(frozen=True)
class ProbeLobing:
    """Pre-travel that varies with the direction in which the stylus is deflected.

    theta and phi are latitude from the tool axis and azimuth of the surface normal in the tool
    frame; k = 3 for the three seats of a kinematic probe.

    Attributes:
        lobes: k.
    """

    lobes: float = 3.0

    kind = "probe-lobing"
    name = "probe-lobing"
    title = Title("lobes of the probe", "probe")

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Cosine and sine."""
        return (Parameter("cos", "mm", 3 * UM), Parameter("sin", "mm", 3 * UM))

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A bias along the normal."""
        n = normal_in_tool(touches)
        sideways = np.hypot(n[:, 0], n[:, 1])
        phi = np.arctan2(n[:, 1], n[:, 0])
        waves = (np.cos(self.lobes * phi), np.sin(self.lobes * phi))
        return tuple(Term(i, Where("bias"), sideways * wave) for i, wave in enumerate(waves))

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """Two to six lobes; one is the offset of the stylus."""
        return (Inner("lobes", "1", np.arange(2.0, 7.0), continuous=False),)

    def tuned(self, *values: float) -> "ProbeLobing":
        """With this number of lobes."""
        return replace(self, lobes=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The number of lobes."""
        return {"lobes": self.lobes}


@dataclass(frozen=True)
class ProbeRadius:
    """Effective radius of the ball minus the radius that is stated.

    A larger ball meets the surface earlier, by as much along every normal; a pre-travel v t_d that
    is the same in every direction makes it smaller.
    """

    kind = "probe-radius"
    name = "probe-radius"
    title = Title("effective radius of the ball", "probe")

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Excess radius."""
        return (Parameter("amplitude", "mm", 5 * UM),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A bias along the normal."""
        return (Term(0, Where("bias"), np.ones(len(touches))),)


@dataclass(frozen=True)
class StylusBending:
    """Bending of the stylus, which grows with the latitude of the touch.

    The trigger force bends a stylus of length l by ``F l^3/(3 E I)`` times sin(theta), of which
    sin(theta) lies along the normal. Positive where the surface is seen outside.
    """

    kind = "stylus-bending"
    name = "stylus-bending"
    title = Title("bending of the stylus", "probe")

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Deviation of a touch square to the stylus."""
        return (Parameter("amplitude", "mm", 5 * UM),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A bias along the normal."""
        n = normal_in_tool(touches)
        return (Term(0, Where("bias"), n[:, 0] ** 2 + n[:, 1] ** 2),)


def _if_touching(effect: Callable[[], Effect], touches: Touches) -> Iterable[Effect]:
    """The effect where a ball touched a standard; a laser or a tracker has no stylus."""
    return (effect(),) if touches.instrument.is_ball_on_standard else ()


LOBING = Kind.of(
    ProbeLobing,
    title="lobes of the probe",
    synonyms="pre-travel variation, triggering, kinematic probe, tri-lobing",
    formula="bias = sin(theta) (a cos(k phi) + b sin(k phi)), k = 2 to 6 lobes, tool frame",
    units="a, b: µm; k: 1",
    typical="3 to 8 µm with three lobes (kinematic), below 1 µm (strain gauge)",
    source="Estler et al., Precision Engineering 19 (1996): pre-travel of touch probes",
    propose=partial(_if_touching, ProbeLobing),
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
    propose=partial(_if_touching, ProbeRadius),
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
    propose=partial(_if_touching, StylusBending),
    belongs_to="probe",
)
