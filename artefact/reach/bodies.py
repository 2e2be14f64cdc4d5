"""Clamps, fixtures and covers as a project states them, and what stands beside one set-up."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.artefact.reach.mesh_cover import DrawnBody
from matstd.artefact.reach.workshop import Solid, Workshop
from matstd.twin.frames import Array, apply, pose, rotation
from matstd.twin.record import Setup


@dataclass(frozen=True, eq=False)
class Body:
    """A clamp, fixture or cover, in the frame of the table's face."""

    name: str
    # middle of its lower side, or origin of its mesh, mm
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    # half sides of its outline, mm; of a disc its radius, twice
    half_size: tuple[float, float] = (0.0, 0.0)
    is_disc: bool = False
    height: float = 0.0  # of a prism, mm
    turn: float = 0.0  # about its own upright axis, rad
    on: str = ""  # axis whose body carries it; empty for the table
    setup: str = ""  # name of the set-up in which it stands there; empty for all
    drawn: DrawnBody | None = None  # its mesh, which stands in place of the prism; None for a prism

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """The prisms that a program can state."""
        if self.drawn is not None:
            return self.drawn.solids(self.name, self._T_face_mesh, self.on)
        x, y, z = self.at
        return (
            Solid(
                name=self.name,
                half_size=self.half_size,
                is_disc=self.is_disc,
                low=z,
                high=z + self.height,
                x=x,
                y=y,
                turn=self.turn,
                on=self.on,
            ),
        )

    @property
    def mesh(self) -> tuple[Array, np.ndarray] | None:
        """Corners (V, 3) and triangles (F, 3) of a mesh that encloses a volume, else None."""
        if self.drawn is None or not len(self.drawn.triangles):
            return None
        return apply(self._T_face_mesh, self.drawn.corners), self.drawn.triangles

    @property
    def _T_face_mesh(self) -> Array:
        return pose(rotation(np.array([0.0, 0.0, self.turn])), np.array(self.at))


@dataclass(frozen=True, eq=False)
class Clamping:
    """A place of the standard, with what stands beside it there."""

    setup: Setup
    workshop: Workshop
