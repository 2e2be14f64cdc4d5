"""Joints of a standard that is made of parts: plate, turned studs, a block for every face.

A stud bears on the plate with a shoulder as wide as the foot of a post and is held by its thread;
the hole goes through the plate, so that no air is caught under it. A block bears on three pads and
is held by three screws from below, so that tightening them bends nothing. Outside, the parts are
the body in one piece but for the fillets at its feet: programs and calibration are the same.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.cad_out.details import RELIEF, Details
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array

PAD_HEIGHT = 0.5  # height of the pads of a block, mm
_SIZES = (  # thread, core, through hole, head (ISO 261, 273, 4762), mm
    (12.0, 10.2, 13.5, 18.0),
    (10.0, 8.5, 11.0, 16.0),
    (8.0, 6.8, 9.0, 13.0),
    (6.0, 5.0, 6.6, 10.0),
    (5.0, 4.2, 5.5, 8.5),
    (4.0, 3.3, 4.5, 7.0),
)
_LENGTHS = (12.0, 16.0, 20.0, 25.0, 30.0)  # of ISO 4762, mm
_PAD_RING = 2.5  # mm of a pad round its thread
_ENGAGED, _SCREWED = 1.5, 1.25  # depth of a thread and reach of its screw, by the diameter
_SHOULDER = 0.65  # most of the foot's diameter that the thread may take
_EDGE = 0.2
"""Between a pad and the edge of its block, mm: places are rounded to 0.1, and a circle that touches
an edge makes a face that is not valid when it is read again."""
_WALL = 3.0  # mm between a hole and the next, and between a thread and a face
_PLATE_LEFT = 8.0  # mm of plate over the head of a screw that is let into its underside
_SHARES = (0.7, 0.6, 0.5, 0.4)  # of the half sides of a block, where its screws may be
_TURNS = 8


@dataclass(frozen=True, slots=True)
class Stud:
    """A turned post with its thread."""

    ball: str  # its name
    thread: float  # diameter, mm
    core: float  # diameter of its hole before tapping, mm
    depth: float  # length of the thread below the shoulder, mm


@dataclass(frozen=True, eq=False)
class Block:
    """A face on a part of its own."""

    face: str  # its name
    places: Array  # of its three screws and pads, (3, 2), mm
    pad: float  # radius of the pads, mm
    thread: float  # diameter of the screws, mm
    core: float  # diameter of their holes in the block before tapping, mm
    through: float  # diameter of their holes in the plate, mm
    head: float  # diameter of the holes for their heads in the underside, mm
    sunk: float  # height of the plane on which the heads bear, mm
    depth: float  # height at which the hole for the thread ends in the block, mm
    length: float  # of a screw below its head, mm


@dataclass(frozen=True, eq=False)
class Joints:
    """All joints of a standard of parts."""

    studs: tuple[Stud, ...]
    blocks: tuple[Block, ...]


def joints_of(standard: Standard, details: Details) -> Joints:
    """Joints of a standard whose posts and faces stand upright on its plate.

    Raises:
        NotBuildable: Leaning faces, or no room for a thread or a screw.
    """
    if standard.core is not None or not all(patch.is_upright for patch in standard.patches):
        raise NotBuildable(f"'{standard.name}' cannot be made of parts: a face leans")
    studs = tuple(_stud(ball, standard, details) for ball in standard.spheres)
    return Joints(studs, tuple(_block(patch, standard, details) for patch in standard.patches))


def joints_if_any(standard: Standard, details: Details) -> Joints | None:
    """Joints of a standard; None where it cannot be made of parts."""
    try:
        return joints_of(standard, details)
    except NotBuildable:
        return None


def _stud(ball: DatumSphere, standard: Standard, details: Details) -> Stud:
    """The largest thread that the shoulder and the plate leave room for."""
    at = ball.centre[:2]
    for thread, core, *_ in _SIZES:
        depth = min(_ENGAGED * thread, standard.base.thickness - RELIEF - _WALL)
        fits = thread <= 2.0 * _SHOULDER * ball.foot_radius and depth >= thread
        if fits and _is_free(at, 0.5 * thread + _WALL, standard, details):
            return Stud(ball.name, thread, core, depth)
    raise NotBuildable(f"no room for the thread of a stud under {ball.name}")


def _block(patch: FreeformPatch, standard: Standard, details: Details) -> Block:
    """The largest screws, as far apart as the face leaves them their thread."""
    thick = standard.base.thickness
    for (thread, core, through, head), share in product(_SIZES[2:], _SHARES):
        pad, best, most = 0.5 * thread + _PAD_RING, np.empty((0, 2)), _ENGAGED * thread
        if np.sqrt(3.0) * share * min(patch.half_size) < 2.0 * pad + 1.0:
            continue  # pads that meet are one
        for turn in range(_TURNS):
            angle = 2.0 * np.pi / 3.0 * (turn / _TURNS + np.arange(3)[:, None])
            local = share * min(patch.half_size) * np.hstack([np.cos(angle), np.sin(angle)])
            if (np.abs(local) + pad > np.array(patch.half_size) - _EDGE).any():
                continue
            places = patch.T_artefact_patch[:2, 3] + local
            if not all(_is_free(p, 0.5 * head + _WALL, standard, details) for p in places):
                continue
            over = min(_height_over(patch, p, 0.5 * thread) for p in local) - thick - _WALL
            if over >= most:
                best, most = places, over
        if len(best):
            engaged = _SCREWED * thread
            length = min(n for n in _LENGTHS if n >= _PLATE_LEFT + engaged)
            return Block(
                face=patch.name,
                places=np.round(best, 1),
                pad=pad,
                thread=thread,
                core=core,
                through=through,
                head=head + 1.0,
                sunk=thick + engaged - length,
                depth=thick + _ENGAGED * thread,
                length=length,
            )
    raise NotBuildable(f"no room for three screws under {patch.name}")


def _height_over(patch: FreeformPatch, place: Array, radius: float) -> float:
    """Lowest height of a face over a screw, mm."""
    angle = np.linspace(0.0, 2.0 * np.pi, 13)[:, None]
    ring = place + radius * np.hstack([np.cos(angle), np.sin(angle)])
    return float(patch.point(np.vstack([place, ring]))[:, 2].min())


def _is_free(place: Array, radius: float, standard: Standard, details: Details) -> bool:
    """Whether a hole through the plate keeps clear of screws, pads and bores."""
    upright = [(h.x, h.y, h.bore_radius) for h in standard.holes]
    upright += [(pad.x, pad.y, pad.radius) for pad in details.pads]
    for x, y, taken in upright:
        if np.hypot(place[0] - x, place[1] - y) < radius + taken:
            return False
    for bore in details.bores:
        begin, way = np.array(bore.mouth[:2]), np.array(bore.direction[:2])
        along = np.clip((place - begin) @ way, 0.0, bore.depth)
        if np.linalg.norm(place - begin - along * way) < radius + bore.radius:
            return False
    return True
