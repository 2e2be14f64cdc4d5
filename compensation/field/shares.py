"""What every error adds to the deviation of the tool point, one switched on at a time."""

from typing import NamedTuple

import numpy as np

from matstd.compensation.field.inverse import Datum
from matstd.compensation.field.machine_errors import MachineErrors, deviation
from matstd.twin.frames import Array
from matstd.twin.numbers import rms_length
from matstd.twin.record import Touches
from matstd.twin.sampling import spread_rows

MAX_U_POSES = 100  # poses at which the uncertainty of a share is taken: it varies slowly over them


class Share(NamedTuple):
    """What one error adds, all others off."""

    name: str  # symbol of ISO 230-1, or effect
    field: Array  # deviation of the tool point relative to the datum, table frame, (N, 3), mm
    u: float  # standard uncertainty of its rms size from that of the model, mm


def contributions(errors: MachineErrors, touches: Touches, datum: Datum) -> tuple[Share, ...]:
    """What every error adds along some poses, the largest first.

    Each is exact; their sum is the deviation of all together to first order.
    """
    out = []
    for name in errors.groups:
        alone = errors.only(name)
        field = deviation(alone, touches) - datum.deviation(alone)
        there = alone.touches(datum.q[None, :], datum.length)
        some = spread_rows(len(touches), MAX_U_POSES)
        spread = (alone.columns(touches[some]) - alone.columns(there)) @ alone.root
        u = float(np.sqrt(np.einsum("nik,nik->", spread, spread) / len(some)))
        out.append(Share(name, field, u))
    return tuple(sorted(out, key=lambda share: -rms_length(share.field)))
