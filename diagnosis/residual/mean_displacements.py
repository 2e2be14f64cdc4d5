"""Mean displacement of the tool at every table pose, as its residuals ask for."""

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.twin.frames import Array, IntArray

MIN_SINGULAR_VALUE = 0.05
"""Smallest singular value of the normals, over the root of their number, of touches from all
sides."""


def pose_vectors(fit: Fit) -> tuple[IntArray, Array, Array]:
    """Mean displacement of the tool that the residuals of every table pose ask for.

    Least squares of ``r = a . d`` over the touches of a pose, with a the deviation along the normal
    per unit of tool displacement in machine directions; a prior as wide as the residual keeps
    near zero what the touches of a pose do not show.

    Returns:
        Rows of every pose by its first touch (M,), vectors (M, 3) and their standard uncertainties
        (M, 3), mm, in the order of probing.
    """
    t = fit.run.touches
    first = next(i for i, link in enumerate(t.chain.links) if not link.carries_workpiece)
    a = t.signature.twist[:, first, :3]
    key = np.unique(np.column_stack([t.setup, t.pose]), axis=0, return_inverse=True)[1].reshape(-1)
    rms = max(fit.rms, 1e-12)
    starts, vectors, spreads = [], [], []
    for k in np.unique(key[fit.used]):
        rows = np.flatnonzero((key == k) & fit.used)
        w = 1.0 / fit.u[rows]
        information = (a[rows] * w[:, None]).T @ (a[rows] * w[:, None]) + np.eye(3) / (
            10 * rms
        ) ** 2
        vectors.append(np.linalg.solve(information, a[rows].T @ (w**2 * fit.residual[rows])))
        spreads.append(np.sqrt(np.diag(np.linalg.inv(information))))
        starts.append(rows[np.argmin(t.time[rows])])
    order = np.argsort(t.time[starts], kind="stable")
    return np.array(starts)[order], np.array(vectors)[order], np.array(spreads)[order]


def has_poses(fit: Fit) -> bool:
    """Whether there are several table poses, each touched from all sides."""
    t = fit.run.touches
    n = t.normal_table[fit.used]
    turned = np.unique(np.column_stack([t.setup, t.pose])[fit.used], axis=0)
    return len(turned) > 2 and bool(
        np.linalg.svd(n, compute_uv=False)[-1] > MIN_SINGULAR_VALUE * len(n) ** 0.5
    )
