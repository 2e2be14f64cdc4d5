"""Growth of a screw or scale, and of what holds it, while its axis works."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import (
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    checked_linear,
    moving_axes,
    refusal,
)
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import OWN, PROGRESS, is_own, own_column
from matstd.twin.thermal.thermal_lag import LONGEST, SHORTEST, STEPS
from matstd.twin.units import MINUTE, UM

FASTEST, SLOWEST = 0.3, 1.0
"""Time constants that are scanned without times: in cycles, and in lengths of the test. What is
slower is a straight line, which needs no time constant and has no size to settle at."""


@dataclass(frozen=True)
class AxisWarming:
    """The positioning error of a linear axis that warms while it works.

    ``E = (1 - exp(-t/tau)) (low (1 - s) + high s)``, s from 0 to 1 over the travel: the screw grows
    from its fixed bearing, wherever that is, and the bearing may move. A positioning test has no
    times, but its order: then t counts cycles.

    Attributes:
        axis: Name of the linear axis.
        component: Index of the component along the axis.
        clock: Own column `V_name` that grows in step with time; empty for the time itself.
        tau: Time constant, s, or in units of the clock.

    Reference:
        ISO 230-3 (thermal distortion caused by moving linear axes); ISO 230-2 (drift over cycles).
    """

    axis: str
    component: int
    clock: str = ""
    tau: float = 20.0 * MINUTE

    kind = "axis-warming"

    @property
    def name(self) -> str:
        """`axis-warming(X)`, `axis-warming(X,V_cycles_done_1)`."""
        return f"axis-warming({self.axis}{',' if self.clock else ''}{self.clock})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"growth of the screw or scale of {self.axis} while it warms", self.axis)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """What either end of the travel settles at."""
        return tuple(Parameter(f"{end} end", "mm", 30 * UM) for end in ("low", "high"))

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis."""
        i = touches.chain.link_index(self.axis)
        low, high = touches.chain.links[i].range
        s = (touches.reading(self.axis) - low) / (high - low)
        where = Where("twist", i, self.component)
        y = -np.expm1(-self._clock(touches) / self.tau)
        return (Term(0, where, y * (1.0 - s)), Term(1, where, y * s))

    def _clock(self, touches: Touches) -> Array:
        """Time since the run began, or what counts it."""
        if not self.clock:
            return touches.since_start
        return np.maximum(own_column(touches, self.clock.removeprefix(OWN)), 0.0)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The time constant, evenly spaced in its logarithm, up to that of the run."""
        spent = float(np.ptp(self._clock(touches))) if len(touches) else 1.0
        if self.clock:
            grid = np.geomspace(FASTEST, SLOWEST * max(spent, 1.0), STEPS)
            return (Inner("cycles", "1", grid),)
        high = float(np.clip(SLOWEST * spent, 4.0 * SHORTEST, LONGEST))
        return (Inner("tau", "s", np.geomspace(SHORTEST, high, STEPS)),)

    def tuned(self, *values: float) -> "AxisWarming":
        """With this time constant."""
        return replace(self, tau=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The time constant."""
        return {"cycles" if self.clock else "tau": self.tau}


def make(chain: Chain, arguments: Sequence[str]) -> AxisWarming:
    """From the linear axis and, where no times are known, a column that counts."""
    check_count(KIND.usage, arguments, 1, 2)
    axis = checked_linear(KIND.usage, arguments, arguments[0], chain)
    clock = arguments[1] if len(arguments) == 2 else ""
    if len(arguments) == 2 and not is_own(clock):
        raise refusal(KIND.usage, arguments, "an own column V_name_unit that grows with time")
    tau = 1.0 if clock else AxisWarming.tau
    return AxisWarming(axis, chain.link(axis).own_component, clock, tau)


def propose(touches: Touches) -> Iterable[AxisWarming]:
    """Every linear axis that moved, where an instrument watched axes and no standard warms too."""
    if touches.instrument.is_ball_on_standard:
        return
    clocks = [""] if np.ptp(touches.since_start) > 0.0 else []
    clocks += [OWN + PROGRESS] if PROGRESS in touches.value else []
    for axis in moving_axes(touches):
        if axis in touches.chain.linear_axes:
            for clock in clocks:
                yield make(touches.chain, (axis, clock) if clock else (axis,))


KIND = Kind(
    word="axis-warming",
    arguments="axis[,V_column that grows with time]",
    title="warming of an axis that works",
    synonyms="ball screw heating, warm-up, drift over cycles, thermal growth of the screw",
    formula="E = (1 - exp(-t/tau)) (low (1 - s) + high s), s = (q - q_min)/travel",
    units="low, high: µm; tau: min, or cycles of a positioning test",
    typical="screws 10 to 60 µm at the free end of a metre, tau 20 to 60 min; scales a few µm",
    source="ISO 230-3 (moving linear axes); ISO 230-2 (drift over the cycles of a test)",
    make=make,
    propose=propose,
    classes=(AxisWarming,),
)
