"""Whether the standard stands on its table, clear of clamps; the first check of a design.

A refusal names the body, the distance by which it is wrong, and a change that was tried: other
places of the same body, the nearest first, until one leaves fewer faults.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import LEAST_SIDE, Brief, base_of
from matstd.artefact.feasibility.turning import between, meetings, pose_words, seen_from_face
from matstd.artefact.reach import Body, Solid, hangs, table_face
from matstd.artefact.seat import (
    CONTACT_DEPTH,
    base_corners,
    common_part,
    off_table,
    over_edge,
    over_table,
    overlap,
    same_place,
    seat_height,
)
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, apply, fixed_xyz, fixed_xyz_angles, inverse, pose
from matstd.twin.record import Setup
from matstd.twin.units import DEG

SEAT_TOLERANCE = 1.0
"""Allowed gap or overlap between seat and support, mm: set-ups are measured values."""

Mesh = tuple[Array, np.ndarray]

_HANGING_COSINE = 0.5
"""Cosine between weight and the way out of the seat from which on a standard hangs."""
_BALL_BESIDE = 100.0  # a bracket on the table holds a ball so far beside its face, mm

_SHIFTS = (1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 75.0, 100.0, 150.0, 200.0, 300.0, 400.0)
"""Displacements of a clamp that are tried, mm."""

_POLYGON_SIDES = 256
"""Sides of the polygon round a disc: 0.008 mm outside it at a diameter of 200 mm."""

_TURNS = ((0.0, 0.0, 0.0), (-90.0, 0.0, 0.0), (90.0, 0.0, 0.0), (0.0, 90.0, 0.0), (0.0, -90.0, 0.0))
"""Orientations of a standard that are tried, degrees."""

_BISECTIONS = 7  # bisections of the distance to the middle of the table: 7 give 1 %
_SIDE_STEP = 10.0  # between sides of smaller bases that are tried, mm


@dataclass(frozen=True, eq=False)
class Fault:
    """A body at an impossible place."""

    key: str
    found: object
    words: str  # what is wrong, with the distance
    # displacement that frees a clamp, (3,), mm, in the frame of the face
    way: Array = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True, eq=False)
class Finished:
    """A standard with its mesh, and the readings (N, A) at which it is probed."""

    standard: Standard
    mesh: Mesh
    q: Array


def check_seat(brief: Brief) -> None:
    """Reject a standard that does not stand on its table, and bodies in its base or the table.

    Raises:
        BadFile: Body and distance, and a change of that body that was tried.
    """
    _refuse(brief, None)
    sign, axis = brief.down[0], brief.down[1]
    down = (1.0 if sign == "+" else -1.0) * np.eye(3)["XYZ".index(axis)]
    if down @ table_face(brief.setup.T_table_artefact)[:3, 2] > _HANGING_COSINE:
        expected = "a direction of weight that does not pull the standard off its seat"
        raise BadFile(brief.path, "standard.down", brief.down, expected)


def check_beside(brief: Brief, standard: Standard, mesh: Mesh, q: Array) -> None:
    """Reject bodies that overlap the finished standard at any planned pose.

    Args:
        mesh: Of it: corners (V, 3) and triangles (F, 3), artefact frame, mm.
        q: Planned readings, (N, A), mm and rad; bodies on other axes are looked at in each.

    Raises:
        BadFile: As of `check_seat`.
    """
    _refuse(brief, Finished(standard, mesh, q))


def stands(brief: Brief, setup: Setup) -> bool:
    """Whether the standard stands on the table in a set-up."""
    return next(_setup_faults(brief, setup), None) is None


def _refuse(brief: Brief, finished: Finished | None) -> None:
    """Raise BadFile for the first fault, with a change that removes it and adds none."""
    found = _faults(brief, finished)
    if not found:
        return
    first = found[0]
    for words, other in _changes(brief, first):
        left = _faults(other, finished)
        if len(left) < len(found) and all(fault.key != first.key for fault in left):
            helps = f"{words} would do"
            break
    else:
        helps = "no other place of it alone would do of those that were tried"
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    raise BadFile(brief.path, first.key, first.found, f"{first.words}{more}; {helps}")


def _faults(brief: Brief, finished: Finished | None) -> list[Fault]:
    """Faults of every set-up, and of the finished standard where there is one."""
    found = [
        fault
        for setup in brief.setups
        for check in (_setup_faults, _body_faults, _turning_faults)
        for fault in check(brief, setup)
    ]
    return found if finished is None else [*found, *_faults_in_standard(brief, finished)]


def _setup_faults(brief: Brief, setup: Setup) -> Iterator[Fault]:
    """A standard that hangs, sinks into the table, floats or overhangs."""
    T, base, table = setup.T_table_artefact, brief.blank.base, brief.table
    key, place = f"setup.{setup.name}", T[:3, 3].round(6).tolist()
    above = seat_height(T, base.half_size) - table.high
    if above < -SEAT_TOLERANCE:
        words = f"its lowest corner lies {-above:.1f} mm below"
        yield Fault(f"{key}.origin_mm", place, f"a seat on the table's face or above it: {words}")
    if hangs(brief.chain, T):
        angles = np.round(fixed_xyz_angles(T[:3, :3]) / DEG, 6).tolist()
        words = "a standard that looks towards the tool with every axis at zero: its seat does"
        yield Fault(f"{key}.rotation_deg", angles, words)
    if twin := same_place(brief.setups, setup):
        yield Fault(f"{key}.origin_mm", place, f"another place or turn than that of set-up {twin}")
    key = f"{key}.origin_mm"
    if above - brief.riser > SEAT_TOLERANCE and not _is_carried(brief, setup):
        yield Fault(
            key,
            place,
            f"a seat on the table's face: it floats {above:.1f} mm above it, and neither "
            "limits.riser_mm nor a body under it carries it",
        )
    if fault := _overhanging(brief, setup, key):
        yield fault


def _overhanging(brief: Brief, setup: Setup, key: str) -> Fault | None:
    """A base that reaches over the edge of the table by more than is stated; None for none.

    It is the fault of its size where it does so in the middle of the table too.
    """
    T, base, table, allowed = setup.T_table_artefact, brief.blank.base, brief.table, brief.overhang
    # rounded: corners of a base may lie on the edge
    beyond, in_the_middle = (round(over_edge(table, base, at), 6) for at in (T, pose(T[:3, :3])))
    if beyond <= allowed:
        return None
    apart = off_table(table, base, T)
    part = "a corner of it reaches"
    if apart > 0.0:
        part = f"it stands {apart:.1f} mm beside it, its far corner"
    words = (
        f"a base on the table ([workshop.table]): {part} {beyond:.1f} mm beyond the edge, "
        f"limits.overhang_mm is {allowed:.1f}"
    )
    if apart == 0.0 and in_the_middle > allowed:
        return Fault("blank.base_mm", [2.0 * side for side in base.half_size], words)
    return Fault(key, T[:3, 3].round(6).tolist(), words)


def _is_carried(brief: Brief, setup: Setup) -> bool:
    """Whether a stated body reaches up to the seat."""
    corners = base_corners(brief.blank.base, setup.T_table_artefact)
    return any(
        abs(solid.high - corners[:, 2].min()) <= SEAT_TOLERANCE
        and overlap(solid.corners() + np.array([0.0, 0.0, 2.0 * SEAT_TOLERANCE]), corners).depth
        > 0.0
        for _, body in _bodies(brief, setup)
        for solid in body.solids
    )


def _bodies(brief: Brief, setup: Setup) -> Iterator[tuple[int, Body]]:
    """Bodies of a set-up with their number in the file."""
    for i, body in enumerate(brief.bodies):
        if body.setup in {"", setup.name}:
            yield i, body


def _body_faults(brief: Brief, setup: Setup) -> Iterator[Fault]:
    """Bodies in the base or in the table, and a ball whose stem stands in the base."""
    base = base_corners(brief.blank.base, setup.T_table_artefact)
    table, ball = brief.table, brief.ball
    for i, body in _bodies(brief, setup):
        key, place = f"workshop.bodies.{i}.at_mm", list(body.at)
        depth, way = _penetration(body, base)
        if depth > CONTACT_DEPTH:
            words = f"{body.name} beside the standard: it reaches {depth:.1f} mm into its base"
            yield Fault(key, place, words, way)
        depth, _ = _penetration(body, table.corners(_POLYGON_SIDES))
        if depth > CONTACT_DEPTH:
            words = f"{body.name} on the table: it reaches {depth:.1f} mm into it"
            yield Fault(key, place, words, np.array([0.0, 0.0, depth]))
    if ball is not None:
        foot = over_table(table, ball.x, ball.y)
        if foot > _BALL_BESIDE:
            words = f"the ball on the table: its stem stands {foot:.0f} mm beside the face"
            yield Fault("workshop.ball.at_mm", [ball.x, ball.y, ball.z], words)
        stem = Solid("stem", (ball.stem, ball.stem), True, table.high, ball.z, ball.x, ball.y)
        met = overlap(stem.corners(), base)
        if met.depth > CONTACT_DEPTH:
            words = (
                f"the ball beside the standard: its stem reaches {met.depth:.1f} mm into its base"
            )
            place = [ball.x, ball.y, ball.z]
            yield Fault("workshop.ball.at_mm", place, words, np.append(met.aside, 0.0))


def _penetration(body: Body, other: Array) -> tuple[float, Array]:
    """Depth of a body inside the hull of some corners, mm, and its shortest way out (3,)."""
    if body.mesh is not None:
        return _extent(common_part(*body.mesh, other))
    met = [overlap(solid.corners(_POLYGON_SIDES), other) for solid in body.solids]
    deepest = max(met, key=lambda one: one.depth)
    return deepest.depth, np.append(deepest.aside, 0.0)


def _extent(common: Array) -> tuple[float, Array]:
    """Smallest side of the box round a common part, and the shorter way along x or y."""
    if not len(common):
        return 0.0, np.zeros(3)
    sides = np.ptp(common, axis=0)
    axis = int(np.argmin(sides[:2]))
    return float(sides.min()), np.eye(3)[axis] * sides[axis]


def _turning_faults(brief: Brief, setup: Setup) -> Iterator[Fault]:
    """Bodies on other axes that meet the base or the table while it turns."""
    for one in meetings(brief, setup):
        at = pose_words(brief, one.pose)
        words = (
            f"{one.body.name} clear of what turns past it: at {at} it reaches {one.depth:.1f} mm "
            f"into {one.met}"
        )
        yield Fault(f"workshop.bodies.{one.number}.at_mm", list(one.body.at), words)


def _faults_in_standard(brief: Brief, finished: Finished) -> Iterator[Fault]:
    """Bodies that overlap faces, posts or balls, by the mesh of the standard."""
    standard, mesh = finished.standard, finished.mesh
    for setup in brief.setups:
        T_table_artefact = setup.T_table_artefact
        T_face_artefact = inverse(table_face(T_table_artefact)) @ T_table_artefact
        corners = apply(T_face_artefact, mesh[0])
        for i, body in _bodies(brief, setup):
            names = between(brief, body)
            q = _distinct(brief, names, finished.q)
            for row, T in zip(q, seen_from_face(brief, setup, body, q), strict=True):
                common = _common(body, T, (corners, mesh[1]))
                depth, way = _extent(common)
                if depth <= CONTACT_DEPTH:
                    continue
                near = apply(inverse(T_face_artefact), common.mean(axis=0, keepdims=True))
                met = min(standard.bodies, key=lambda n: standard.bodies[n].distance(near)[0])
                pose = {name: float(row[brief.chain.axis_index(name)]) for name in names}
                at = f" at {pose_words(brief, pose)}" if pose else ""
                words = f"{body.name} beside the standard: it reaches {depth:.1f} mm into {met}{at}"
                yield Fault(f"workshop.bodies.{i}.at_mm", list(body.at), words, way)
                break


def _distinct(brief: Brief, names: Sequence[str], q: Array) -> Array:
    """Readings that differ in some axes, (N, A), with all others at zero."""
    out = np.zeros_like(q)
    columns = [brief.chain.axis_index(name) for name in names]
    out[:, columns] = q[:, columns]
    return np.asarray(np.unique(out.round(9), axis=0))


def _common(body: Body, T_face_still: Array, mesh: Mesh) -> Array:
    """Corners (V, 3) of what a turned body has in common with the standard."""
    own = [body.mesh] if body.mesh else [(s.corners(_POLYGON_SIDES), None) for s in body.solids]
    turned = [(apply(T_face_still, corners), triangles) for corners, triangles in own]
    return np.concatenate([common_part(*mesh, *other) for other in turned])


def _changes(brief: Brief, fault: Fault) -> Iterator[tuple[str, Brief]]:
    """Other places of a body, the nearest first, each with its words."""
    _, name, *_ = fault.key.split(".")
    if fault.key == "blank.base_mm":
        yield from _smaller_bases(brief)
        yield from _more_overhang(brief, brief.setups)
        return
    if fault.key.startswith("setup."):
        yield from _other_seats(brief, name)
        return
    away = np.array(fault.found, dtype=float)
    ways = [fault.way, -fault.way, *np.eye(3)[:2], *-np.eye(3)[:2], np.append(away[:2], 0.0)]
    for more in _SHIFTS:
        for way in ways:
            length = float(np.linalg.norm(way))
            if length > 0.0:
                # away from where it stands, in whole millimetres
                shift = way / length * (max(length, more) if way is fault.way else more)
                place = np.array(fault.found) + np.sign(shift) * np.ceil(np.abs(shift) - 1e-9)
                place = np.round(place, 1) + 0.0  # as it is written
                words = f"{fault.key} = {_list(place)}"
                yield words, _with_body(brief, fault.key, place)


def _with_body(brief: Brief, key: str, place: Array) -> Brief:
    """The brief with a body, or the ball, somewhere else."""
    x, y, z = map(float, place)
    if key.startswith("workshop.ball"):
        assert brief.ball is not None
        return replace(brief, ball=replace(brief.ball, x=x, y=y, z=z))
    bodies, i = list(brief.bodies), int(key.split(".")[2])
    bodies[i] = replace(bodies[i], at=(x, y, z))
    return replace(brief, bodies=tuple(bodies))


def _other_seats(brief: Brief, name: str) -> Iterator[tuple[str, Brief]]:
    """Set-ups on the face, moved towards the middle as far as needed, or turned over.

    The required share of the way is bisected; 1 stays, 0 is the middle.
    """
    setups = brief.setups
    k = next(k for k, setup in enumerate(setups) if setup.name == name)
    T = setups[k].T_table_artefact
    face = table_face(T)[:3, :3]
    on_face = face.T @ T[:3, 3]
    height = brief.table.high - seat_height(T, brief.blank.base.half_size)
    for angles in _TURNS if hangs(brief.chain, T) else ():
        setup = Setup(name, pose(fixed_xyz(np.array(angles) * DEG), T[:3, 3]), setups[k].run)
        if stands(brief, setup):
            words = f"setup.{name}.rotation_deg = {_list(np.array(angles))}"
            yield words, _with_setup(brief, k, setup)
    for up in (0.0, height):
        low, high, best = 0.0, 1.0, None  # share of the way that is kept
        for share in (1.0, 0.0, *[None] * _BISECTIONS):
            share = 0.5 * (low + high) if share is None else share
            place = on_face.copy() if share == 1.0 else np.trunc(share * on_face)
            place[2] = on_face[2] + up
            moved = T.copy()
            moved[:3, 3] = np.round(face @ place, 1) + 0.0  # as it is written
            setup = replace(setups[k], T_table_artefact=moved)
            if stands(brief, setup):
                best, low = setup, share
            else:
                high = share
            if low == 1.0 or (best is None and share == 0.0):
                break
        if best is not None:
            words = f"setup.{name}.origin_mm = {_list(best.T_table_artefact[:3, 3])}"
            yield words, _with_setup(brief, k, best)
    if not hangs(brief.chain, T):
        yield from _more_overhang(brief, setups[k : k + 1])


def _smaller_bases(brief: Brief) -> Iterator[tuple[str, Brief]]:
    """Bases of the same proportions, the largest first."""
    half = np.array(brief.blank.base.half_size)
    for longest in np.arange(2.0 * half.max() - _SIDE_STEP, LEAST_SIDE - 1.0, -_SIDE_STEP):
        sides = np.floor(longest * half / half.max() / _SIDE_STEP) * _SIDE_STEP
        if sides.min() >= LEAST_SIDE:
            blank = replace(brief.blank, base=base_of((float(sides[0]), float(sides[1]))))
            yield f"blank.base_mm = {_list(sides)}", replace(brief, blank=blank)


def _more_overhang(brief: Brief, setups: Sequence[Setup]) -> Iterator[tuple[str, Brief]]:
    """The overhang that set-ups need which stand on the table in part."""
    table, base = brief.table, brief.blank.base
    places = [setup.T_table_artefact for setup in setups]
    beyond = float(np.ceil(max(over_edge(table, base, T) for T in places)))
    if all(off_table(table, base, T) == 0.0 for T in places) and beyond > 0.0:
        yield f"limits.overhang_mm = {beyond:g}", replace(brief, overhang=beyond)


def _with_setup(brief: Brief, k: int, setup: Setup) -> Brief:
    """The brief with its set-up number k somewhere else."""
    return replace(brief, setups=(*brief.setups[:k], setup, *brief.setups[k + 1 :]))


def _list(place: Array) -> str:
    return f"[{', '.join(f'{v:g}' for v in place)}]"
