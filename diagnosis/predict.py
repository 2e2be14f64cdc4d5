"""Predicted deviation of the tool point over the workspace, with its uncertainty."""

from dataclasses import dataclass

import numpy as np

from diagnosis.fit import Fit
from twin.frames import Array, skew
from twin.touches import Touches


@dataclass(frozen=True, slots=True, eq=False)
class TipPrediction:
    """Deviation of the tool point in the table frame at N poses.

    Attributes:
        deviation: Actual minus nominal, (N, 3), mm.
        covariance: Of each deviation, (N, 3, 3), mm^2.
    """

    deviation: Array
    covariance: Array

    @property
    def u(self) -> Array:
        """Standard uncertainty of every component, (N, 3), mm."""
        return np.sqrt(np.einsum("nii->ni", self.covariance))


def rigid_motions(points: Array) -> Array:
    """Displacements of points by the six small motions of a rigid body, (3N, 6), orthonormal."""
    arm = points - points.mean(axis=0)
    eye = np.broadcast_to(np.eye(3), (len(points), 3, 3))
    return np.linalg.qr(np.concatenate([eye, -skew(arm)], axis=2).reshape(-1, 6))[0]


def without_rigid_motion(points: Array, deviation: Array) -> Array:
    """Deviations less the motion of the table frame as a whole that fits them best.

    Where the workpiece stands on the table is found anew with every part; no standard whose set-up
    is free can show it, and nobody needs it.

    Args:
        points: Nominal tool points in the table frame, (N, 3), mm.
        deviation: Shape (N, 3), mm.
    """
    D = rigid_motions(points)
    flat = deviation.reshape(-1)
    return np.asarray((flat - D @ (D.T @ flat)).reshape(-1, 3))


def predict_tip(fit: Fit, poses: Touches, keep_datum: bool = False) -> TipPrediction:
    """Volumetric deviation at poses, first order, with the covariance of the estimates.

    Args:
        fit: Any fit.
        poses: N poses (`twin.touches.at_poses`).
        keep_datum: Keep the motion of the table frame as a whole; its uncertainty is that of the
            prior, since the set-up of the standard is free. Otherwise it is taken out of both the
            deviation and its covariance, over all poses together.
    """
    machine = len(fit.model.parameters)
    T = fit.model.tip_columns(poses).reshape(-1, machine)
    mean = T @ fit.theta[:machine]
    spread = T @ fit.spread[:machine]
    if not keep_datum:
        D = rigid_motions(poses.point)
        mean = mean - D @ (D.T @ mean)
        spread = spread - D @ (D.T @ spread)
    spread = spread.reshape(len(poses), 3, -1)
    return TipPrediction(mean.reshape(-1, 3), np.einsum("nik,njk->nij", spread, spread))
