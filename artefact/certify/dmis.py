"""DMIS program that takes the points of a calibration on a coordinate measuring machine.

The datum system of the drawing, plane A, two touches on side B and one on side C, aligns the part
by hand; the same datums are measured again under control before anything else, and refine the
frame. Then all features are measured in the frame of the design. Balls are measured point by point
and constructed from their points, so that their form is kept; faces on a grid and along two dense
lines. Stylus and head angles keep clear of the body (`cmm_stylus`); between points the stylus rises
to a clearance plane above the body.

Reference:
    ISO 22093:2011 (DMIS 5.2): SNSDEF, SNSLCT, TOL, DATDEF, DATSET, FEAT, MEAS, CONST, OUTPUT.
"""

from collections.abc import Callable, Mapping

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.certify.cmm_points_file import SIDES, STAMP
from matstd.artefact.certify.cmm_stylus import TIP, TO_PIVOT, UPRIGHT, Angle, choose_stylus
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array, outward
from matstd.twin.units import DEG, T_REF

PITCH = 5.0  # between points on a face, mm: half the shortest wave that the control heights resolve

LINE_PITCH = 1.5
"""Between points on the two lines across a face, mm: waves of 3 mm and more are seen."""

RIM = 2.0  # between a point and the edge of its face, mm: a stylus of 3 mm touches the face alone
LIFT = 15.0  # of the clearance plane above the body, mm
APPROACH = 3.0  # approach distance of a point, mm
_RINGS = ((60.0, 4), (25.0, 8))  # elevation, degrees, and number of points below the pole
_PLANE_POINTS = 8


Sides = Mapping[str, tuple[Array, Array]]
"""Points (K, 3) and outward normal (3,) of the datum sides, by name."""

Limits = Mapping[str, float]
"""Tolerances of the drawing, mm: widths of zones by kind, either side of a `diameter`."""


def dmis_program(
    standard: Standard, sides: Sides, engraved: Array, limits: Limits, orientation: float
) -> str:
    """Text of the program.

    Args:
        standard: As designed; its fingerprint stands in the program and in its results.
        sides: Where `DATUM_B` is touched twice, from -x to +x, and `DATUM_C` once.
        engraved: Positions of the lettering, (N, 3), mm; points of the plane avoid them.
        limits: Tolerances of the drawing.
        orientation: Angle by which the standard is turned about z on the table of the CMM, degrees.
            The program is that of the frame of the part, so only its title differs.

    Raises:
        NotEnoughData: Fewer than three balls.
        NotReachable: A feature that no stylus reaches.
    """
    if len(standard.spheres) < 3:
        raise NotEnoughData(f"'{standard.name}' has {len(standard.spheres)} balls, 3 align it")
    high = standard.top + LIFT
    touched = {s.name: ball_points(s.centre, s.radius) for s in standard.spheres}
    touched |= {p.name: face_points(standard, p.name) for p in standard.patches}
    balls = [s.name for s in standard.spheres]
    datums = {standard.plane.name: _plane(standard, engraved)} | {
        name: (p, np.tile(n, (len(p), 1))) for name, (p, n) in sides.items() if name in SIDES
    }
    groups = {
        name: (p + TIP * n, name in balls or name in datums)
        for name, (p, n) in (datums | touched).items()
    }
    length, angles = choose_stylus(standard, groups, high)
    used = dict.fromkeys(a for chosen in angles.values() for a in chosen if a is not None)
    writer = _Writer(high)
    lines = [
        *_head(standard, length, [UPRIGHT, *(a for a in used if a != UPRIGHT)], orientation),
        *_tolerances(limits),
        *_datums(standard, sides, engraved, None),
        "MODE/PROG,MAN",
    ]
    lines += _datums(standard, sides, engraved, high, lambda k: writer.select(angles[k][0]))
    for sphere in standard.spheres:
        names = writer.points(lines, sphere.name, *touched[sphere.name], angles[sphere.name])
        size = f"{_xyz(sphere.centre)},{2 * sphere.radius:.4f}"
        lines.append(f"F({sphere.name})=FEAT/SPHERE,OUTER,CART,{size}")
        made_of = ",".join(f"FA({name})" for name in names)
        lines += _folded(f"CONST/SPHERE,F({sphere.name}),BF,{made_of}")
        lines.append(f"OUTPUT/FA({sphere.name}),TA(BALL_SIZE),TA(BALL_PLACE)")
    for patch in standard.patches:
        points = touched[patch.name]
        writer.points(lines, patch.name, *points, angles[patch.name], ",TA(FACE)")
    lines += writer.skipped
    return "\n".join([*lines, "ENDFIL", ""])


