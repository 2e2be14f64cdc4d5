"""The one-point test of a table: what an indicator shows without it, with it, and with its sign
wrong.
"""  # noqa: D205

from dataclasses import dataclass

import numpy as np

from matstd.compensation.field import (
    CorrectionFunction,
    Datum,
    MachineErrors,
    deviation_after,
    relative_columns,
)
from matstd.twin.frames import Array


@dataclass(frozen=True, eq=False)
class Acceptance:
    """The place where a table moves the tool point most, rotary axes as at the datum.

    An indicator is zeroed at the datum and read at this place against a gauge that is straight.
    """

    q: Array  # readings, (A,)
    without: Array  # deviation of the tool point relative to the datum without the table, (3,), mm
    with_table: Array  # the same with it
    wrong_sign: Array  # the same where the control takes its values with the opposite sign
    u: Array  # standard uncertainties from that of the model, (3,), mm


def acceptance(
    errors: MachineErrors, corrects: CorrectionFunction, datum: Datum, q: Array
) -> Acceptance:
    """The one-point test of a table.

    Args:
        datum: Pose to which everything refers.
        q: Poses of the workspace, (N, A): the place is among them but for the rotary axes.
    """
    is_rotary = np.array([errors.chain.link(a).kind == "rotary" for a in errors.chain.axes])
    q = np.where(is_rotary, datum.q, q)
    candidates = errors.touches(q, datum.length)
    best = int(np.argmax(np.abs(corrects(candidates)).sum(axis=1)))
    at, there = errors.touches(q[[best]], datum.length), errors.touches(datum.q[None], datum.length)
    shown = []
    for sign in (0.0, 1.0, -1.0):
        moved = deviation_after(errors, at, sign * corrects(at)) - deviation_after(
            errors, there, sign * corrects(there)
        )
        shown.append(moved[0])
    spread = relative_columns(errors, at, datum)[0] @ errors.root
    return Acceptance(
        q=q[best],
        without=shown[0],
        with_table=shown[1],
        wrong_sign=shown[2],
        u=np.linalg.norm(spread, axis=1),
    )
