"""Power of touches outside an identification to show that its model is wrong.

A model that lacks an effect of the library is fitted to the identifying touches by ``E``; part of
the effect goes into the fitted parameters, the rest makes the model wrong in the volume of the
standard and at the proving touches. The effect is scaled so that the model is wrong there by a
stated root mean square, in any direction or along the normals of a measuring task. The proving
touches detect it if their residual d exceeds what noise, calibration and uncertainty of the
prediction explain; in units of the noise

    d^T V^-1 d > chi2(1 - risk, n)
    V = 1 + W_p E E^T W_p^T + W_p (1 - E W)(1 - E W)^T W_p^T + K K^T,   K = C_p - W_p E C

which is a noncentral chi-square variable with the noncentrality ``d^T V^-1 d`` of the expected d.
``K`` is the effect of calibration: a feature that identifies and proves hides part of its error.

Reference:
    Kendall and Stuart, The Advanced Theory of Statistics II, 24.4 (power of a chi-square test).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, chndtr

from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion
from matstd.twin.frames import Array, turn
from matstd.twin.model import Effect, Model, columns
from matstd.twin.units import UM

MODEL_ERROR = 2.0 * UM  # error of a wrong model, rms, mm
FALSE_ALARM = 0.05  # probability of rejecting a correct model
DETECTION_POWER = 0.95  # power from which an effect counts as detected
_MIXES = 8  # random mixes of the parameters of an effect, averaged
_MIN_TIP_SHARE = 1e-9  # share of an effect at the tool point below which a task does not see it


@dataclass(frozen=True, eq=False)
class Power:
    """Power of some touches to detect a wrong model."""

    touches: int
    effects: tuple[str, ...]  # names of the effects that the model lacks, one at a time, (E,)
    power: Array  # probability of detection, (E,)

    @property
    def found(self) -> int:
        """Number of effects detected with at least `DETECTION_POWER`."""
        return int(np.sum(self.power >= DETECTION_POWER))


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
        effects: Effects that the model may lack; those that do not move the tool point are skipped.
        normals: At every pose of the volume, (M, 3), table frame: only errors along them count.
            None counts every direction.
    """
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
        if np.all(moved == 0.0) or np.any(wrong < _MIN_TIP_SHARE * moved):
            continue
        seen = columns([effect], after) @ mixes / criterion.noise - Wp @ absorbed
        whitened = np.linalg.solve(factor, seen * (MODEL_ERROR / wrong))
        names.append(effect.name)
        noncentral.append(np.sum(whitened**2, axis=0))
    n = len(proving)
    missed = chndtr(chdtri(n, FALSE_ALARM), n, np.array(noncentral).reshape(-1, _MIXES))
    return Power(touches=n, effects=tuple(names), power=1.0 - missed.mean(axis=1))


def task_normals(criterion: Criterion, like: Requests, rng: np.random.Generator) -> Array:
    """Normals with the slopes of some touches and random azimuths, (M, 3), table frame."""
    count = len(criterion.at_volume)
    slope = np.arccos(np.clip(like.normal[rng.integers(0, len(like), count), 2], -1.0, 1.0))
    azimuth = rng.uniform(-np.pi, np.pi, count)
    across = np.sin(slope)
    normal = np.stack([across * np.cos(azimuth), across * np.sin(azimuth), np.cos(slope)], axis=-1)
    return turn(criterion.reach.setup.T_table_artefact, normal)


def _rms(displaced: Array, normals: Array | None) -> Array:
    """Root mean square of displacements (M, 3, K), or of their parts along normals; (K,)."""
    if normals is None:
        return np.asarray(np.sqrt(np.mean(np.sum(displaced**2, axis=1), axis=0)))
    return np.asarray(np.sqrt(np.mean(np.einsum("mi,mik->mk", normals, displaced) ** 2, axis=0)))


def _estimator(W: Array, C: Array) -> Array:
    """Change of the estimates, in units of the prior, per deviation in units of noise, (P, N)."""
    known = np.linalg.solve(np.eye(len(W)) + C @ C.T, W)
    return np.asarray(np.linalg.solve(np.eye(W.shape[1]) + W.T @ known, known.T))
