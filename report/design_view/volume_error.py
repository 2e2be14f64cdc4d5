"""Volumetric error of a simulated machine over its workspace, before and after identification."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.brief import Brief
from matstd.diagnosis.accuracy import prove, seen_from
from matstd.diagnosis.fit import Fit
from matstd.twin.frames import Array
from matstd.twin.machine import linear_motion
from matstd.twin.model import Effect
from matstd.twin.record import Setup, at_poses
from matstd.twin.sampling import grid_points

COUNTS = (11, 11, 9)  # places along the three linear axes
_SHARES = (0.5, 0.15, 0.85)  # of the range of every rotary axis, at which the field is worked out


@dataclass(frozen=True, eq=False)
class ErrorField:
    """Error vectors over a grid of linear readings, at some rotary readings."""

    axes: tuple[str, ...]  # names of the three linear axes
    at: tuple[Array, ...]  # readings of each, ascending, mm
    # readings of the rotary axes by name, for every field, rad
    rotary: tuple[dict[str, float], ...]
    # (F, n1, n2, n3, 3) along the motion of each axis, mm; nan outside the user's volume
    before: Array
    after: Array  # not predicted by the identified model, the same shape, mm


def error_field(
    brief: Brief, believed: Setup, truth: Sequence[tuple[Effect, Array]], fit: Fit
) -> ErrorField | None:
    """The field over the user's workspace; None on a machine without three linear axes."""
    workspace, chain = brief.workspace, brief.chain
    axes = chain.linear_axes
    if len(axes) != len(COUNTS):
        return None
    at = tuple(np.linspace(*workspace.limit(a), n) for a, n in zip(axes, COUNTS, strict=True))
    grid = grid_points(*at)
    rotary = []
    before: list[Array] = []
    after: list[Array] = []
    for share in _SHARES if chain.rotary_axes else _SHARES[:1]:
        q = np.zeros((len(grid), len(chain.axes)))
        q[:, chain.linear_columns] = grid
        stands = {}
        for name in chain.rotary_axes:
            low, high = workspace.limit(name)
            stands[name] = float(low + share * (high - low))
            q[:, chain.axis_index(name)] = stands[name]
        proof = prove(
            fit, truth, brief.setup, seen_from(at_poses(chain, q, brief.probe.length), believed)
        )
        # shown as what each linear axis would have to move, so that its own error fills one picture
        to_table = believed.T_table_artefact[:3, :3]
        outside = ~workspace.in_volume(q)
        for vectors, into in ((proof.before, before), (proof.after, after)):
            along = linear_motion(chain, q, vectors @ to_table.T)[:, chain.linear_columns]
            along[outside] = np.nan
            into.append(along.reshape(*COUNTS, 3))
        rotary.append(stands)
    return ErrorField(
        axes=axes, at=at, rotary=tuple(rotary), before=np.array(before), after=np.array(after)
    )
