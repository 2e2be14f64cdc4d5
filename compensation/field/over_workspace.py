"""Poses all over the travels, and what a compensation leaves there, with its uncertainty."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from matstd.compensation.field.inverse import Datum, deviation_after
from matstd.compensation.field.machine_errors import CorrectionFunction, MachineErrors, deviation
from matstd.twin.frames import Array, skew
from matstd.twin.machine import Chain
from matstd.twin.numbers import rms, rms_length
from matstd.twin.record import Touches
from matstd.twin.sampling import even_points, spread_rows

RESULT_POSES = 256  # poses of the figures: their rms is then known to some 4 %


def sample_workspace(
    chain: Chain, limits: Mapping[str, tuple[float, float]], n: int = RESULT_POSES
) -> Array:
    """Readings spread evenly over the travels by a deterministic low-discrepancy sequence.

    Args:
        limits: Ranges that are narrower than the travels, by axis; a rotary axis that turns more
            than once is taken for one turn.

    Returns:
        Shape (n, A); spindles that no program turns stand at zero.
    """
    unit = even_points(n, len(chain.programmed_axes))
    q = np.zeros((n, len(chain.axes)))
    for k, name in enumerate(chain.programmed_axes):
        low, high = limits.get(name, chain.link(name).range)
        if chain.link(name).kind == "rotary" and high - low > 2.0 * np.pi:
            low, high = max(low, -np.pi), min(high, np.pi)
        q[:, chain.axis_index(name)] = low + unit[:, k] * (high - low)
    return q


def feels_direction(errors: MachineErrors, q: Array) -> bool:
    """Whether anything depends on the direction of the last motions at some poses, (N, A)."""
    ways = [errors.contribution(errors.touches(q, 0.0, np.full_like(q, s))) for s in (1.0, -1.0)]
    return any(not np.array_equal(*(getattr(w, part) for w in ways)) for part in ("twist", "place"))


def in_both_directions(errors: MachineErrors, q: Array, length: float) -> Touches:
    """Poses after motions of every axis in both directions, which a reversal distinguishes.

    The axes of a pose have directions of their own, evenly spread, and the opposite ones in its
    second row: so reversals of several axes neither add up nor cancel over a workspace.

    Args:
        q: Readings, (N, A).
        length: Length of the tool, mm.

    Returns:
        2N poses; N between both directions where nothing depends on them.
    """
    if not feels_direction(errors, q):
        return errors.touches(q, length)
    # the coordinates behind those of the readings (`sample_workspace`), which are spread alike
    unit = even_points(len(q), 2 * q.shape[1])[:, q.shape[1] :]
    approach = np.where(unit < 0.5, -1.0, 1.0)
    return errors.touches(np.vstack([q, q]), length, np.vstack([approach, -approach]))


@dataclass(frozen=True, slots=True)
class UncorrectedError:
    """One error that a compensation does not remove completely."""

    name: str  # symbol of ISO 230-1, or effect
    before: float  # deviation of the tool point by this error alone, rms over the workspace, mm
    rms: float  # remainder after compensation, mm
    u: float  # standard uncertainty of the remainder, mm


@dataclass(frozen=True, eq=False)
class Result:
    """What a compensation does over a workspace, the workpiece being aligned (`aligned`), mm."""

    q: Array  # poses, (N, A)
    # deviation of the tool point without it, (M, 3): M = N, or 2N in both directions of motion
    # where the errors depend on them (`in_both_directions`)
    before: Array
    after: Array  # the same with it, by the exact twin with the estimates as the truth, (M, 3)
    # standard uncertainty of both from that of the model, (M,), of the length of the error vector's
    # three components together
    u: Array
    u_tool: float  # added to the rms where tools are not set against the probe that measured, mm
    left: tuple[UncorrectedError, ...]  # errors with a remainder, the largest first

    @property
    def has_directions(self) -> bool:
        """Whether every pose is judged in both directions of motion."""
        return len(self.before) > len(self.q)

    @property
    def u_rms(self) -> float:
        """What the uncertainty of the model adds to the rms, mm."""
        return rms(self.u)

    @property
    def expected_before(self) -> float:
        """Rms to expect without it: of the model and what it does not know, mm."""
        return float(np.hypot(rms_length(self.before), self.u_rms))

    @property
    def expected(self) -> float:
        """Rms to expect with it: what is left and what the model does not know, mm."""
        return float(np.hypot(rms_length(self.after), self.u_rms))


def relative_columns(errors: MachineErrors, touches: Touches, datum: Datum) -> Array:
    """Deviation of the tool point less that at the datum per unit of every parameter, (N, 3, P)."""
    return errors.columns(touches) - errors.columns(datum.touches(errors))


def aligned(points: Array, field: Array) -> Array:
    """The field less the rigid motion that fits it best, which clamping takes up.

    Where a workpiece stands, and how it is turned, is found on the machine itself, so a model
    cannot know it and a part does not feel it.

    Args:
        points: Nominal tool points, table frame, (N, 3), mm.
        field: Deviations there, (N, 3) or (N, 3, K), mm.
    """
    arm = points - points.mean(axis=0)
    modes = np.concatenate([np.tile(np.eye(3), (len(points), 1, 1)), -skew(arm)], axis=2)
    flat = field.reshape(3 * len(points), -1)
    basis, strength, _ = np.linalg.svd(modes.reshape(3 * len(points), 6), full_matrices=False)
    basis = basis[:, strength > 1e-9 * strength[0]]  # points on a line turn about it in vain
    return (flat - basis @ (basis.T @ flat)).reshape(field.shape)


def result_of(
    errors: MachineErrors,
    corrects: CorrectionFunction,
    q: Array,
    datum: Datum,
    unheld: Array | None = None,
) -> Result:
    """Before and after over some poses, and the remainder of every error.

    Args:
        unheld: What the compensation leaves per unit of every parameter, first order, (M, 3, P), at
            the poses of `in_both_directions`; None where nothing is broken down.
    """
    touches = in_both_directions(errors, q, datum.length)
    points = touches.point
    columns = aligned(points, errors.columns(touches))
    spread, tool = columns @ errors.root, columns @ errors.tool_root
    return Result(
        q=q,
        before=aligned(points, deviation(errors, touches)),
        after=aligned(points, deviation_after(errors, touches, corrects(touches))),
        u=np.sqrt(np.einsum("nik,nik->n", spread, spread)),
        u_tool=float(np.sqrt(np.einsum("nik,nik->", tool, tool) / len(touches))),
        left=() if unheld is None else _uncorrected(errors, columns, aligned(points, unheld)),
    )


def _uncorrected(
    errors: MachineErrors, columns: Array, unheld: Array
) -> tuple[UncorrectedError, ...]:
    """Remainder of every group of errors, the largest first."""
    theta = np.concatenate(errors.theta)
    out = []
    for name in errors.groups:
        rows = errors.parameter_rows(name)
        field, spread = unheld[:, :, rows] @ theta[rows], unheld[:, :, rows] @ errors.root[rows]
        size = rms_length(field)
        u = float(np.sqrt(np.mean(np.einsum("nik,nik->n", spread, spread))))
        if size > u:  # along the field where there is one, over all of it where there is none
            slope = np.einsum("ni,nik->k", field, spread) / (size * len(field))
            u = float(np.linalg.norm(slope))
        before = rms_length(columns[:, :, rows] @ theta[rows])
        out.append(_as_determined(UncorrectedError(name, before, size, u), errors, rows))
    return tuple(sorted(out, key=lambda item: -item.rms))


def _as_determined(left: UncorrectedError, errors: MachineErrors, rows: Array) -> UncorrectedError:
    """A location error in the size that the run of the model determines, where it does.

    Its parameter alone leans on the expectation: EX0C 21 ± 30 µm where the run determines the line
    of C to 29.2 ± 0.6 µm, beside the set-up of the tool that shares it.
    """
    known = errors.determined.get(left.name)
    effect = errors.effects[errors.groups[left.name][0]]
    if known is None or effect.kind != "location" or len(rows) != 1 or not left.before:
        return left
    theta = float(np.concatenate(errors.theta)[rows[0]])
    share, per = left.rms / left.before, left.before / abs(theta)
    size = per * abs(known.value)
    return UncorrectedError(left.name, size, share * size, share * per * known.u)


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
        some = spread_rows(len(touches), MAX_U_POSES)
        spread = relative_columns(alone, touches[some], datum) @ alone.root
        u = float(np.sqrt(np.einsum("nik,nik->", spread, spread) / len(some)))
        out.append(Share(name, field, u))
    return tuple(sorted(out, key=lambda share: -rms_length(share.field)))
