"""Standard, clamps and probe of probing programs as bodies of the machine, and their clearance."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.reach import Solid, table_face
from matstd.probe_paths.plan import Probe, ToolClearance
from matstd.report.machine.played import Played
from matstd.report.machine.solids import Drawn, ball, box, cylinder
from matstd.report.style import series
from matstd.twin.frames import Array, apply, inverse, pose

_BODY, _BALL, _TABLE, _CLAMP, _PROBE = "#b9bec4", "#f0e442", "#dde2e8", "#d55e00", "#5c6878"
_CELLS, _CELL = 14, 4.0  # cells a side of a face, at least, and mm of a cell of a large one
_NOSE = 150.0  # mm of the spindle's nose that are drawn


def set_up_bodies(stands: ToolClearance) -> list[Drawn]:
    """Everything that is set up, in the frame of the machine with every axis at zero."""
    T = stands.setup.T_table_artefact
    T_table_face, origin = table_face(T), stands.chain.table_origin
    out = [
        Drawn(
            s.on or "w",
            _TABLE if s is stands.workshop.table else _CLAMP,
            origin + _solid(s, T_table_face),
        )
        for s in stands.workshop.solids
    ]
    out += [
        Drawn("w", colour, origin + apply(T, corners))
        for _, colour, corners in standard_bodies(stands.standard)
    ]
    return [*out, probe_body(stands.probe)]


def probe_body(probe: Probe) -> Drawn:
    """A probe in the spindle, with the spindle's nose."""
    parts, low = [ball(probe.radius)], 0.0
    for high, radius in (*probe.stack, (probe.length + _NOSE, probe.nose_radius)):
        parts.append(cylinder(radius, radius, low, high))
        low = high
    return Drawn("t", _PROBE, np.concatenate(parts) - np.array([0.0, 0.0, probe.length]))


def with_clearance(played: Played, stands: ToolClearance) -> Played:
    """A program with the gap between the tool above its ball and the nearest body at each position.

    Where the probe changes, or the standard is clamped anew, a program has another set-up.
    """
    # before and after a touch, and at anchors, the probe stands in the same places
    places, which = np.unique(played.q, axis=0, return_inverse=True)
    clearance, nearest = stands.gap(places)
    which = which.reshape(-1)
    return replace(played, clearance=clearance[which], nearest=nearest[which])


def _solid(solid: Solid, T_table_face: Array) -> Array:
    """A box or a disc of the workshop."""
    if solid.is_disc:
        corners = cylinder(solid.half_size[0], solid.half_size[0], solid.low, solid.high)
    else:
        corners = box(solid.half_size, solid.low, solid.high)
    return apply(T_table_face @ solid.T_face_solid, corners)


def standard_bodies(standard: Standard) -> list[tuple[str, str, Array]]:
    """Features of a standard with their names and colours, artefact frame, (T, 3, 3), mm.

    First, without a name, base, core and the posts of the balls; a face comes with its pillar.
    """
    base = standard.base
    grey = [box(base.half_size, 0.0, base.thickness)]
    if standard.core is not None:
        core = standard.core
        grey.append(cylinder(core.low_radius, core.high_radius, base.thickness, core.height))
    posts = [
        cylinder(s.foot_radius, s.stem_radius, s.foot, float(s.centre[2]))
        + np.array([*s.centre[:2], 0.0])
        for s in standard.spheres
    ]
    balls = [(s.name, _BALL, ball(s.radius) + s.centre) for s in standard.spheres]
    faces = [(p.name, series(k), _pillar(p)) for k, p in enumerate(standard.patches)]
    return [("", _BODY, np.concatenate([*grey, *posts])), *balls, *faces]


def _pillar(patch: FreeformPatch) -> Array:
    """The face as a grid and the walls of its pillar."""
    counts = [max(_CELLS, round(2.0 * half / _CELL)) for half in patch.half_size]
    u, v = (np.linspace(-h, h, n + 1) for h, n in zip(patch.half_size, counts, strict=True))
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
    lid = patch.point(uv.reshape(-1, 2)).reshape(*uv.shape[:2], 3)
    a, b, c, d = lid[:-1, :-1], lid[1:, :-1], lid[1:, 1:], lid[:-1, 1:]
    parts = [np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
    down = patch.T_artefact_patch @ pose(t=np.array([0.0, 0.0, -patch.depth]))
    for edge in (lid[:, 0], lid[-1], lid[::-1, -1], lid[0, ::-1]):
        local = apply(inverse(patch.T_artefact_patch), edge)
        foot = apply(down, local * [1.0, 1.0, 0.0])
        for t in ((edge[:-1], foot[:-1], foot[1:]), (edge[:-1], foot[1:], edge[1:])):
            parts.append(np.stack(t, axis=1))
    return np.concatenate(parts)
