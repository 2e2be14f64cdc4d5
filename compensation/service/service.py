"""A machine in operation: readings and temperatures come in, corrections go out.

Without any network: `opcua_server` carries it to controls, tests play it by hand.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.compensation.field import Datum, MachineErrors, relative_columns
from matstd.compensation.service.output import Output, OutputLimits, Quality, Sent
from matstd.compensation.service.point_correction import Point, PointCorrection
from matstd.compensation.service.tabulated import History
from matstd.diagnosis.drift import LiveDrift
from matstd.twin.errors import DesignError, OutsideTravel
from matstd.twin.frames import Array
from matstd.twin.record import Touches


class Drifts:
    """The laws of one machine since its preset was taken."""

    def __init__(self, errors: MachineErrors, datum: Datum) -> None:
        """The laws where the preset is taken."""
        self._errors = errors
        self._at_datum = datum.touches(errors)
        self._laws = LiveDrift.of(errors.effects, self._at_datum)
        laws = [live.law for live in self._laws]
        is_law = [effect in laws for effect in errors.effects]
        counts = [len(theta) for theta in errors.theta]
        # rows of all other parameters in the root of the covariance, (P',)
        self.others = np.flatnonzero(~np.repeat(np.array(is_law, dtype=bool), counts))

    @property
    def columns(self) -> tuple[str, ...]:
        """Outputs that are bound, of all laws."""
        return tuple(name for live in self._laws for name in live.columns)

    @property
    def drift(self) -> list[float]:
        """Drift of every column since the preset, mm or rad."""
        return [float(v) for live in self._laws for v in live.drift]

    @property
    def u(self) -> list[float]:
        """Standard uncertainty of each."""
        return [float(v) for live in self._laws for v in live.u]

    @property
    def learnt(self) -> dict[str, Array]:
        """Parameters of the laws with what was probed, by the names of their effects."""
        pairs = zip(self._errors.effects, self._errors.theta, strict=True)
        known = {effect.name: theta for effect, theta in pairs}
        return {live.law.name: known[live.law.name] + live.missed for live in self._laws}

    def follow(self, history: History) -> None:
        """Go on to the present moment of a history."""
        if self._laws:
            touches = history.touches(self._errors.chain, self._at_datum.q, self._at_datum.length)
            for live in self._laws:
                live.follow(touches)

    def probed(self, left: Sequence[float], u: Sequence[float]) -> None:
        """What is left of every column with the corrections on; raises DesignError."""
        columns = self.columns
        if not columns:
            raise DesignError("probed values: expected a saved law, drift-law(...), in the model")
        if len(left) != len(columns) or len(u) != len(columns):
            found = f"{len(left)} values and {len(u)} uncertainties"
            raise DesignError(f"{found} probed, expected {len(columns)}: {', '.join(columns)}")
        start = 0
        for live in self._laws:
            end = start + len(live.columns)
            live.probed(left[start:end], u[start:end])
            start = end

    def at(self, touches: Touches) -> Array:
        """What a standard deviation of every column does to the tool point of one pose, (3, C).

        The columns since the preset, and, where a column is not the same everywhere, those of the
        moment of the preset too.
        """
        out = [np.zeros((3, 0))]
        for live in self._laws:
            now, then = _moved(live, touches), _moved(live, self._at_datum)
            out += [now * live.u, (now - then) * live.u_begin]
        return np.hstack(out)


def _moved(live: LiveDrift, touches: Touches) -> Array:
    """Tool point of the first touch per unit of every column, (3, C)."""
    out = np.zeros((3, len(live.columns)))
    for bound in live.law.bound:
        reach = touches.reach.of(touches.chain.twist_of(bound.symbol))[0]
        out[:, live.columns.index(bound.column)] += bound.share(touches)[0] * reach
    return out


DRIVEN_EVERY = 2.0
"""Between two looks at temperatures, s: bodies are slower, and tables are made again."""

_SLOPE_STEP = 1.0  # mm on either side, between which a slope is taken


Line = tuple[Point, Point, Point]
"""Corrections, how each changes with the reading of its own axis, and those readings."""


@dataclass(frozen=True)
class Answer:
    """What a control reads."""

    sequence: int
    sent: Sent  # corrections of the three linear axes, and what they are worth
    # corrections at the readings that were given, mm: those of `sent` once it has settled
    k0: Point
    k1: Point  # how each changes with the reading of its own axis, mm/mm
    # those readings, mm. Between two answers ``k0 + k1 (p - p0)`` goes on, which nowhere in the
    # travel is more than the limit
    p0: Point
    refused: str  # why the last readings were not understood; empty for none


class Service:
    """Corrects one machine."""

    def __init__(
        self, errors: MachineErrors, length: float, datum: Datum, limits: OutputLimits | None = None
    ) -> None:
        """Tabulate the errors.

        Args:
            datum: Pose at which the preset was taken: nothing is corrected there.

        Raises:
            DesignError: Errors that cannot be corrected while the machine moves.
        """
        self.errors, self.length, self.datum = errors, length, datum
        self.correction = PointCorrection(errors, length, datum)
        self._history = History((errors.state,))
        self.drifts = Drifts(errors, datum)
        self._output = Output(limits or OutputLimits())
        self._quality = Quality.FADING
        zero = (0.0, 0.0, 0.0)
        self._sequence, self._refused = 0, ""
        self._linear: Line = zero, zero, zero
        self._ends = [errors.chain.link(name).range for name in self.correction.linear_axes]

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors that the state has, in their order."""
        return tuple(self.errors.state.temperature)

    def move(
        self,
        sequence: int,
        readings: Sequence[float],
        now: float,
        directions: Sequence[int] | None = None,
    ) -> None:
        """Readings of every axis in the chain's order, mm and degrees.

        What is not understood is no reading: the last correction is held, and `Answer.refused`
        says why.

        Args:
            directions: Sign of the last motion of every axis, -1, 0 or 1.
        """
        self._sequence = sequence
        try:
            q, signs = self._understood(readings, directions)
            wanted = self.correction.at(q, signs)
            self._linear = self._line(q, signs, wanted)
        except OutsideTravel as error:
            self._refused = str(error)
            return
        self._refused = ""
        self._output.want(wanted, now)

    def drive(
        self, time: float, temperature: Mapping[str, float], spindle_rpm: float | None = None
    ) -> None:
        """What drives the machine at a later moment; the tables that follow it are made again.

        Args:
            time: Since the machine was switched on, s.
            temperature: degC of every sensor.
            spindle_rpm: Speed, 1/min.

        Raises:
            DesignError: A moment that is not later, other sensors, a number that is none.
        """
        driving = {f"temperature {name}": value for name, value in temperature.items()}
        for name, value in (driving | {"spindle speed": spindle_rpm or 0.0}).items():
            if not np.isfinite(value):
                raise DesignError(f"{name}: {value:g}, expected a number")
        warm, now = dict(temperature), self._history.now
        state = replace(now, time=time, temperature=warm, spindle_rpm=spindle_rpm)
        self._history = self._history.then(state)
        self.drifts.follow(self._history)
        self.correction = self.correction.following(self._history, self.drifts.learnt)

    def probed(self, left: Sequence[float], u: Sequence[float]) -> None:
        """A standard was probed with the corrections on: what is left of the thermal drift.

        The law of the drift is corrected by it, and its uncertainty.

        Args:
            left: Remainder of every column of `drifts.columns`, mm or rad; NaN where not probed.

        Raises:
            DesignError: No law is followed, other numbers of values, or a correction that was not
                valid: the remainder of the law cannot be separated from that of its limits.
        """
        if self._quality is not Quality.VALID:
            raise DesignError(f"probed while the correction was {self._quality}, expected valid")
        self.drifts.probed(left, u)
        self.correction = self.correction.following(self._history, self.drifts.learnt)

    def tick(self, now: float) -> Answer:
        """What a control reads at this moment."""
        sent = self._output.step(now)
        self._quality = sent.quality
        k0, k1, p0 = self._limited_line(sent)
        return Answer(self._sequence, sent, k0, k1, p0=p0, refused=self._refused)

    def _limited_line(self, sent: Sent) -> Line:
        """The straight lines within the limit over the whole travel; level while they fade."""
        k0, k1, p0 = self._linear
        if sent.quality is Quality.FADING:
            return sent.values, (0.0, 0.0, 0.0), p0
        most = self._output.limits.most
        (x, a), (y, b), (z, c) = (
            (value, _within(value, slope, at, ends, most))
            if abs(value) < most
            else (math.copysign(most, value), 0.0)
            for value, slope, at, ends in zip(k0, k1, p0, self._ends, strict=True)
        )
        return (x, y, z), (a, b, c), p0

    def uncertainty(self, readings: Sequence[float]) -> Point:
        """Standard uncertainty of the tool point that the model leaves there, x, y, z, mm.

        Raises:
            OutsideTravel: Readings that are not understood.
        """
        q, _ = self._understood(readings, None)
        touches = self.errors.touches(np.array([q]), self.length)
        columns = relative_columns(self.errors, touches, self.datum)[0][:, self.drifts.others]
        spread = np.hstack(
            [columns @ self.errors.root[self.drifts.others], self.drifts.at(touches)]
        )
        x, y, z = np.sqrt((spread**2).sum(axis=1)).tolist()
        return x, y, z

    def _understood(
        self, readings: Sequence[float], directions: Sequence[int] | None
    ) -> tuple[list[float], list[int] | None]:
        chain = self.errors.chain
        for name, given in (("readings", readings), ("directions", directions)):
            if given is not None and len(given) != len(chain.axes):
                raise OutsideTravel(
                    f"{len(given)} {name}, expected {len(chain.axes)}: {', '.join(chain.axes)}"
                )
        q = [v * chain.link(name).unit for v, name in zip(readings, chain.axes, strict=True)]
        return q, None if directions is None else [int(np.sign(d)) for d in directions]

    def _line(self, q: list[float], signs: list[int] | None, wanted: Point) -> Line:
        """Corrections as a straight line along every linear axis by itself."""
        chain, slopes, at = self.errors.chain, [], []
        for k, name in enumerate(self.correction.linear_axes):
            column, (low, high) = chain.axis_index(name), chain.link(name).range
            ends = max(q[column] - _SLOPE_STEP, low), min(q[column] + _SLOPE_STEP, high)
            there = [[*q[:column], end, *q[column + 1 :]] for end in ends]
            before, after = (self.correction.at(other, signs)[k] for other in there)
            slopes.append((after - before) / max(ends[1] - ends[0], 1e-9))
            at.append(q[column])
        return wanted, (slopes[0], slopes[1], slopes[2]), (at[0], at[1], at[2])


def _within(value: float, slope: float, at: float, ends: tuple[float, float], most: float) -> float:
    """The slope, or the steepest one with which the line stays within the limit up to both ends."""
    steepest = abs(slope)
    for way in (end - at for end in ends):
        room = most - value if slope * way > 0.0 else most + value
        if abs(slope * way) > room:
            steepest = min(steepest, room / abs(way))
    return math.copysign(steepest, slope)
