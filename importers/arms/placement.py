"""Positions of a tracker, and of reflectors on an arm, from measured places."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from matstd.importers.arms.table import ArmTable
from matstd.twin.errors import DesignError, NotEnoughData
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.numbers import rms, rms_length
from matstd.twin.record import rigid_motion

MIN_POSES = 6
"""Poses for the nine unknown numbers of tracker and reflector, three equations each, with a
margin."""
UNDETERMINED_SD = 10.0
"""From this standard uncertainty (mm) a direction is undetermined. Thirty poses of an arm that is 1
mm wrong give 0.4 mm; a path with one orientation gives metres."""
MAX_SCATTER = 5.0
"""Largest scatter (mm) in this decision; larger scatter is not that of the stated arm."""
UNEXPLAINED_SHARE = 0.5
"""From this share of the spread of the measured places, residuals are no errors of an arm."""
MIN_COMPONENT = 0.05  # from this component of a unit vector a parameter belongs to a direction


@dataclass(frozen=True, eq=False)
class Placement:
    """Positions of tracker and reflectors, and whether the poses determine them."""

    T_table_tracker: Array  # pose of the tracker's frame in the table frame, (4, 4)
    reflector: Array  # places in the tool frame, (K, 3), mm
    rms: float  # of the residuals of the coordinates, mm
    spread: float  # of the measured coordinates about their mean, rms, mm
    is_settled: bool  # whether the search for the reflectors has converged
    # directions that the poses do not determine, in words; empty where they do
    free: tuple[str, ...]

    @property
    def is_unexplained(self) -> bool:
        """Whether the places cannot be those of this arm."""
        return self.rms > max(UNEXPLAINED_SHARE * self.spread, MAX_SCATTER)


def located(table: ArmTable, chain: Chain, u: float, reflector: Array | None) -> Placement:
    """Tracker and reflectors from the places where reflectors were measured.

    ``R (p + R_i v) + t = x`` with (R, t) what takes the table to the tracker and v a reflector.
    For given reflectors the tracker follows in closed form, so only they are searched for, by
    damped least squares from the flange (variable projection, Golub and Pereyra 1973).

    Args:
        u: Standard uncertainty of one coordinate, mm.
        reflector: Its place in the tool frame, (3,), mm, if that is known.

    Raises:
        DesignError: Readings of other joints than the arm has; several reflectors, and one place.
        NotEnoughData: Too few poses.
    """
    path, axes = table.sheet.path, chain.programmed_axes
    if len(table.joints) != len(axes) or chain.axes != axes:
        raise DesignError(
            f"{path}: {len(table.joints)} columns of joints, expected {len(axes)}: "
            f"{', '.join(axes)}"
        )
    if reflector is not None and len(table.names) > 1:
        raise DesignError(f"{path}: {len(table.names)} reflectors, expected one where it is stated")
    poses = int(table.shots.any(axis=1).sum())
    if poses < MIN_POSES:
        raise NotEnoughData(f"{path}: {poses} poses, expected {MIN_POSES} at least")
    problem = _Problem(table, chain, reflector is not None)
    if reflector is None:
        from scipy.optimize import least_squares  # a third of a second, for arms alone

        start = np.zeros(3 * problem.count)
        found = least_squares(problem.residuals, start, problem.slopes, xtol=1e-14, ftol=1e-14)
        v, is_settled = found.x.reshape(-1, 3), bool(found.status > 0)
    else:
        v, is_settled = reflector[None], True
    left = rms(problem.residuals(v))
    return Placement(
        T_table_tracker=inverse(problem.tracker(v)),
        reflector=v,
        rms=left,
        spread=rms(problem.measured - problem.measured.mean(axis=0)),
        is_settled=is_settled,
        free=tuple(problem.free(v, float(np.clip(left, u, max(u, MAX_SCATTER))))),
    )


class _Problem:
    """Residuals and Jacobian of the places of K reflectors at N poses."""

    def __init__(self, table: ArmTable, chain: Chain, is_known: bool) -> None:
        self.count, self.is_known = len(table.names), is_known
        row, self.of = np.nonzero(table.shots)
        self.T = table_to_tool(chain, table.q[row])  # (M, 4, 4), a pose for every place
        self.measured = table.place[table.shots]  # (M, 3)

    def nominal_places(self, v: Array) -> Array:
        """Places of the reflectors by the nominal arm, (M, 3), table frame."""
        return apply(self.T, v[self.of])

    def tracker(self, v: Array) -> Array:
        """What takes the table to the tracker, (4, 4)."""
        return rigid_motion(self.nominal_places(v), self.measured, flat=0.0)

    def residuals(self, v: Array) -> Array:
        """Residuals of the coordinates, (3 M,), for reflectors at v, (3 K,)."""
        at = v.reshape(-1, 3)
        return np.asarray(
            (apply(self.tracker(at), self.nominal_places(at)) - self.measured).ravel()
        )

    def columns(self, v: Array) -> Array:
        """Motion per unit of every parameter, (3 M, 6 + 3 K).

        Turns of the table about its directions, by what moves a place of the usual distance by one
        mm; shifts along them; the reflectors along the directions of the tool frame, mm.
        """
        R, at = self.tracker(v)[:3, :3], self.nominal_places(v)
        arm = at - at.mean(axis=0)
        reach = max(rms_length(arm), 1e-9)
        J = np.zeros((len(at), 3, 6 + 3 * self.count))
        J[:, :, :3] = np.cross(np.eye(3), arm[:, None]).swapaxes(1, 2) / reach
        J[:, :, 3:6] = np.eye(3)
        rows = np.arange(len(at))
        for i in range(3):
            J[rows, :, 6 + 3 * self.of + i] = self.T[:, :3, i]
        return np.einsum("ij,mjp->mip", R, J).reshape(-1, J.shape[2])

    def slopes(self, v: Array) -> Array:
        """Jacobian of `residuals`, (3 M, 3 K): what the tracker cannot absorb."""
        J = self.columns(v.reshape(-1, 3))
        Q = np.linalg.qr(J[:, :6])[0]
        return np.asarray(J[:, 6:] - Q @ (Q.T @ J[:, 6:]))

    def free(self, v: Array, scatter: float) -> Iterator[str]:
        """Undetermined directions at this scatter of the coordinates, in words."""
        J = self.columns(v)[:, : 6 if self.is_known else None]
        _, s, Vt = np.linalg.svd(J, full_matrices=False)
        undetermined = Vt[s * UNDETERMINED_SD < scatter].T  # (P, d)
        if not undetermined.shape[1]:
            return
        for k in range((len(undetermined) - 6) // 3):
            number = f" {k + 1}" if self.count > 1 else ""
            for words in _directions(undetermined[6 + 3 * k : 9 + 3 * k], "along", "xyz"):
                yield f"the reflector{number} {words} of the tool frame"
        for words in _directions(undetermined[:3], "about", "XYZ"):
            yield f"a turn of the tracker {words} of the table frame"


def _directions(block: Array, preposition: str, letters: str) -> Iterator[str]:
    """What the columns of a block (3, d) span: nothing, a line, a plane or everything."""
    U, s, _ = np.linalg.svd(block)
    rank = int((s > MIN_COMPONENT).sum())
    if rank == 3:
        yield f"{preposition} every direction"
    elif rank:
        square = "every direction square to " if rank == 2 else ""
        yield f"{preposition} {square}{_direction(U[:, 2 if rank == 2 else 0], letters)}"


def _direction(n: Array, letters: str) -> str:
    """`z`, or `(0.60, 0.80, 0.00)` with its largest number positive."""
    largest = int(np.argmax(np.abs(n)))
    if abs(n[largest]) > 1.0 - 1e-4:
        return letters[largest]
    n = np.round(n * np.sign(n[largest]), 2) + 0.0
    return f"({', '.join(f'{v:.2f}' for v in n)})"
