"""A standard as separate parts for the workshop: plate, studs, blocks, with balls and screws."""

from collections.abc import Sequence
from typing import Any

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.ShapeCustom import ShapeCustom

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.cad_out.details import SCREW, Details, Seat
from matstd.cad_out.kernel.assembly import Product, whole_name
from matstd.cad_out.kernel.faces import is_valid, solids_of
from matstd.cad_out.kernel.primitives import boolean, box, cone, plate, revolved
from matstd.cad_out.kernel.solid import column_solid, plate_cuts, spline_surface
from matstd.cad_out.making import PAD_HEIGHT, Block, Joints, Stud
from matstd.twin.errors import NotBuildable

_HERE = (0.0, 0.0, 0.0)
_GREY, _DARK = (0.66, 0.68, 0.70), (0.25, 0.26, 0.28)
_FAR = 1000.0  # mm


def parts_of(
    standard: Standard, details: Details, joints: Joints, bought: Sequence[Product]
) -> tuple[Product, ...]:
    """Every part as a product, the plate first.

    Args:
        bought: Balls and screws to the table.

    Raises:
        NotBuildable: The kernel's result is not one valid solid.
    """
    made = [_made(standard, "PLATE", "Ground plate", _plate(standard, details, joints))]
    for block, patch in zip(joints.blocks, standard.patches, strict=True):
        words = f"Block of {patch.name}, three pads, M{block.thread:g} tapped"
        made.append(_made(standard, f"{patch.name} BLOCK", words, _block(standard, patch, block)))
    seats = details.seats
    for stud, ball in zip(joints.studs, standard.spheres, strict=True):
        words = f"Stud of {ball.name}, turned, thread M{stud.thread:g}"
        made.append(
            _made(standard, f"{ball.name} STUD", words, _stud(ball, seats[ball.name], stud))
        )
    return (*made, *bought, *_screws(joints))


def _made(standard: Standard, name: str, about: str, shape: Any) -> Product:
    """A part of the standard's material, where it stands."""
    solids = solids_of(ShapeCustom.DirectFaces_s(shape))
    if len(solids) != 1 or not is_valid(solids[0]):
        raise NotBuildable(f"'{whole_name(standard)}': {name} is not one valid solid")
    return Product(
        name=name,
        about=about,
        shape=solids[0],
        faces={},
        material=standard.material,
        colour=_GREY,
        places=((name, _HERE),),
    )


def _plate(standard: Standard, details: Details, joints: Joints) -> Any:
    base, tools = standard.base, plate_cuts(standard, details)
    for stud, ball in zip(joints.studs, standard.spheres, strict=True):
        x, y, _ = ball.centre
        tools.append(cone(x, y, -1.0, base.thickness + 1.0, 0.5 * stud.core, 0.5 * stud.core))
    for block in joints.blocks:
        for x, y in block.places:
            through, head = 0.5 * block.through, 0.5 * block.head
            tools.append(cone(x, y, -1.0, base.thickness + 1.0, through, through))
            tools.append(cone(x, y, -1.0, block.sunk, head, head))
    return boolean(BRepAlgoAPI_Cut(), [plate(base)], tools, "drilling the plate")


def _block(standard: Standard, patch: FreeformPatch, block: Block) -> Any:
    """The column above the plate, relieved between its pads, with its threads."""
    low = standard.base.thickness
    column = column_solid(patch, spline_surface(patch), standard.base)
    above = box([-_FAR, -_FAR, low], [_FAR, _FAR, _FAR])
    body = boolean(BRepAlgoAPI_Common(), [column], [above], f"cutting off {patch.name}")
    slab = box([-_FAR, -_FAR, low - 1.0], [_FAR, _FAR, low + PAD_HEIGHT])
    pads = [cone(x, y, low - 2.0, low + 1.0, block.pad, block.pad) for x, y in block.places]
    tools = [boolean(BRepAlgoAPI_Cut(), [slab], pads, f"pads of {patch.name}")]
    core = 0.5 * block.core
    tools += [cone(x, y, low - 1.0, block.depth, core, core) for x, y in block.places]
    return boolean(BRepAlgoAPI_Cut(), [body], tools, f"relieving {patch.name}")


def _stud(ball: DatumSphere, seat: Seat, stud: Stud) -> Any:
    x, y, _ = ball.centre
    core, end = 0.5 * stud.core, ball.foot - stud.depth
    profile = [
        (0.0, end),
        (core, end),
        (core, ball.foot),
        (ball.foot_radius, ball.foot),
        (seat.top_radius, seat.top),
        (seat.rim_radius, seat.top),
        (0.0, seat.bottom),
    ]
    return revolved(float(x), float(y), profile)


def _screws(joints: Joints) -> list[Product]:
    """Screws of the blocks, from below; those of one length are instances of one part."""
    out: list[Product] = []
    for block in joints.blocks:
        name = f"ISO 4762 M{block.thread:g}x{block.length:g} {block.face}"
        places = [(float(x), float(y), block.sunk) for x, y in block.places]
        shank = cone(0.0, 0.0, 0.0, block.length, 0.5 * block.core, 0.5 * block.core)
        head = 0.5 * (block.head - 1.0)
        top = cone(0.0, 0.0, -block.thread, 0.0, head, head)
        shape = solids_of(boolean(BRepAlgoAPI_Fuse(), [shank], [top], f"joining {name}"))[0]
        out.append(
            Product(
                name=name,
                about="Cylinder-head screw of a block, bought",
                shape=shape,
                faces={},
                material=SCREW,
                colour=_DARK,
                places=tuple((f"{block.face}_SCREW{k}", p) for k, p in enumerate(places, 1)),
            )
        )
    return out
