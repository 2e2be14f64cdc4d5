"""DMIS program that takes the points of a calibration on a coordinate measuring machine.

The datum system of the drawing, plane A, two touches on side B and one on side C, aligns the part
by hand, then all features are measured in the frame of the design with one upright stylus. Every
ball is a sphere and every face point a single point, so that any DMIS software can run the program
and list x, y and z. Between points the stylus rises to a clearance plane.

Reference:
    ISO 22093:2011 (DMIS 5.2): DATSET, FEAT, MEAS, PTMEAS, OUTPUT.
"""

from collections.abc import Mapping

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.certify.cmm_points_file import STAMP
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array
from matstd.twin.units import DEG

PITCH = 5.0
"""Between points on a face, mm: half the shortest wave that the control heights resolve."""

RIM = 2.0
"""Between a point and the edge of its face, mm: a stylus of 2 mm rests on the face alone."""

LIFT = 15.0
"""Of the clearance plane above the standard, mm."""

APPROACH = 3.0
"""Approach distance of a point, mm."""

_RINGS = ((60.0, 4), (25.0, 8))  # elevation, degrees, and number of points below the pole
_PLANE_POINTS = 8


Sides = Mapping[str, tuple[Array, Array]]
"""Points (K, 3) and outward normal (3,) of the datum sides, by name."""


def dmis_program(standard: Standard, sides: Sides, engraved: Array) -> str:
    """Text of the program.

    Args:
        standard: As designed; its fingerprint stands in the program and in its results.
        sides: Where `DATUM_B` is touched twice, from -x to +x, and `DATUM_C` once.
        engraved: Positions of the lettering, (N, 3), mm; points of the plane avoid them.
    """
    if len(standard.spheres) < 3:
        raise NotEnoughData(f"'{standard.name}' has {len(standard.spheres)} balls, 3 align it")
    high = max(body_top(standard), standard.blank_height) + LIFT
    lines = [*_head(standard), *_aligned(standard, sides, engraved), "MODE/PROG,MAN"]
    for sphere in standard.spheres:
        size = f"{_xyz(sphere.centre)},{2 * sphere.radius:.4f}"
        lines.append(f"F({sphere.name})=FEAT/SPHERE,OUTER,CART,{size}")
        points, normals = ball_points(sphere.centre, sphere.radius)
        lines += _measured("SPHERE", sphere.name, points, normals, high)
    for patch in standard.patches:
        points, normals = face_points(standard, patch.name)
        for k, (p, n) in enumerate(zip(points, normals, strict=True)):
            name = f"{patch.name}_{k + 1}"
            lines.append(f"F({name})=FEAT/POINT,CART,{_six(p, n)}")
            lines += _measured("POINT", name, p[None], n[None], high)
    return "\n".join([*lines, "ENDFIL", ""])


def body_top(standard: Standard) -> float:
    """Height of the highest feature, mm."""
    tops = [float(p.point(p.grid()).max(axis=0)[2]) for p in standard.patches]
    return max([*tops, *(float(s.centre[2] + s.radius) for s in standard.spheres)])


def ball_points(centre: Array, radius: float) -> tuple[Array, Array]:
    """Pole and rings of a ball, points and normals."""
    normals = [np.array([0.0, 0.0, 1.0])]
    for elevation, count in _RINGS:
        e = elevation * DEG
        for a in np.linspace(0.0, 2.0 * np.pi, count, endpoint=False):
            normals.append(np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]))
    n = np.stack(normals)
    return centre + radius * n, n


def face_points(standard: Standard, name: str) -> tuple[Array, Array]:
    """Points and normals of a meandering grid on a face."""
    patch = next(p for p in standard.patches if p.name == name)
    axes = [np.linspace(-a + RIM, a - RIM, int(np.ceil(2 * (a - RIM) / PITCH)) + 1)
            for a in patch.half_size]  # fmt: skip
    rows = [[(u, v) for v in (axes[1] if i % 2 else axes[1][::-1])] for i, u in enumerate(axes[0])]
    uv = np.array([pair for row in rows for pair in row])
    return patch.point(uv), patch.normal(uv)