class _Writer:
    """Writes single points, and the sensor where it changes."""

    def __init__(self, high: float) -> None:
        self.high = high
        self.angle: Angle | None = UPRIGHT
        self.skipped: list[str] = []

    def points(
        self,
        lines: list[str],
        feature: str,
        points: Array,
        normals: Array,
        angles: list[Angle | None],
        tolerance: str = "",
    ) -> list[str]:
        """Append single points of a feature, by head angle; their names."""
        names, order = [], {angle: k for k, angle in enumerate(dict.fromkeys(angles))}
        rows = sorted(range(len(points)), key=lambda i: (order[angles[i]], i))
        for i in rows:
            name, p, n = f"{feature}_{i + 1}", points[i], normals[i]
            if angles[i] is None:
                self.skipped.append(f"$$ {name} is left out: no angle of the head reaches it")
                continue
            lines += self.select(angles[i])
            lines.append(f"F({name})=FEAT/POINT,CART,{_six(p, n)}")
            measured = _measured("POINT", name, p[None], n[None], self.high)
            lines += [*measured[:-1], f"{measured[-1]}{tolerance}"]
            names.append(name)
        return names

    def select(self, angle: Angle | None) -> list[str]:
        """The sensor, if it is another one, after a rise by which the head turns free."""
        if angle is None or angle == self.angle:
            return []
        self.angle = angle
        free = self.high + 2.0 * TO_PIVOT
        return [f"  GOTO/CART,0.0000,0.0000,{free:.4f}", f"SNSLCT/S({angle.label})"]


def ball_points(centre: Array, radius: float) -> tuple[Array, Array]:
    """Pole and rings of a ball, points and normals."""
    rings = [
        outward(np.linspace(0.0, 2.0 * np.pi, count, endpoint=False), elevation * DEG)
        for elevation, count in _RINGS
    ]
    n = np.concatenate([[[0.0, 0.0, 1.0]], *rings])
    return centre + radius * n, n


