"""Would touches that had no part in an identification show that its model is wrong, and how surely.

A model that lacks an effect of the library is fitted to the identifying touches by ``E``; part of
the effect goes into the fitted parameters, the rest makes the model wrong in the volume of the
standard and at the proving touches. The size of the effect is such that the model is wrong there by
a stated root mean square: in whatever direction, or along the normals of a measuring task, which is
what a user would feel of it. The proving touches find it if what they see beyond the prediction, d,
is larger than noise, calibration and uncertainty of the prediction allow; in units of the noise

    d^T V^-1 d > chi2(1 - risk, n)
    V = 1 + W_p E E^T W_p^T + W_p (1 - E W)(1 - E W)^T W_p^T + K K^T,   K = C_p - W_p E C

which is a noncentral chi-square variable with the noncentrality ``d^T V^-1 d`` of the expected d.
``K`` is what calibration does: a feature that identified and proves hides part of its own fault.

Reference:
    Kendall and Stuart, The Advanced Theory of Statistics II, 24.4 (power of a chi-square test).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion
from matstd.twin.frames import Array, turn
from matstd.twin.model import Effect, Model, columns
from matstd.twin.units import UM

ERROR = 2.0 * UM
"""By which a model is wrong, rms, mm."""

RISK = 0.05
"""Of calling a right model wrong."""

WANTED = 0.95
"""Power that counts as found."""

_MIXES = 8  # of the parameters of an effect that has several, averaged
_SILENT = (
    1e-9  # share of an effect that reaches the tool point, below which it is no error of a task
)


@dataclass(frozen=True, eq=False)
class Power:
    """How surely some touches find a model wrong.

    Attributes:
        touches: Their number.
        effects: Names of what the model lacks, one at a time, (E,).
        power: Probability that it is found, (E,).
    """

    touches: int
    effects: tuple[str, ...]
    power: Array

    @property
    def found(self) -> int:
        """Effects found with the power `WANTED`."""
        return int(np.sum(self.power >= WANTED))


def proof_power(
    criterion: Criterion,
    identifying: Requests,
    proving: Requests,
    effects: Sequence[Effect],
    rng: np.random.Generator,
    normals: Array | None = None,
) -> Power:
    """Power of some touches against a model that lacks one effect at a time.

    Args:
        criterion: On the standard, so that touches on one feature share its calibration.
        identifying: Touches that the model is fitted to.
        proving: Touches that had no part in it.
        effects: What the model may lack; those that move no tool point are left out.
        rng: Draws mixes of the parameters of an effect.
        normals: At every pose of the volume, (M, 3), table frame: what is wrong across them is no
            error of the task. None counts every direction.
    """
    from scipy.stats import chi2, ncx2

    sd, reach = criterion.prior_sd, criterion.reach
    poses, tip = criterion.at_volume, criterion.tip_volume * sd
    W, C = criterion.whitened(identifying), criterion.calibrated(identifying)
    estimate = _estimator(W, C)
    Wp, Cp = criterion.whitened(proving), criterion.calibrated(proving)
    shrunk = np.eye(len(sd)) - estimate @ W
    sources = (np.eye(len(Wp)), Wp @ estimate, Wp @ shrunk, Cp - Wp @ estimate @ C)
    factor = np.linalg.cholesky(sum(A @ A.T for A in sources))
    before, after = reach.touches(identifying), reach.touches(proving)
    names, noncentral = [], []
    for effect in effects:
        mixes = rng.normal(size=(len(effect.parameters), _MIXES))
        absorbed = estimate @ (columns([effect], before) @ mixes / criterion.noise)
        own = Model(reach.chain, (effect,)).tip_columns(poses) @ mixes
        wrong, moved = _rms(own - tip @ absorbed, normals), _rms(own, None)
        if np.all(moved == 0.0) or np.any(wrong < _SILENT * moved):
            continue
        seen = columns([effect], after) @ mixes / criterion.noise - Wp @ absorbed
        whitened = np.linalg.solve(factor, seen * (ERROR / wrong))
        names.append(effect.name)
        noncentral.append(np.sum(whitened**2, axis=0))
    n = len(proving)
    power = ncx2.sf(chi2.isf(RISK, n), n, np.array(noncentral).reshape(-1, _MIXES)).mean(axis=1)
    return Power(touches=n, effects=tuple(names), power=np.asarray(power))


def task_normals(criterion: Criterion, like: Requests, rng: np.random.Generator) -> Array:
    """Normals of surfaces as steep as those of some touches, in any azimuth, (M, 3), table frame.

    Args:
        criterion: With the poses of the volume, one normal each.
        like: The touches.
        rng: Draws slopes among theirs, and azimuths.
    """
    count = len(criterion.at_volume)
    slope = np.arccos(np.clip(like.normal[rng.integers(0, len(like), count), 2], -1.0, 1.0))
    azimuth = rng.uniform(-np.pi, np.pi, count)
    across = np.sin(slope)
    normal = np.stack([across * np.cos(azimuth), across * np.sin(azimuth), np.cos(slope)], axis=-1)
    return turn(criterion.reach.setup.T_table_artefact, normal)


def _rms(displaced: Array, normals: Array | None) -> Array:
    """Of displacements (M, 3, K), or of what they are along normals (M, 3); (K,)."""
    if normals is None:
        return np.asarray(np.sqrt(np.mean(np.sum(displaced**2, axis=1), axis=0)))
    return np.asarray(np.sqrt(np.mean(np.einsum("mi,mik->mk", normals, displaced) ** 2, axis=0)))


def _estimator(W: Array, C: Array) -> Array:
    """What a deviation in units of noise adds to the estimates in units of the prior, (P, N)."""
    known = np.linalg.solve(np.eye(len(W)) + C @ C.T, W)
    return np.asarray(np.linalg.solve(np.eye(W.shape[1]) + W.T @ known, known.T))
