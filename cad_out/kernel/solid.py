"""The standard's body as one solid of the CAD kernel, faces found by the surfaces put in."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid
from OCP.BRepClass3d import BRepClass3d
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakePrism
from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Ax2, gp_Pnt, gp_Vec
from OCP.ShapeCustom import ShapeCustom
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain

from matstd.artefact.body import BLEND, Base, DatumSphere, FreeformPatch, MountingHole, Standard
from matstd.cad_out.details import RELIEF, Details, Pad, Seat, Side, relief_profile
from matstd.cad_out.kernel.faces import (
    FaceNaming,
    edges_of,
    ends_and_middle,
    is_valid,
    named_faces,
    shells_of,
    solids_of,
    volume,
)
from matstd.cad_out.kernel.letters import engraved
from matstd.cad_out.kernel.primitives import (
    boolean,
    bore_solid,
    box,
    cone,
    direction,
    plate,
    point,
    revolved,
)
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array, apply

_FACE_TOLERANCE = 1e-7  # mm, of the kernel's own edges
_POST_DEPTH = 2.0  # mm a post goes on into the base, so that no two faces coincide
_ON = 1e-5  # mm: an edge lies on an outline


@dataclass(frozen=True, slots=True)
class Solid:
    """A finished body of the kernel."""

    shape: Any
    plain: Any  # the same without its lettering, which needs a hundred times as many triangles
    # FaceNaming faces: FF1 ..., DATUM_A, DATUM_B, DATUM_C, seats, bores and holes
    faces: dict[str, Any]
    plain_faces: dict[str, Any]  # the same of the plain body


def build_solid(standard: Standard, details: Details) -> Solid:
    """One valid closed solid: columns and posts, one fuse, blends, one cut, lettering.

    Every column is the prism of its spline face (6 mm larger than the pad) cut out by the pad's
    own box, so its walls are planes and its lid is the spline itself, not an approximation.

    Raises:
        NotBuildable: The kernel's result is not one valid solid, or has lost a face.
    """
    surfaces = {patch.name: spline_surface(patch) for patch in standard.patches}
    parts = [column_solid(patch, surfaces[patch.name], standard.base) for patch in standard.patches]
    parts += [_post(sphere, details.seats[sphere.name]) for sphere in standard.spheres]
    if standard.core is not None:
        core, low = standard.core, 0.5 * standard.base.thickness
        parts.append(cone(0.0, 0.0, low, core.height, core.low_radius, core.high_radius))
    body = boolean(BRepAlgoAPI_Fuse(), [plate(standard.base)], parts, "joining the columns")
    merged = ShapeUpgrade_UnifySameDomain(body, True, True, False)
    merged.Build()
    body = _blended(_only_solid(merged.Shape(), standard.name), standard)
    if tools := plate_cuts(standard, details):
        body = boolean(BRepAlgoAPI_Cut(), [body], tools, "drilling the holes")
    plain = _finished(body, standard.name)
    solid = _finished(engraved(plain, details.lettering), standard.name)
    wanted = FaceNaming(standard, details, surfaces)
    return Solid(solid, plain, named_faces(wanted, solid), named_faces(wanted, plain))


def plate_cuts(standard: Standard, details: Details) -> list[Any]:
    """What is cut out of the plate, whatever stands on it: holes, flats, bores and relief."""
    base = standard.base
    tools = [tool for hole in standard.holes for tool in _hole_cuts(hole, base)]
    tools += [_flat_cut(side, base) for side in details.sides.values() if side.flat]
    tools += [bore_solid(bore) for bore in details.bores]
    return tools + ([_relief_cut(details.pads, base)] if details.pads else [])


def _finished(body: Any, name: str) -> Any:
    """One valid solid; faces on left-handed primitives would lose their names in the STEP file."""
    return _only_solid(ShapeCustom.DirectFaces_s(body), name)


def spline_surface(patch: FreeformPatch) -> Any:
    """The patch's B-spline as the kernel's surface, from its own poles and knots: no fit."""
    poles = patch.poles
    net = Array2_gp_Pnt(1, poles.shape[0], 1, poles.shape[1])
    for i in range(poles.shape[0]):
        for j in range(poles.shape[1]):
            net.SetValue(i + 1, j + 1, gp_Pnt(*map(float, poles[i, j])))
    knots_u, counts_u = _knot_arrays(patch.knots_u)
    knots_v, counts_v = _knot_arrays(patch.knots_v)
    return Geom_BSplineSurface(
        net, knots_u, knots_v, counts_u, counts_v, *patch.degree, False, False
    )


def _knot_arrays(knots: Array) -> tuple[Any, Any]:
    values, counts = np.unique(knots, return_counts=True)
    distinct, multiplicity = Array1_double(1, len(values)), Array1_int(1, len(values))
    for k, (value, count) in enumerate(zip(values, counts, strict=True), 1):
        distinct.SetValue(k, float(value))
        multiplicity.SetValue(k, int(count))
    return distinct, multiplicity


def column_solid(patch: FreeformPatch, surface: Any, base: Base) -> Any:
    """Prism of the face, trimmed by the pad's box and cut off in mid-base."""
    face = BRepBuilderAPI_MakeFace(surface, _FACE_TOLERANCE).Face()
    span = float(patch.heights.max() - patch.heights.min())
    back = -(patch.depth + span + 10.0) * patch.direction
    prism = BRepPrimAPI_MakePrism(face, gp_Vec(*map(float, back))).Shape()
    a, b = patch.half_size
    T = patch.T_artefact_patch
    corner = T[:3, 3] - a * T[:3, 0] - b * T[:3, 1] - patch.depth * T[:3, 2]
    frame = gp_Ax2(point(corner), direction(T[:3, 2]), direction(T[:3, 0]))
    height = patch.depth + float(patch.heights.max()) + 5.0
    trim = BRepPrimAPI_MakeBox(frame, 2.0 * a, 2.0 * b, height).Shape()
    column = boolean(BRepAlgoAPI_Common(), [prism], [trim], f"trimming {patch.name}")
    end = [[x, y, -patch.depth] for x in (-a, a) for y in (-b, b)]
    if apply(T, np.array(end))[:, 2].min() > 0.5 * base.thickness:
        return column
    far = 1000.0
    above = box([-far, -far, 0.5 * base.thickness], [far, far, far])
    return boolean(BRepAlgoAPI_Common(), [column], [above], f"cutting off {patch.name}")


