"""How large the standard of a run is: what was taken off, and what its temperature leaves open."""

from dataclasses import dataclass

import numpy as np

from matstd.twin.record import BODY, Body, Touches
from matstd.twin.units import T_REF


@dataclass(frozen=True, slots=True)
class BodySize:
    """The size of the standard of one run, on which every scale rests."""

    run: str
    body: Body | None  # what the run states; None where it states nothing
    # of the standard, on average, degC; None where nothing is known of it
    temperature: float | None
    length: float  # of what was touched, from corner to corner, mm
    # lowest and highest temperature of every other sensor, degC: scales of the machine are those at
    # these temperatures
    machine: tuple[tuple[str, float, float], ...] = ()

    @property
    def strain(self) -> float:
        """By how much it is larger than at 20 degC, mm per mm: what was taken off."""
        if self.body is None or self.temperature is None:
            return 0.0
        return self.body.alpha * (self.temperature - T_REF)

    @property
    def u(self) -> float:
        """Standard uncertainty of its size, mm per mm, which is in every scale."""
        if self.body is None:
            return 0.0
        warmth = 0.0 if self.temperature is None else self.temperature - T_REF
        by_temperature = self.body.alpha * self.body.u_temperature
        parts = (by_temperature, self.body.u_alpha * warmth, self.body.u_scale)
        return float(np.linalg.norm(parts))


def body_sizes(touches: Touches) -> list[BodySize]:
    """One for every run with a standard; none for other instruments."""
    if not touches.instrument.is_ball_on_standard:
        return []
    bodies = [s.body for s in touches.setups]
    return [
        _size(touches[touches.run == i], bodies[touches.setup[touches.run == i][0]], name)
        for i, name in enumerate(touches.runs)
        if np.any(touches.run == i)
    ]


def _size(touches: Touches, body: Body | None, run: str) -> BodySize:
    at = touches.temperature.get(BODY)
    if body is not None:
        at = touches.body_temperature if body.is_known else None
    length = float(np.linalg.norm(np.ptp(touches.point, axis=0)))
    others = sorted(name for name in touches.temperature if name != BODY)
    logged = ((name, touches.temperature[name]) for name in others)
    return BodySize(
        run=run,
        body=body,
        temperature=None if at is None else float(np.mean(at)),
        length=length,
        machine=tuple((name, float(t.min()), float(t.max())) for name, t in logged),
    )
