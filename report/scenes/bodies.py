"""Standard, table, clamps and probe as few triangles, each with what carries it: for playback."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.reach import Solid, table_face
from matstd.probe_paths.plan import TouchPlan
from matstd.report.style import series
from matstd.twin.frames import Array, apply, inverse, pose

TOOL = "tool"
"""Carries the probe; other names are those of axes, and empty for the table."""

_BODY, _BALL, _TABLE, _CLAMP, _PROBE = "#b9bec4", "#f0e442", "#dde2e8", "#d55e00", "#5c6878"
_ROUND, _CELLS = 40, 14  # sides of a cylinder, cells a side of a face
_NOSE = 150.0  # mm of the spindle's nose that are drawn


@dataclass(frozen=True, eq=False)
class Drawn:
    """Triangles of one colour on one carrier.

    Attributes:
        on: Axis that carries them, `TOOL`, or empty for the table.
        colour: As `#rrggbb`.
        corners: In the frame of the carrier, (T, 3, 3), mm; that of the table with every axis
            between at zero, or of the tool.
    """

    on: str
    colour: str
    corners: Array


def drawn_bodies(plan: TouchPlan) -> list[Drawn]:
    """Everything that is set up for a plan."""
    T = plan.setup.T_table_artefact
    T_table_face = table_face(T)
    out = [
        Drawn(s.on, _TABLE if s is plan.options.workshop.table else _CLAMP, _solid(s, T_table_face))
        for s in plan.options.workshop.solids
    ]
    out += [Drawn("", colour, apply(T, corners)) for colour, corners in _standard(plan.standard)]
    probe, low = plan.probe, 0.0
    parts = [_triangles(_trimesh().icosphere(2, probe.radius))]
    for high, radius in (*probe.stack, (probe.length + _NOSE, probe.nose_radius)):
        parts.append(_cylinder(radius, radius, low, high))
        low = high
    down = np.array([0.0, 0.0, probe.length])
    return [*out, Drawn(TOOL, _PROBE, np.concatenate(parts) - down)]


def _trimesh() -> Any:
    import trimesh

    return trimesh.creation


def _triangles(mesh: Any) -> Array:
    return np.asarray(mesh.triangles, dtype=np.float64)


def _solid(solid: Solid, T_table_face: Array) -> Array:
    """A box or a disc of the workshop."""
    if solid.is_disc:
        corners = _cylinder(solid.half_size[0], solid.half_size[0], solid.low, solid.high)
    else:
        corners = _box(solid.half_size, solid.low, solid.high)
    return apply(T_table_face @ solid.T_face_solid, corners)


def _box(half: tuple[float, float], low: float, high: float) -> Array:
    box = _triangles(_trimesh().box((2.0 * half[0], 2.0 * half[1], high - low)))
    return box + np.array([0.0, 0.0, 0.5 * (low + high)])


def _cylinder(low_radius: float, high_radius: float, low: float, high: float) -> Array:
    """Upright, or a cone; with its ends."""
    angle = np.linspace(0.0, 2.0 * np.pi, _ROUND + 1)
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    below, above = (
        np.column_stack([r * unit, np.full(len(unit), z)])
        for r, z in ((low_radius, low), (high_radius, high))
    )
    foot, head = np.array([0.0, 0.0, low]), np.array([0.0, 0.0, high])
    a, b, c, d = below[:-1], below[1:], above[:-1], above[1:]
    ends = [np.broadcast_to(p, a.shape) for p in (foot, head)]
    sides = [(a, b, d), (a, d, c), (ends[0], b, a), (ends[1], c, d)]
    return np.concatenate([np.stack(side, axis=1) for side in sides])


def _standard(standard: Standard) -> list[tuple[str, Array]]:
    """Base, core, balls on their posts and faces on their pillars, artefact frame."""
    base = standard.base
    grey = [_box(base.half_size, 0.0, base.thickness)]
    if standard.core is not None:
        core = standard.core
        grey.append(_cylinder(core.low_radius, core.high_radius, base.thickness, core.height))
    balls = []
    for s in standard.spheres:
        at = np.array([*s.centre[:2], 0.0])
        grey.append(_cylinder(s.foot_radius, s.stem_radius, s.foot, float(s.centre[2])) + at)
        balls.append(_triangles(_trimesh().icosphere(2, s.radius)) + s.centre)
    out = [(_BODY, np.concatenate(grey))]
    out += [(_BALL, np.concatenate(balls))] if balls else []
    out += [(series(k), _pillar(patch)) for k, patch in enumerate(standard.patches)]
    return out


def _pillar(patch: FreeformPatch) -> Array:
    """The face as a grid and the walls of its pillar."""
    u, v = (np.linspace(-half, half, _CELLS + 1) for half in patch.half_size)
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
    lid = patch.point(uv.reshape(-1, 2)).reshape(*uv.shape[:2], 3)
    a, b, c, d = lid[:-1, :-1], lid[1:, :-1], lid[1:, 1:], lid[:-1, 1:]
    parts = [np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
    down = patch.T_artefact_patch @ pose(t=np.array([0.0, 0.0, -patch.depth]))
    for edge in (lid[:, 0], lid[-1], lid[::-1, -1], lid[0, ::-1]):
        local = apply(inverse(patch.T_artefact_patch), edge)
        foot = apply(down, local * [1.0, 1.0, 0.0])
        for t in (
            (edge[:-1], foot[:-1], foot[1:]),
            (edge[:-1], foot[1:], edge[1:]),
        ):
            parts.append(np.stack(t, axis=1))
    return np.concatenate(parts)
