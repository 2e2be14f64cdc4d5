"""The standard as products: its body, every ball, every size of screw, and where each stands."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir
from OCP.ShapeCustom import ShapeCustom
from OCP.TopoDS import TopoDS_Shell

from matstd.artefact.body import DatumSphere, Material, Standard
from matstd.cad_out.details import (
    BALL,
    SCREW,
    Details,
    Screw,
    Tolerance,
    annotations_of,
    notes_of,
    tolerances_of,
)
from matstd.cad_out.kernel.faces import faces_of, solids_of, volume
from matstd.cad_out.kernel.primitives import boolean, cone, point
from matstd.cad_out.kernel.solid import Solid, build_solid
from matstd.twin.frames import Array

COLOURS = {
    "FF": (0.13, 0.40, 0.75),
    "SPH": (0.80, 0.15, 0.12),
    "DATUM": (0.16, 0.60, 0.28),
    "SEAT": (0.16, 0.60, 0.28),
    "HOLE": (0.45, 0.47, 0.50),
    "LIFT": (0.95, 0.60, 0.10),
    "THERMO": (0.95, 0.60, 0.10),
}
"""Of faces, by the begin of their names."""

_BODY, _SCREW = (0.66, 0.68, 0.70), (0.25, 0.26, 0.28)


@dataclass(frozen=True, eq=False)
class Product:
    """One part of the product structure."""

    name: str
    about: str
    shape: Any  # its solid, or a shell of one face
    faces: dict[str, Any]
    material: Material | None  # what it is made of; none of a face by itself
    colour: tuple[float, float, float]  # of its nameless faces
    # name and place of every instance, mm; the body and the balls stand where they are
    places: tuple[tuple[str, tuple[float, float, float]], ...]
    tolerances: tuple[Tolerance, ...] = ()
    notes: tuple[str, ...] = ()
    diameter: float | None = None  # of a ball, mm
    # signs of the tolerances, datums and sizes, polylines (N, 3) in mm by their names
    drawn: dict[str, list[Array]] = field(default_factory=dict)

    @cached_property
    def volume(self) -> float:
        """Of one instance, mm^3."""
        return volume(self.shape)


def colour_of(face: str) -> tuple[float, float, float] | None:
    """Of a face by its role, if it has one."""
    return next((c for start, c in COLOURS.items() if face.startswith(start)), None)


def whole_name(standard: Standard) -> str:
    """Name and serial number."""
    return f"{standard.name} {standard.serial}".strip()


def products_of(standard: Standard, details: Details) -> tuple[Solid, tuple[Product, ...]]:
    """The body and all products, the body first.

    Every ball is a part of its own, since it has a calibration of its own; screws of one size are
    instances of one part.
    """
    solid = build_solid(standard, details)
    here, drawn = (0.0, 0.0, 0.0), annotations_of(standard, details)
    found = [
        Product(
            name=f"{whole_name(standard)} BODY",
            about="Body, made to drawing",
            shape=solid.shape,
            faces=solid.faces,
            material=standard.material,
            colour=_BODY,
            places=(("BODY", here),),
            tolerances=tolerances_of(standard, details),
            notes=notes_of(standard, details),
            drawn=drawn,
        )
    ]
    for sphere in standard.spheres:
        shape, faces = ball(sphere)
        made = Product(
            name=sphere.name,
            about=f"Ball D{2.0 * sphere.radius:g}, ISO 3290-1 G5, bought",
            shape=shape,
            faces=faces,
            material=BALL,
            colour=COLOURS["SPH"],
            places=((sphere.name, here),),
            diameter=2.0 * sphere.radius,
            drawn=drawn,
        )
        found.append(made)
    # body and balls are built in place, only screws are moved
    for kind in details.screws:
        made = Product(
            name=kind.name,
            about="Cylinder-head screw, bought",
            shape=screw(kind),
            faces={},
            material=SCREW,
            colour=_SCREW,
            places=tuple((f"SCREW_{hole}", (x, y, z)) for hole, x, y, z in kind.holes),
        )
        found.append(made)
    return solid, tuple(found)


def face_products(solid: Solid) -> tuple[Product, ...]:
    """Every named face of the body as a part, for programs that show names of parts alone."""
    found = []
    for name, face in solid.plain_faces.items():
        shell, builder = TopoDS_Shell(), BRep_Builder()
        builder.MakeShell(shell)
        builder.Add(shell, face)
        made = Product(
            name=name,
            about="Face of the body, by itself",
            shape=shell,
            faces={name: face},
            material=None,
            colour=colour_of(name) or _BODY,
            places=((name, (0.0, 0.0, 0.0)),),
        )
        found.append(made)
    return tuple(found)


def ball(sphere: DatumSphere) -> tuple[Any, dict[str, Any]]:
    """A ball where it stands, and its one face by the ball's name."""
    axis = gp_Ax2(point(sphere.centre), gp_Dir(0.0, 0.0, 1.0))
    made = BRepPrimAPI_MakeSphere(axis, float(sphere.radius)).Shape()
    solid = solids_of(ShapeCustom.DirectFaces_s(made))[0]
    return solid, {sphere.name: faces_of(solid)[0]}


def screw(kind: Screw) -> Any:
    """A cylinder-head screw without its thread; the origin is in the middle under its head."""
    shank = cone(0.0, 0.0, -kind.length, 0.0, 0.5 * kind.diameter, 0.5 * kind.diameter)
    head = cone(0.0, 0.0, 0.0, kind.diameter, 0.5 * kind.head, 0.5 * kind.head)
    return solids_of(boolean(BRepAlgoAPI_Fuse(), [shank], [head], f"joining {kind.name}"))[0]
