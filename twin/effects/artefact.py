"""What the standard and its set-up do: expand, slip and drift."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.effects.jump import between, thinned
from matstd.twin.effects.setup_error import rigid_shift
from matstd.twin.fields import SensorName, sensor_record, sensors
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Declared, Kind, Parameter, Term, Where, scanned
from matstd.twin.record import Touches
from matstd.twin.units import HOUR, UM, URAD

ON_EACH_SIDE = 2
"""Touches of a set-up needed before and after a slip; a single one may be an outlier."""
INSTANTS = 256  # largest number of instants scanned for a slip; the search refines between them


@dataclass(frozen=True)
class ArtefactExpansion(Declared):
    """The standard expands with the temperature of a sensor.

    It expands in every direction alike from the point f at which it is held (`fixing_mm` of the
    set-up), or with the table that carries it along from the origin of the table frame; p is the
    contact point. One temperature holds for the whole body. The expansion by the temperature that
    the run states is taken off already: this is what exceeds it.
    """

    sensor: SensorName

    kind, carrier = "artefact-expansion", "standard"
    called = "expansion of the standard with {sensor}"
    parameters = (Parameter("amplitude", "1/K", 20e-6),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        warmth = sensor_record(touches, self.sensor) - touches.body_temperature
        p = touches.point_table - np.nan_to_num(touches.fixing_table)
        return tuple(Term(0, Where("shift", 0, i), warmth * p[:, i]) for i in range(3))


def _instants(effect: "ArtefactSlip", touches: Touches) -> Array:
    """Instants between two touches of one set-up, with enough touches on either side."""
    times = (np.sort(touches.time[touches.setup == s]) for s in range(len(touches.setups)))
    every = np.unique(np.concatenate([between(t, ON_EACH_SIDE) for t in times]))
    return thinned(every, INSTANTS)


@dataclass(frozen=True)
class ArtefactSlip(Declared):
    """The standard slips on the table at an unknown instant, until it is set up again.

    It acts on the later touches of the set-up in which the instant lies; c is the mean contact
    point of that set-up in the table frame. The touches must be the whole run, for c and for the
    set-up. The instant counts from the start of the run, s.
    """

    instant: float = scanned("s", _instants, acts="at an instant")

    kind, called, carrier = "artefact-slip", "slip of the set-up", "standard"
    parameters = (
        *(Parameter(name, "mm", 10 * UM) for name in "XYZ"),
        *(Parameter(name, "rad", 30 * URAD) for name in "ABC"),
    )

    def terms(self, touches: Touches) -> Sequence[Term]:
        slipped, arm = self._slipped(touches)
        later = slipped.astype(float)
        return rigid_shift(later, arm * later[:, None])

    def _slipped(self, touches: Touches) -> tuple[Mask, Array]:
        """Which touches came after the slip and in its set-up, (N,); arms p - c, (N, 3), mm."""
        after = touches.time > self.instant
        if not np.any(after):
            return after, np.zeros((len(touches), 3))
        first = int(np.argmin(np.where(after, touches.time, np.inf)))
        same = touches.setup == touches.setup[first]
        return after & same, touches.point_table - touches.point_table[same].mean(axis=0)


@dataclass(frozen=True)
class Drift(Declared):
    """The set-up creeps at a constant rate.

    t counts from the start of the run; v is in the directions of the table frame.
    """

    kind, called, carrier = "drift", "drift of the set-up", "standard"
    parameters = tuple(Parameter(name, "mm/h", 5 * UM) for name in "XYZ")

    def terms(self, touches: Touches) -> Sequence[Term]:
        hours = touches.since_start / HOUR
        return tuple(Term(i, Where("shift", 0, i), hours) for i in range(3))


def _propose_expansion(touches: Touches) -> Iterable[ArtefactExpansion]:
    stated = touches.body_temperature
    for sensor in sensors(touches):
        if np.any(touches.temperature[sensor] != stated):
            yield ArtefactExpansion(sensor)


EXPANSION = Kind.of(
    ArtefactExpansion,
    title="thermal expansion of the standard",
    synonyms="growth of the artefact, temperature of the part, artefact expansion",
    formula="shift = alpha (T - T_body) (p - f), T_body as the run states it, else 20 degC; f: the "
    "point that is held (fixing_mm of the set-up), else the origin of the table",
    units="alpha: µm/(m K)",
    typical="steel 10 to 12, aluminium 23, Invar 0.6 to 1.6 µm/(m K)",
    source="ISO 1 (20 degC)",
    propose=_propose_expansion,
    when=lambda touches: touches.instrument.is_ball_on_standard,
)
SLIP = Kind.of(
    ArtefactSlip,
    title="slip of the set-up",
    synonyms="clamping, moved artefact, shifted fixture, knocked",
    formula="shift = e + r x (p - c) after an unknown instant, to the end of the set-up",
    units="e: µm; r: µrad; instant: s",
    typical="2 to 20 µm, some tens of µrad",
    source="clamping practice; rigid motion",
    when=lambda touches: (
        touches.instrument.has_standard and len(_instants(ArtefactSlip(), touches)) > 0
    ),
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
    when=lambda touches: not touches.instrument.reads_angle and bool(np.ptp(touches.time)),
    belongs_to="run",
)
