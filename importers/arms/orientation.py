"""Targets whose orientation is measured too: six independent readings of every pose.

With position x (uncertainty u of a coordinate) and rotation R (uncertainty w about each of its
directions e1, e2, e3) the points ``x ± L R e_i`` with ``L = u / w`` move along ``R e_j`` by ``d ± L
a``: variance ``u² + L² w² = 2 u²``, covariance ``u² - L² w² = 0``. The three cyclic pairs (i, j)
contain all information of the pose, in rows of a run as of six reflectors.

Reference:
    Shah, J. Mechanisms Robotics 5 (2013) 031007: ``R_i X = Y B_i`` in closed form from the singular
    vectors of ``sum B_i ⊗ R_i``.
"""

import re

import numpy as np

from matstd.importers.sheets import ANGLES, Sheet
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, rotation, skew
from matstd.twin.numbers import rms
from matstd.twin.record import turn_of

MAX_NORM_ERROR = 0.01
"""Error of the length of a quaternion beyond which its columns hold something else."""
IMPLAUSIBLE_ANGLE = 0.1
"""Angle (rad rms) between measured and nominal orientations that is not that of an arm: zeros of
joints that were never calibrated are off by 10 mrad."""
MAX_SECOND_SHARE = 0.99
"""Second singular value over the first from which poses do not determine the orientations."""
EXPLAINED_SHARE = 0.2  # inverse orientations explain the angles if at most this share remains
PAIRS = ((0, 1), (1, 2), (2, 0))
"""Direction of the arm and direction of the reading of each pair of points."""
_QUATERNION = re.compile(r"(?:\Aq|quat\w*?)[\s_.]*([wxyz])\Z", re.IGNORECASE)
_ROTATION = re.compile(r"(?:\Ar|\brotvec|\brv)[\s_.]*([xyz])\Z", re.IGNORECASE)


def oriented(sheet: Sheet) -> tuple[int, ...]:
    """Columns `qw qx qy qz` or `rx ry rz` of a table, none where it has neither."""
    for pattern, letters in ((_QUATERNION, "wxyz"), (_ROTATION, "xyz")):
        found = {
            m[1].lower(): i for i, name in enumerate(sheet.names) if (m := pattern.search(name))
        }
        if set(found) == set(letters):
            return tuple(found[c] for c in letters)
    return ()


def rotations(sheet: Sheet, columns: tuple[int, ...]) -> Array:
    """Rotation of the target's frame in that of the tracker, (N, 3, 3); NaN where it is missing.

    Args:
        columns: Of a quaternion w, x, y, z, or of a rotation vector x, y, z.

    Raises:
        BadFile: A quaternion that is not of unit length, a rotation vector without a unit.
    """
    if len(columns) == 3:
        return rotation(np.stack([sheet.quantity(i, ANGLES) for i in columns], axis=1))
    q = np.stack([sheet.numbers(i) for i in columns], axis=1)
    length = np.linalg.norm(q, axis=1)
    odd = np.flatnonzero(np.abs(length - 1.0) > MAX_NORM_ERROR)
    if len(odd):
        found = f"a quaternion of length {length[odd[0]]:.4g}"
        raise sheet.bad(int(odd[0]), columns[0], found, "1")
    return from_quaternions(q / length[:, None])


def from_quaternions(q: Array) -> Array:
    """Rotations of unit quaternions w, x, y, z, (N, 4) to (N, 3, 3)."""
    K = skew(q[:, 1:])
    return np.asarray(np.eye(3) + 2.0 * (q[:, 0, None, None] * K + K @ K))


def disagreement(tool: Array, measured: Array) -> float:
    """Angle between measured orientations and those of the arm, rad rms; NaN where undetermined.

    With M_i measured in the frame of the tracker and B_i of the tool in the table frame, (N, 3, 3)
    each, ``M_i = Y B_i X`` for the orientations Y of the tracker and X of the target that maximise
    ``sum trace(M_i' Y B_i X)``: a pair of singular vectors.
    """
    K = np.einsum("nkl,npq->kpql", measured, tool).reshape(9, 9)
    U, s, _ = np.linalg.svd(K)
    if s[1] > MAX_SECOND_SHARE * s[0]:
        return float("nan")
    sign = np.sign(np.linalg.det(U[:, 0].reshape(3, 3)))
    Y = nearest_rotation(sign * U[:, 0].reshape(3, 3))
    X = target_rotation(tool, measured, Y)
    off = np.einsum("nji,jk,nkl,lm->nim", measured, Y, tool, X)
    return rms(turn_of(off))


def check_orientations(sheet: Sheet, tool: Array, measured: Array) -> None:
    """Refuse orientations that are not those of the arm; names the inverse where that is it."""
    rest = disagreement(tool, measured)
    if not rest > IMPLAUSIBLE_ANGLE:  # not where the poses do not determine it
        return
    other = disagreement(tool, measured.swapaxes(1, 2))
    expected = "those of the target in the frame of the tracker"
    if other < EXPLAINED_SHARE * rest:
        expected += f" ({other:.3g} rad are left if they are inverted: negate x, y and z)"
    raise DesignError(
        f"{sheet.path}: measured orientations and those of the arm differ by {rest:.3g} rad rms; "
        f"expected {expected}"
    )


def target_rotation(tool: Array, measured: Array, tracker: Array) -> Array:
    """Rotation of the target in the tool frame, (3, 3), in closed form, for that of the tracker."""
    return nearest_rotation(np.einsum("nji,kj,nkl->il", tool, tracker, measured))


def nearest_rotation(M: Array) -> Array:
    """Rotation nearest to a matrix (3, 3), by its singular vectors."""
    U, _, Vt = np.linalg.svd(M)
    return np.asarray(U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt)


def arms(lever: float) -> tuple[Array, Array]:
    """Places of the six readings in the frame of the target, and their directions, (6, 3) each."""
    place = [side * lever * np.eye(3)[i] for i, _ in PAIRS for side in (1.0, -1.0)]
    along = [np.eye(3)[j] for _, j in PAIRS for _ in range(2)]
    return np.array(place), np.array(along)
