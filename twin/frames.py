"""Types of arrays; poses as matrices (..., 4, 4): `T_a_b` takes b coordinates to a coordinates."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]


def skew(v: Array) -> Array:
    """Matrices (..., 3, 3) of the cross product with v (..., 3), ``skew(v) @ x == cross(v, x)``."""
    S = np.zeros((*np.shape(v), 3))
    S[..., 0, 1], S[..., 0, 2] = -v[..., 2], v[..., 1]
    S[..., 1, 0], S[..., 1, 2] = v[..., 2], -v[..., 0]
    S[..., 2, 0], S[..., 2, 1] = -v[..., 1], v[..., 0]
    return S


def rotation(vector: Array) -> Array:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3), axis times angle, rad.

    ``R = 1 + sin(a)/a S + (1 - cos(a))/a^2 S^2`` with ``S = skew(vector)`` and ``a = |vector|``
    (Rodrigues), exact for any angle.
    """
    S = skew(np.asarray(vector, dtype=float))
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    # np.sinc is sin(pi x)/(pi x): both factors stay accurate through angle zero.
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    return np.eye(3) + first * S + second * (S @ S)


def pose(R: Array | None = None, t: Array | None = None) -> Array:
    """Pose from rotation matrices (..., 3, 3) and translations (..., 3), mm."""
    R, t = np.eye(3) if R is None else R, np.zeros(3) if t is None else t
    T = np.zeros((*np.broadcast_shapes(R.shape[:-2], t.shape[:-1]), 4, 4))
    T[..., :3, :3], T[..., :3, 3], T[..., 3, 3] = R, t, 1.0
    return T


def turned_about(point: Array, R: Array) -> Array:
    """Pose of a rotation about a point, ``x -> point + R (x - point)``, (..., 4, 4)."""
    return pose(R, point - np.einsum("...ij,...j->...i", R, point))


def inverse(T: Array) -> Array:
    """Inverse of rigid poses (..., 4, 4) by transposition; neighbours cancel: T_b_a of T_a_b."""
    R = np.swapaxes(T[..., :3, :3], -1, -2)
    return pose(R, -np.einsum("...ij,...j->...i", R, T[..., :3, 3]))


def apply(T: Array, points: Array) -> Array:
    """Coordinates of points after a pose: T (..., 4, 4) on points (..., 3), mm."""
    return np.einsum("...ij,...j->...i", T[..., :3, :3], points) + T[..., :3, 3]


def turn(T: Array, vectors: Array) -> Array:
    """Directions after a pose: only the rotation of T (..., 4, 4) acts on vectors (..., 3)."""
    return np.einsum("...ij,...j->...i", T[..., :3, :3], vectors)


def rotation_vector(R: Array) -> Array:
    """Axis times angle of a rotation matrix (3, 3), rad; inverse of `rotation`."""
    skew = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    angle = np.arctan2(np.linalg.norm(skew), 0.5 * (np.trace(R) - 1.0))
    if angle < np.pi - 1e-3:
        return np.asarray(skew / np.sinc(angle / np.pi))
    # half a turn has no skew part: its axis is the eigenvector of the eigenvalue one
    axis = np.linalg.svd(R - np.eye(3))[2][-1]
    return np.asarray(angle * axis * (-1.0 if axis @ skew < 0.0 else 1.0))


def unit(vectors: Array) -> Array:
    """Vectors (..., 3) scaled to length one."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def outward(azimuth: Array | float, elevation: Array | float) -> Array:
    """Unit vectors by azimuth from x about z and elevation above the plane of x and y, (..., 3)."""
    level = np.cos(elevation)
    parts = level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def fixed_xyz(angles: Array) -> Array:
    """Rotations by angles (..., 3) about the fixed x, then y, then z: ``Rz Ry Rx``, (..., 3, 3)."""
    Rx, Ry, Rz = (rotation(angles[..., i : i + 1] * np.eye(3)[i]) for i in range(3))
    return Rz @ Ry @ Rx


def fixed_xyz_angles(R: Array) -> Array:
    """Angles about fixed x, y, z of rotation matrices (..., 3, 3); inverse of `fixed_xyz`, rad."""
    y = -np.arcsin(np.clip(R[..., 2, 0], -1.0, 1.0))
    x = np.arctan2(R[..., 2, 1], R[..., 2, 2])
    z = np.arctan2(R[..., 1, 0], R[..., 0, 0])
    return np.stack([x, y, z], axis=-1)
