"""The beam estimate of a thermal error: growth and bending of bodies whose temperatures are read.

A body of length L grows by ``alpha L (T - 20 degC)``. One that is warmer on one side by dT over its
depth h is an arc of curvature ``alpha dT/h``: its end turns by ``alpha dT L/h`` and moves across by
``alpha dT L^2/(2 h)``. Holds for a linear gradient and a body that is free to grow from one end.

Reference: D-MT paper, 2.3 (beam theory coupled with an ARX law); Timoshenko, Strength of Materials.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from pydantic import Field

from matstd.diagnosis.drift.arx import arx
from matstd.diagnosis.drift.linear import LinearLaw, memory_of
from matstd.diagnosis.drift.record import DriftRecord, IntArray
from matstd.twin.errors import BadFile
from matstd.twin.files import Table, checked, parse_toml, read_text
from matstd.twin.frames import Array
from matstd.twin.units import T_REF, UM
from matstd.twin.words import did_you_mean

PER_K = 1e-6
"""One µm/(m K) in 1/K."""


class Beam(Table):
    """One body, as a file states it; what it moves is by component, times 1 or -1 or a lever."""

    name: str
    length_mm: float = Field(gt=0.0)
    alpha: float = Field(alias="alpha_um_per_m_K", gt=0.0, lt=100.0)
    sensors: list[str] = Field(default_factory=list)
    grows: dict[str, float] = Field(default_factory=dict)
    depth_mm: float | None = Field(default=None, gt=0.0)
    warm: list[str] = Field(default_factory=list)
    cold: list[str] = Field(default_factory=list)
    bends: dict[str, float] = Field(default_factory=dict)
    tilts: dict[str, float] = Field(default_factory=dict)

    def effects(self, record: DriftRecord) -> list[tuple[dict[str, float], Array]]:
        """What it moves and by how much, (N,), base units."""
        out = []
        if self.grows:
            mean = record.columns(self.sensors).mean(axis=1)
            out.append((self.grows, PER_K * self.alpha * self.length_mm * (mean - T_REF)))
        if self.bends or self.tilts:
            assert self.depth_mm is not None
            warm, cold = record.columns(self.warm), record.columns(self.cold)
            curvature = PER_K * self.alpha * (warm.mean(axis=1) - cold.mean(axis=1)) / self.depth_mm
            out.append((self.bends, curvature * self.length_mm**2 / 2.0))
            out.append((self.tilts, curvature * self.length_mm))
        return out


class _BeamFile(Table):
    beam: list[Beam] = Field(min_length=1)


def read_beams(path: str, record: DriftRecord) -> tuple[Beam, ...]:
    """Bodies of a file, which name sensors and components of a record.

    Raises:
        BadFile: A key, sensor or component that does not belong there.
    """
    beams = tuple(checked(_BeamFile, parse_toml(read_text(path), path), path).beam)
    for k, beam in enumerate(beams):
        _check(path, f"beam[{k}] '{beam.name}'", beam, record)
    return beams


def _check(path: str, where: str, beam: Beam, record: DriftRecord) -> None:
    for word in (*beam.sensors, *beam.warm, *beam.cold):
        if word not in record.drives:
            known = ", ".join(record.drives)
            found = f"sensor '{word}'{did_you_mean(word, record.drives)}"
            raise BadFile(path, where, found, f"one of {known}")
    for word in (*beam.grows, *beam.bends, *beam.tilts):
        if word not in record.components:
            known = ", ".join(record.components)
            found = f"component '{word}'{did_you_mean(word, record.components)}"
            raise BadFile(path, where, found, f"one of {known}")
        unit = "rad" if word in beam.tilts else "mm"
        if record.units[record.components.index(word)] != unit:
            raise BadFile(path, where, f"component '{word}'", f"a component in {unit}")
    if not (beam.grows or beam.bends or beam.tilts):
        raise BadFile(path, where, "nothing that it moves", "grows, bends or tilts")
    if beam.grows and not beam.sensors:
        raise BadFile(path, where, "grows without sensors", "sensors on the body")
    if (beam.bends or beam.tilts) and not (beam.warm and beam.cold and beam.depth_mm):
        raise BadFile(path, where, "bending without a section", "warm, cold and depth_mm")


def beam_estimate(beams: Sequence[Beam], record: DriftRecord) -> Array:
    """What the bodies do, nothing fitted, (N, K), base units."""
    out = np.zeros_like(record.displacement)
    for beam in beams:
        for moved, amount in beam.effects(record):
            for name, factor in moved.items():
                out[:, record.components.index(name)] += factor * amount
    return out


@dataclass(frozen=True, eq=False)
class BeamLaw:
    """The beam estimate, and a law of what it leaves.

    Attributes:
        beams: The bodies.
        rest: Law of what they leave; None leaves only a constant.
        offset: That constant, (K,), base units.
        residual: Standard deviation of what is left in training, (K,).
        memory: Time in which what is left forgets itself, s.
    """

    beams: tuple[Beam, ...]
    rest: LinearLaw | None
    offset: Array
    residual: Array
    memory: float

    def predicted(self, record: DriftRecord) -> Array:
        """Free run, (N, K)."""
        bodies = beam_estimate(self.beams, record)
        return bodies + (self.rest.predicted(record) if self.rest else self.offset)

    def leverage(self, record: DriftRecord) -> Array:
        """Of the law of what they leave, (N,)."""
        return self.rest.leverage(record) if self.rest else np.zeros(len(record))


def beam_law(
    beams: Sequence[Beam], record: DriftRecord, parts: Sequence[IntArray], is_coupled: bool
) -> BeamLaw:
    """The beam estimate with a constant, or coupled with an ARX law of what it leaves."""
    rest = replace(record, displacement=record.displacement - beam_estimate(beams, record))
    if is_coupled:
        law = arx(rest, parts)
        return BeamLaw(
            beams=tuple(beams),
            rest=law,
            offset=0.0 * law.intercept,
            residual=law.residual,
            memory=law.memory,
        )
    rows = np.concatenate(parts)
    offset = rest.displacement[rows].mean(axis=0)
    left = record.centred(rest.displacement[rows] - offset, rows)
    memory = memory_of(left / UM, record.step)
    return BeamLaw(
        beams=tuple(beams),
        rest=None,
        offset=offset,
        residual=left.std(axis=0),
        memory=memory,
    )
