"""The proof on the twin: what a calibrated model predicts of a machine whose truth is known."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.machine import exact_tip, inverse_linear, tip
from matstd.twin.model import Effect, Model, contribution
from matstd.twin.numbers import rms, rms_length
from matstd.twin.record import Run, Setup, Touches, at_poses


@dataclass(frozen=True, eq=False)
class Proof:
    """Volumetric error over some poses, before and after the identification.

    The volumetric error is the displacement of the ball centre relative to the standard, in the
    artefact frame: what is left once the standard has been aligned, so that no set-up is counted
    as an error of the machine.
    """

    poses: Touches  # poses of the comparison; none of them was probed
    before: Array  # true volumetric error, (N, 3), mm
    predicted: Array  # by the identified model, (N, 3), mm
    u: Array  # standard uncertainty of the prediction, root of the summed variances, (N,), mm

    @property
    def after(self) -> Array:
        """Volumetric error that is not predicted, (N, 3), mm."""
        return self.before - self.predicted

    @property
    def rms_before(self) -> float:
        """Root mean square of the true volumetric error, mm."""
        return rms_length(self.before)

    @property
    def rms_after(self) -> float:
        """Root mean square of what is not predicted, mm."""
        return rms_length(self.after)

    @property
    def rms_u(self) -> float:
        """Root mean square of the stated standard uncertainty, mm."""
        return rms(self.u)

    @property
    def factor(self) -> float:
        """How many times smaller the unpredicted volumetric error is."""
        return self.rms_before / self.rms_after

    @property
    def covered(self) -> float:
        """Share of poses whose unpredicted error is within twice its standard uncertainty.

        For an honest uncertainty between 95 % (all of it in one direction) and 99.5 % (the same in
        all three).
        """
        return float(np.mean(np.linalg.norm(self.after, axis=1) <= 2.0 * self.u))


def probed_volume(run: Run, count: int, rng: np.random.Generator) -> Touches:
    """Poses evenly over the probed volume: the box of the touches, and the rotary readings between.

    Raises:
        NotReachable: Hardly any pose of that volume is within the travels.
    """
    t = run.touches
    chain, setup = t.chain, t.setups[0]
    rotary = chain.rotary_columns
    low, high = t.ball_artefact.min(axis=0), t.ball_artefact.max(axis=0)
    limits = np.array([link.range for link in chain.links if link.kind != "fixed"])
    found: list[Array] = []
    for _ in range(50):
        q = np.zeros((count, len(chain.axes)))
        q[:, rotary] = rng.uniform(
            t.q[:, rotary].min(0), t.q[:, rotary].max(0), (count, len(rotary))
        )
        place = apply(setup.T_table_artefact, rng.uniform(low, high, (count, 3)))
        q = inverse_linear(chain, place, q, float(t.length[0]))
        found.append(q[np.all((q >= limits[:, 0]) & (q <= limits[:, 1]), axis=1)])
        if sum(map(len, found)) >= count:
            return seen_from(at_poses(chain, np.concatenate(found)[:count], t.length[0]), setup)
    raise NotReachable(
        f"hardly any pose of the probed volume is within the travels of {chain.name}"
    )


def seen_from(poses: Touches, setup: Setup) -> Touches:
    """The same poses with the standard at a set-up, their points in the artefact frame."""
    point = apply(inverse(setup.T_table_artefact), tip(poses.chain, poses.q, poses.length))
    return replace(poses, setups=(setup,), point=point)


def prove(
    fit: Fit, truth: Sequence[tuple[Effect, Array]], true_setup: Setup, poses: Touches
) -> Proof:
    """Compare what an identified model predicts with what a simulated machine really does.

    Args:
        truth: Errors of the simulated machine with their parameters.
        true_setup: Where the standard really stood.
        poses: Poses with the believed set-up, as from `probed_volume` or `seen_from`.
    """
    chain = poses.chain
    actual = exact_tip(chain, poses.q, poses.length, contribution(truth, poses))
    believed = poses.ball_artefact
    before = apply(inverse(true_setup.T_table_artefact), actual) - believed
    model = Model(chain, fit.effects)
    predicted = model.relative_deviation(poses, fit.theta)
    return Proof(poses, before, predicted, prediction_uncertainty(fit, poses))


def prediction_uncertainty(fit: Fit, poses: Touches, block: int = 2000) -> Array:
    """Standard uncertainty of predicted displacements: root of the summed variances, (N,), mm."""
    model = Model(poses.chain, fit.effects)
    root = fit.spread
    out = np.empty(len(poses))
    for start in range(0, len(poses), block):
        rows = slice(start, start + block)
        spread = model.relative_columns(poses[rows]) @ root
        out[rows] = np.sqrt(np.einsum("nip,nip->n", spread, spread))
    return out