def _head(standard: Standard) -> list[str]:
    """Title, stamp, units and probing settings."""
    title = f"{standard.name} {standard.serial} {STAMP} {standard.fingerprint}".replace("'", " ")
    return [
        f"DMISMN/'{title}',05.2",
        f"FILNAM/'{title}',05.2",
        "UNITS/MM,ANGDEC",
        "$$ One upright stylus, qualified; its label stands for S(1).",
        "$$ Seat on the table of the CMM, z of the standard upwards; temperature 20 degC.",
        f"SNSET/APPRCH,{APPROACH:.1f}",
        f"SNSET/RETRCT,{APPROACH:.1f}",
        f"SNSET/SEARCH,{APPROACH:.1f}",
        "PRCOMP/ON",
    ]


def _aligned(standard: Standard, sides: Sides, engraved: Array) -> list[str]:
    """Datums A, B and C by hand, and from them the frame of the design."""
    plane, half = standard.plane, np.asarray(standard.base.half_size)
    points = plane_points(standard, engraved)
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    (along, south), (corner, west) = sides["DATUM_B"], sides["DATUM_C"]
    return [
        "MODE/MAN",
        f"F({plane.name})=FEAT/PLANE,CART,0.0000,0.0000,{plane.height:.4f},0.0,0.0,1.0",
        f"$$ near the rim, which is at {half[0]:g} and {half[1]:g} mm",
        *_measured("PLANE", plane.name, points, normals, None),
        f"F(DATUM_B)=FEAT/LINE,BND,CART,{_xyz(along[0])},{_six(along[1], south)}",
        *_measured("LINE", "DATUM_B", along, np.tile(south, (2, 1)), None),
        f"F(DATUM_C)=FEAT/POINT,CART,{_six(corner[0], west)}",
        *_measured("POINT", "DATUM_C", corner, west[None], None),
        f"DATDEF/FA({plane.name}),DAT(A)",
        "DATDEF/FA(DATUM_B),DAT(B)",
        "DATDEF/FA(DATUM_C),DAT(C)",
        "D(SIDES)=DATSET/DAT(A),ZDIR,ZORIG,DAT(B),XDIR,YORIG,DAT(C),XORIG",
        f"D(PART)=TRANS/XORIG,{-corner[0, 0]:.4f},YORIG,{-along[0, 1]:.4f},"
        f"ZORIG,{-plane.height:.4f}",
    ]


def plane_points(standard: Standard, engraved: Array) -> Array:
    """Points of the datum plane, far out and clear of bodies and lettering, (8, 3)."""
    height, half = standard.plane.height, np.asarray(standard.base.half_size)
    out = []
    for angle in 2.0 * np.pi * (np.arange(_PLANE_POINTS) + 0.5) / _PLANE_POINTS:
        way = np.array([np.cos(angle), np.sin(angle)])
        reach = float(np.min(half / np.maximum(np.abs(way), 1e-9)))
        r = np.arange(0.3, 0.93, 0.02) * reach
        tried = np.column_stack([r[:, None] * way, np.full(len(r), height + 4.0)])
        room = np.min(
            [b.distance(tried) for n, b in standard.bodies.items() if n != "BASE"], axis=0
        )
        for mark in engraved[np.abs(engraved[:, 2] - height) < RIM]:
            room = np.minimum(room, np.hypot(*(tried - mark)[:, :2].T))
        out.append(np.array([*(r[int(np.argmax(np.minimum(room, 8.0) + 1e-3 * r))] * way), height]))
    return np.stack(out)


def _measured(kind: str, name: str, points: Array, normals: Array, high: float | None) -> list[str]:
    """One feature with its points; approached from a clearance plane where one is given."""
    lines = [f"MEAS/{kind},F({name}),{len(points)}"]
    for p, n in zip(points, normals, strict=True):
        out = p + APPROACH * n
        above = [f"  GOTO/CART,{out[0]:.4f},{out[1]:.4f},{high:.4f}"] if high is not None else []
        lines += [*above, f"  PTMEAS/CART,{_six(p, n)}", *above]
    return [*lines, "ENDMES", f"OUTPUT/FA({name})"]


def _xyz(p: Array) -> str:
    return f"{p[0]:.4f},{p[1]:.4f},{p[2]:.4f}"


def _six(p: Array, n: Array) -> str:
    return f"{_xyz(p)},{n[0]:.6f},{n[1]:.6f},{n[2]:.6f}"
