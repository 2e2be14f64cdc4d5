"""What the standard and its set-up do: expand, slip and drift."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import (
    Effect,
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    sensor_record,
    sensors,
)
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

HOUR = 3600.0
"""Drift is told per hour, s."""

ON_EACH_SIDE = 2
"""Fewest touches of a set-up before and after a slip: one alone is a touch gone wrong."""
INSTANTS = 256
"""Most instants that are scanned for a slip; between them it is refined."""


@dataclass(frozen=True)
class ArtefactExpansion:
    """The standard expands with the temperature of a sensor.

    It expands from the origin of the table frame, which carries it along, in every direction alike;
    p is the contact point in the table frame. One temperature holds for the whole body. What it
    grows by the temperature that its run states is taken off already: here is what it grows beyond.

    Attributes:
        sensor: Name of the sensor.
    """

    sensor: str

    kind = "artefact-expansion"

    @property
    def name(self) -> str:
        """`artefact-expansion(artefact)`."""
        return f"artefact-expansion({self.sensor})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"expansion of the standard with {self.sensor}", "standard")

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """Coefficient of expansion."""
        return (Parameter("amplitude", "1/K", 20e-6),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A shift of the standard."""
        warmth = sensor_record(touches, self.sensor) - touches.body_temperature
        p = touches.point_table
        return tuple(Term(0, Where("shift", 0, i), warmth * p[:, i]) for i in range(3))


@dataclass(frozen=True)
class ArtefactSlip:
    """The standard slips on the table at an unknown instant, until it is set up again.

    It acts on the later touches of the set-up in which the instant lies; c is the mean contact
    point of that set-up in the table frame. The touches must be the whole run, for c and for the
    set-up.

    Attributes:
        instant: s since the start of the run.
    """

    instant: float = 0.0

    kind = "artefact-slip"
    name = "artefact-slip"
    title = Title("slip of the set-up", "standard")

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """Displacement and rotation, table frame."""
        shifts = (Parameter(name, "mm", 10 * UM) for name in "XYZ")
        turns = (Parameter(name, "rad", 30 * URAD) for name in "ABC")
        return (*shifts, *turns)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Shifts of the standard."""
        slipped, arm = self._slipped(touches)
        later = slipped.astype(float)
        out = [Term(i, Where("shift", 0, i), later) for i in range(3)]
        for i in range(3):  # rotation about i moves the two directions across
            j, k = (i + 1) % 3, (i + 2) % 3
            out.append(Term(3 + i, Where("shift", 0, k), later * arm[:, j]))
            out.append(Term(3 + i, Where("shift", 0, j), -later * arm[:, k]))
        return tuple(out)

    def _slipped(self, touches: Touches) -> tuple[NDArray[np.bool_], Array]:
        """Which touches came after the slip and in its set-up, (N,); arms p - c, (N, 3), mm."""
        after = touches.time > self.instant
        if not np.any(after):
            return after, np.zeros((len(touches), 3))
        first = int(np.argmin(np.where(after, touches.time, np.inf)))
        same = touches.setup == touches.setup[first]
        return after & same, touches.point_table - touches.point_table[same].mean(axis=0)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """Instants between two touches of one set-up, with enough touches on either side."""
        instants = []
        for s in range(len(touches.setups)):
            t = np.sort(touches.time[touches.setup == s])
            middle = 0.5 * (t[1:] + t[:-1])
            instants.append(middle[ON_EACH_SIDE - 1 : len(middle) - ON_EACH_SIDE + 1])
        every = np.unique(np.concatenate(instants))
        step = int(np.ceil(len(every) / INSTANTS)) or 1
        return (Inner("instant", "s", every[::step], acts="at an instant"),)

    def tuned(self, *values: float) -> "ArtefactSlip":
        """With this instant, s."""
        return replace(self, instant=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The instant, s."""
        return {"instant": self.instant}


@dataclass(frozen=True)
class Drift:
    """The set-up creeps at a constant rate.

    t counts from the start of the run; v is in the directions of the table frame.
    """

    kind = "drift"
    name = "drift"
    title = Title("drift of the set-up", "standard")

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """Rates of displacement, table frame."""
        return tuple(Parameter(name, "mm/h", 5 * UM) for name in "XYZ")

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Shifts of the standard."""
        hours = touches.since_start / HOUR
        return tuple(Term(i, Where("shift", 0, i), hours) for i in range(3))


def _make_expansion(chain: Chain, arguments: Sequence[str]) -> Effect:
    check_count(EXPANSION.usage, arguments, 1, 1)
    return ArtefactExpansion(arguments[0])


def _propose_expansion(touches: Touches) -> Iterable[Effect]:
    if not touches.instrument.is_ball_on_standard:
        return ()
    stated = touches.body_temperature
    return (
        ArtefactExpansion(s) for s in sensors(touches) if np.any(touches.temperature[s] != stated)
    )


def _propose_slip(touches: Touches) -> Iterable[Effect]:
    if not touches.instrument.has_standard:
        return ()
    slip = ArtefactSlip()
    return (slip,) if len(slip.inner(touches)[0].grid) else ()


def _propose_drift(touches: Touches) -> Iterable[Effect]:
    is_felt = not touches.instrument.reads_angle and np.ptp(touches.time) > 0.0
    return (Drift(),) if is_felt else ()


EXPANSION = Kind(
    word="artefact-expansion",
    arguments="sensor",
    title="thermal expansion of the standard",
    synonyms="growth of the artefact, temperature of the part, artefact expansion",
    formula="shift = alpha (T - T_body) p, T_body as the run states it, else 20 degC",
    units="alpha: µm/(m K)",
    typical="steel 10 to 12, aluminium 23, Invar 0.6 to 1.6 µm/(m K)",
    source="ISO 1 (20 degC)",
    make=_make_expansion,
    propose=_propose_expansion,
    classes=(ArtefactExpansion,),
)
SLIP = Kind.of(
    ArtefactSlip,
    title="slip of the set-up",
    synonyms="clamping, moved artefact, shifted fixture, knocked",
    formula="shift = e + r x (p - c) after an unknown instant, to the end of the set-up",
    units="e: µm; r: µrad; instant: s",
    typical="2 to 20 µm, some tens of µrad",
    source="clamping practice; rigid motion",
    propose=_propose_slip,
    belongs_to="run",
)
DRIFT = Kind.of(
    Drift,
    title="drift of the set-up",
    synonyms="creep, environmental drift, room temperature, thermal drift, ETVE",
    formula="shift = v t",
    units="v: µm/h",
    typical="1 to 5 µm/h",
    source="ISO 230-3 (environmental temperature variation error, drift tests)",
    propose=_propose_drift,
    belongs_to="run",
)
