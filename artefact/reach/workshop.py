"""What stands on the table and around it beside the standard: table, clamps, fixtures, covers.

Every body is an upright prism over a rectangle or a disc, which a program can state in two lines.
Anything else is covered by such bodies (`matstd.artefact.reach.mesh_cover`).
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.artefact.body import DatumSphere, Plate, Standard
from matstd.artefact.reach.face_of_table import table_face
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, apply, inverse, pose, rotation
from matstd.twin.machine import Chain, table_to_tool

DATUM = "DATUM"  # name of the feature
_UPRIGHT = 1e-6  # of the standard's z against that of the table's face


@dataclass(frozen=True)
class DatumBall:
    """A calibrated ball on the table beside the standard, by which the probe is watched.

    In the frame of the table's face. Programs that measure keep clear of it; one program touches
    it as if it were a feature of the standard.
    """

    x: float  # of its centre, mm
    y: float  # of its centre, mm
    z: float  # of its centre above the origin of the frame, mm
    radius: float  # as calibrated, mm
    stem: float  # radius of its stem, mm
    low: float  # height of the table's face, where the stem begins, mm
    u: float  # standard uncertainty of the radius, mm

    def sphere(self, T_table_artefact: Array) -> DatumSphere:
        """The ball as a feature of a standard; raises DesignError for one that is not upright."""
        T_artefact_face = inverse(T_table_artefact) @ table_face(T_table_artefact)
        if T_artefact_face[2, 2] < 1.0 - _UPRIGHT:
            raise DesignError("a datum ball beside a standard that is tilted: expected it upright")
        places = np.array([[self.x, self.y, self.z], [self.x, self.y, self.low]])
        centre, foot = apply(T_artefact_face, places)
        return DatumSphere(
            name=DATUM,
            centre=centre,
            radius=self.radius,
            stem_radius=self.stem,
            foot_radius=self.stem,
            foot=float(foot[2]),
        )

    def beside(self, standard: Standard, T_table_artefact: Array) -> Standard:
        """A standard that stands somewhere, with the ball as its last sphere."""
        return replace(standard, spheres=(*standard.spheres, self.sphere(T_table_artefact)))


TABLE = "the table"

TABLE_RADIUS = 190.0
"""Radius of the table's face where none is stated, mm: a base of 280 mm, which is usual, needs
187.6 for its corners."""
TABLE_THICKNESS = 60.0  # how much of the table below its face is kept clear, mm


@dataclass(frozen=True)
class Solid:
    """One body, in the frame of the table's face: at the table's origin, z out of the face."""

    name: str
    half_size: tuple[float, float]  # half sides of its outline, mm; of a disc its radius, twice
    is_disc: bool = False
    low: float = 0.0  # height of its lower face, mm
    high: float = 0.0  # height of its upper face, mm
    x: float = 0.0  # of its middle, mm
    y: float = 0.0  # of its middle, mm
    turn: float = 0.0  # about its own upright axis, rad
    # axis whose body carries it; empty for the table. It stands where it does while every axis
    # between it and the table reads zero
    on: str = ""

    def __post_init__(self) -> None:
        if not (min(self.half_size) > 0.0 and self.low < self.high):
            raise DesignError(
                f"{self.name}: sides of {2.0 * self.half_size[0]:g} and "
                f"{2.0 * self.half_size[1]:g} mm from {self.low:g} to {self.high:g} mm: "
                "expected positive sides and the lower face first"
            )

    @property
    def T_face_solid(self) -> Array:
        """Where its own frame stands, (4, 4)."""
        return pose(rotation(np.array([0.0, 0.0, self.turn])), np.array([self.x, self.y, 0.0]))

    @property
    def plate(self) -> Plate:
        """Its shape in its own frame."""
        corner = self.half_size[0] if self.is_disc else 0.0
        return Plate(self.half_size, corner, self.low, self.high)

    def corners(self, sides: int = 64) -> Array:
        """Points whose hull is the body, or holds it where it is round, face's frame, (V, 3)."""
        a, b = self.half_size
        if self.is_disc:
            angle = np.arange(sides) * (2.0 * np.pi / sides)
            # the polygon touches the circle from outside
            outline = a / np.cos(np.pi / sides) * np.column_stack([np.cos(angle), np.sin(angle)])
        else:
            outline = np.array([[-a, -b], [a, -b], [a, b], [-a, b]])
        points = [
            np.column_stack([outline, np.full(len(outline), z)]) for z in (self.low, self.high)
        ]
        return apply(self.T_face_solid, np.concatenate(points))


def round_table(radius: float = TABLE_RADIUS, height: float = 0.0) -> Solid:
    """A table's face as a disc, with what is kept clear below it."""
    return Solid(TABLE, (radius, radius), True, height - TABLE_THICKNESS, height)


def _ball_solids(ball: DatumBall) -> tuple[Solid, Solid]:
    around, x, y = (ball.radius, ball.radius), ball.x, ball.y
    stem = Solid(f"{DATUM}.STEM", (ball.stem, ball.stem), True, ball.low, ball.z, x, y)
    return Solid(DATUM, around, True, ball.z - ball.radius, ball.z + ball.radius, x, y), stem


@dataclass(frozen=True)
class Workshop:
    """Everything solid that is not the standard."""

    table: Solid = field(default_factory=round_table)
    bodies: tuple[Solid, ...] = ()
    ball: DatumBall | None = None  # by which the probe is watched; None where there is none

    @property
    def on(self) -> tuple[str, ...]:
        """Axes that carry its bodies, each once."""
        return tuple(dict.fromkeys(solid.on for solid in self.solids))

    @property
    def solids(self) -> tuple[Solid, ...]:
        """The table, then the others; the ball and its stem as upright cylinders."""
        return (self.table, *self.bodies, *(_ball_solids(self.ball) if self.ball else ()))

    @property
    def table_radius(self) -> float:
        """Of the largest disc that the table's face holds, mm."""
        return min(self.table.half_size)


def still_frames(on: Iterable[str], chain: Chain, q: Array) -> dict[str, Array]:
    """Poses T_still_table (N, 4, 4) of the table seen from bodies that other axes carry.

    Their frame is that of the table with every axis between them and it at zero.

    Args:
        on: Names of the axes; empty for the table itself.
        q: Readings, shape (N, A), mm and rad.

    Raises:
        DesignError: An axis that does not carry the workpiece.
    """
    inner = chain.carrying_axes
    out = {}
    for name in dict.fromkeys(on):
        if not name or inner[:1] == (name,):
            out[name] = np.broadcast_to(np.eye(4), (len(q), 4, 4))
            continue
        if name not in inner:
            available = ", ".join(inner) or "none"
            raise DesignError(
                f"a body on axis {name}: expected one that carries the workpiece: {available}"
            )
        still = q.copy()
        still[:, [chain.axis_index(a) for a in inner[: inner.index(name)]]] = 0.0
        out[name] = table_to_tool(chain, still) @ inverse(table_to_tool(chain, q))
    return out