def _post(sphere: DatumSphere, seat: Seat) -> Any:
    """Cone up to the land round the seat, continued into the base with the same taper."""
    taper = (sphere.foot_radius - sphere.stem_radius) / (sphere.centre[2] - sphere.foot)
    low = sphere.foot - _POST_DEPTH
    profile = [
        (0.0, low),
        (sphere.foot_radius + _POST_DEPTH * taper, low),
        (seat.top_radius, seat.top),
        (seat.rim_radius, seat.top),
        (0.0, seat.bottom),
    ]
    return revolved(float(sphere.centre[0]), float(sphere.centre[1]), profile)


def _blended(body: Any, standard: Standard) -> Any:
    """The body with its feet rounded into the plate."""
    edges = [edge for edge in edges_of(body) if _is_foot(ends_and_middle(edge), standard)]
    if not edges:
        return body
    maker = BRepFilletAPI_MakeFillet(body)
    for edge in edges:
        maker.Add(BLEND, edge)
    maker.Build()
    if not maker.IsDone():
        raise NotBuildable(
            f"standard '{standard.name}': the CAD kernel cannot round {len(edges)} inner edges "
            f"with {BLEND:g} mm"
        )
    return _only_solid(maker.Shape(), standard.name)


def _is_foot(points: Array, standard: Standard) -> bool:
    """Whether an edge runs round the foot of a pillar or a post that gets a blend."""
    if np.abs(points[:, 2] - standard.base.thickness).max() > _ON:
        return False
    for patch in standard.patches:
        beyond = np.abs(points[:, :2] - patch.T_artefact_patch[:2, 3]) - patch.half_size
        if patch.name in standard.blended and np.abs(beyond.max(axis=1)).max() < _ON:
            return True
    for s in standard.spheres:
        off = np.hypot(*(points[:, :2] - s.centre[:2]).T) - s.foot_radius
        if s.name in standard.blended and np.abs(off).max() < _ON:
            return True
    return False


def _hole_cuts(hole: MountingHole, base: Base) -> list[Any]:
    """Material that is removed for a screw to the table and its head."""
    through = cone(hole.x, hole.y, -1.0, base.thickness + 1.0, hole.radius, hole.radius)
    floor = base.thickness - hole.bore_depth
    bore = cone(hole.x, hole.y, floor, base.thickness + 1.0, hole.bore_radius, hole.bore_radius)
    return [through, bore]


def _flat_cut(side: Side, base: Base) -> Any:
    """Material that is removed from a round side for a flat."""
    far = 2.0 * max(base.half_size)
    low, high = np.array([-far, -far, -1.0]), np.array([far, far, base.thickness])
    outwards = np.array([*side.normal, 0])
    low[outwards > 0], high[outwards < 0] = side.offset, -side.offset
    return box(low.tolist(), high.tolist())


def _relief_cut(pads: tuple[Pad, ...], base: Base) -> Any:
    """Material that is removed from the underside between the pads."""
    a, b = (half + 1.0 for half in base.half_size)
    slab = box([-a, -b, -1.0], [a, b, RELIEF])
    standing = []
    for pad in pads:
        wide, below = relief_profile(pad.radius)
        radius = RELIEF - below
        # of the arc from the flank's lower end to the floor, seen from the middle of its circle
        half = 0.5 * float(np.arccos(-below / radius))
        middle = wide - radius * np.sin(half), below + radius * np.cos(half)
        standing.append(
            revolved(
                pad.x,
                pad.y,
                [
                    (0.0, -2.0),
                    (pad.radius, -2.0),
                    (pad.radius, 0.0),
                    (wide, RELIEF, *middle),
                    (wide, RELIEF + 1.0),
                    (0.0, RELIEF + 1.0),
                ],
            )
        )
    return boolean(BRepAlgoAPI_Cut(), [slab], standing, "relieving the underside")


def _only_solid(shape: Any, name: str) -> Any:
    solids = solids_of(shape)
    if len(solids) != 1:
        sizes = ", ".join(f"{volume(solid):.0f}" for solid in solids)
        raise NotBuildable(
            f"standard '{name}' falls into {len(solids)} solids of {sizes} mm^3; a column or a "
            "stem does not reach the body"
        )
    if not is_valid(solids[0]):
        raise NotBuildable(f"standard '{name}': the CAD kernel calls its own solid invalid")
    return without_pockets(solids[0])


def without_pockets(solid: Any) -> Any:
    """The solid with its closed pockets filled; one without any comes back as it is.

    Columns that lean together above the plate can enclose a small wedge of air, which cannot be
    cut, probed or cleaned.
    """
    if len(shells_of(solid)) == 1:
        return solid
    return BRepBuilderAPI_MakeSolid(BRepClass3d.OuterShell_s(solid)).Solid()