def face_points(standard: Standard, name: str) -> tuple[Array, Array]:
    """Points and normals of a meandering grid on a face, and of two lines between its rows."""
    patch = next(p for p in standard.patches if p.name == name)
    ends = [a - RIM for a in patch.half_size]
    axes = [np.linspace(-end, end, int(np.ceil(2 * end / PITCH)) + 1) for end in ends]
    rows = [[(u, v) for v in (axes[1] if i % 2 else axes[1][::-1])] for i, u in enumerate(axes[0])]
    # between two rows a line meets other phases of a wave than the grid
    aside = [axis[len(axis) // 2] - 0.5 * (axis[1] - axis[0]) for axis in axes]
    fine = [np.linspace(-end, end, int(np.ceil(2 * end / LINE_PITCH)) + 1) for end in ends]
    rows += [[(u, aside[1]) for u in fine[0]], [(aside[0], v) for v in fine[1]]]
    uv = np.array([pair for row in rows for pair in row])
    return patch.point(uv), patch.normal(uv)


def _head(standard: Standard, length: float, angles: list[Angle], orientation: float) -> list[str]:
    """Title, stamp, units, sensors, probing settings and what the operator prepares."""
    title = f"{standard.name} {standard.serial} {STAMP} {standard.fingerprint}".replace("'", " ")
    if orientation:
        title += f" ORIENTATION {orientation:.0f}"
    expansion = standard.material.expansion * 1e6
    turned = f", turned by {orientation:.0f} degrees about z" if orientation else ""
    return [
        f"DMISMN/'{title}',05.2",
        f"FILNAM/'{title}',05.2",
        "UNITS/MM,ANGDEC,TEMPC",
        f"$$ Stylus: ball of {2 * TIP:g} mm, {length:g} mm from its centre to the module;",
        f"$$ {TO_PIVOT:g} mm from there to the pivot of the head. Replace both by those of your",
        "$$ probe; angle A tilts the stylus, at B = 0 a tilted stylus points to -y of the part.",
        *(
            f"S({a.label})=SNSDEF/PROBE,INDEX,POL,{a.A:.1f},{a.B:.1f},0.0,0.0,1.0,"
            f"{length + TO_PIVOT:.1f},{2 * TIP:.1f}"
            for a in angles
        ),
        f"TEXT/OPER,'Seat on the table, z upwards{turned}; qualify {len(angles)} head angles.'",
        f"TEXT/OPER,'Part at {T_REF:g} C, or its temperature compensation on: {expansion:g}E-6/K.'",
        f"SNSLCT/S({UPRIGHT.label})",
        f"SNSET/APPRCH,{APPROACH:.1f}",
        f"SNSET/RETRCT,{APPROACH:.1f}",
        f"SNSET/SEARCH,{APPROACH:.1f}",
        f"SNSET/CLRSRF,{LIFT:.1f}",
        "PRCOMP/ON",
    ]


def _tolerances(limits: Limits) -> list[str]:
    """Tolerances of the drawing."""
    half, size = 0.5 * limits["profile"], limits["diameter"]
    return [
        f"T(PLATE)=TOL/FLAT,{limits['flatness']:.4f}",
        f"T(SIDE_B)=TOL/PERP,{limits['perpendicularity']:.4f},DAT(A)",
        f"T(BALL_SIZE)=TOL/DIAM,{-size:.4f},{size:.4f}",
        f"T(BALL_PLACE)=TOL/POS,3D,{limits['position']:.4f},DAT(A),DAT(B),DAT(C)",
        f"T(FACE)=TOL/PROFP,{-half:.4f},{half:.4f},DAT(A),DAT(B),DAT(C)",
    ]


def _datums(
    standard: Standard,
    sides: Sides,
    engraved: Array,
    high: float | None,
    select: Callable[[str], list[str]] = lambda _: [],
) -> list[str]:
    """Datums A, B and C, and from them the frame of the design.

    Args:
        high: Of the clearance plane, mm; None where they are touched by hand.
        select: Statements that select the sensor of a datum.
    """
    plane, half = standard.plane, np.asarray(standard.base.half_size)
    points, normals = _plane(standard, engraved)
    (along, south), (corner, west) = sides["DATUM_B"], sides["DATUM_C"]
    by_hand = high is None
    name = {k: k if by_hand else f"{k}_2" for k in (plane.name, "DATUM_B", "DATUM_C")}
    A, B, C = name.values()
    lines = [
        *(["MODE/MAN"] if by_hand else []),
        f"F({A})=FEAT/PLANE,CART,0.0000,0.0000,{plane.height:.4f},0.0,0.0,1.0",
        f"$$ near the rim, which is at {half[0]:g} and {half[1]:g} mm",
        *select(plane.name),
        *_measured("PLANE", A, points, normals, high),
        f"F({B})=FEAT/LINE,BND,CART,{_xyz(along[0])},{_six(along[1], south)}",
        *select("DATUM_B"),
        *_measured("LINE", B, along, np.tile(south, (2, 1)), high),
        f"F({C})=FEAT/POINT,CART,{_six(corner[0], west)}",
        *select("DATUM_C"),
        *_measured("POINT", C, corner, west[None], high),
    ]
    if not by_hand:
        toleranced = {f"OUTPUT/FA({A})": ",TA(PLATE)", f"OUTPUT/FA({B})": ",TA(SIDE_B)"}
        lines = [line + toleranced.get(line, "") for line in lines]
    return [
        *lines,
        f"DATDEF/FA({A}),DAT(A)",
        f"DATDEF/FA({B}),DAT(B)",
        f"DATDEF/FA({C}),DAT(C)",
        f"D(SIDES{'' if by_hand else '_2'})=DATSET/DAT(A),ZDIR,ZORIG,DAT(B),XDIR,YORIG,"
        "DAT(C),XORIG",
        f"D(PART{'' if by_hand else '_2'})=TRANS/XORIG,{-corner[0, 0]:.4f},YORIG,"
        f"{-along[0, 1]:.4f},ZORIG,{-plane.height:.4f}",
    ]


def _plane(standard: Standard, engraved: Array) -> tuple[Array, Array]:
    points = plane_points(standard, engraved)
    return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))


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


def _folded(line: str) -> list[str]:
    """A statement on lines of at most 80 characters, continued by a dollar sign."""
    out, words = [], line.split(",")
    now = words[0]
    for word in words[1:]:
        if len(now) + len(word) > 76:
            out.append(f"{now},$")
            now = word
        else:
            now = f"{now},{word}"
    return [*out, now]


def _xyz(p: Array) -> str:
    return f"{p[0]:.4f},{p[1]:.4f},{p[2]:.4f}"


def _six(p: Array, n: Array) -> str:
    return f"{_xyz(p)},{n[0]:.6f},{n[1]:.6f},{n[2]:.6f}"
