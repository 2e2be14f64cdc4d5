"""The proof on the twin: predicted against true volumetric error without a touch."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.accuracy import probed_volume, prove
from matstd.diagnosis.fit import fit_run
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.frames import apply, fixed_xyz, inverse, pose
from matstd.twin.library import ordinary_model
from matstd.twin.machine import exact_tip
from matstd.twin.model import contribution
from matstd.twin.record import Setup
from matstd.twin.units import NM, UM

MACHINES = 6


def probed(plan, errors, moved, rng):
    """A run of a machine with these errors by its exact chain, the standard standing off."""
    t = plan.touches
    (stated,) = t.setups
    true = Setup(stated.name, stated.T_table_artefact @ moved)
    actual = exact_tip(t.chain, t.q, t.length, contribution(errors, t))
    off = apply(inverse(true.T_table_artefact), actual) - t.ball_artefact
    deviation = -np.einsum("ni,ni->n", t.normal, off) + rng.normal(0.0, plan.u)
    return replace(plan, deviation=deviation), true


@pytest.fixture(scope="module")
def plan(case):
    """The touches of the first set-up of a simulated run."""
    run, _ = case(1, "hsm600u")
    first = run[run.touches.setup == 0]
    return replace(first, touches=replace(first.touches, setups=first.touches.setups[:1]))


@pytest.fixture(scope="module")
def proofs(plan):
    chain = plan.touches.chain
    rng = np.random.default_rng(4)
    out = []
    for _ in range(MACHINES):
        errors = drawn_errors(Population(chain), rng)
        moved = pose(fixed_xyz(rng.normal(0.0, 50e-6, 3)), rng.normal(0.0, 0.03, 3))
        run, true = probed(plan, errors, moved, rng)
        fit = fit_run(run, ordinary_model(chain))
        poses = probed_volume(run, 400, np.random.default_rng(1))
        out.append((prove(fit, errors, true, poses), fit, errors, true))
    return out


def test_poses_are_new_ones_within_the_travels(plan) -> None:
    poses = probed_volume(plan, 200, np.random.default_rng(3))
    assert len(poses) == 200
    limits = np.array([plan.touches.chain.link(a).range for a in plan.touches.chain.axes])
    assert np.all((poses.q >= limits[:, 0]) & (poses.q <= limits[:, 1]))
    low, high = plan.touches.ball_artefact.min(0), plan.touches.ball_artefact.max(0)
    seen = poses.ball_artefact
    assert np.all((seen > low - NM) & (seen < high + NM))
    gap = np.linalg.norm(seen[:, None] - plan.touches.ball_artefact[None], axis=-1)
    assert np.median(gap.min(axis=1)) > 1.0  # mm: not the touches over again


def test_the_error_falls_to_what_is_stated(proofs) -> None:
    """Errors of tens of micrometres; one face of noise 0.6 um leaves a micrometre or a few."""
    for proof, *_ in proofs:
        assert proof.rms_before > 10.0 * UM
        assert proof.rms_after < 0.3 * proof.rms_before
        assert proof.factor == pytest.approx(proof.rms_before / proof.rms_after)
        np.testing.assert_allclose(proof.after, proof.before - proof.predicted, atol=0.001 * NM)


def test_uncertainty_is_honest_over_machines(proofs) -> None:
    """Mean square of error over uncertainty is 1, and twice the uncertainty covers nearly all.

    A machine has few effective directions, so that six machines give the square within some two.
    """
    ratio = [np.mean(np.sum(p.after**2, axis=1) / p.u**2) for p, *_ in proofs]
    assert 0.5 < np.mean(ratio) < 2.0
    assert np.mean([p.covered for p, *_ in proofs]) > 0.85


def test_a_set_up_is_no_error_of_the_machine(plan) -> None:
    """A perfect machine with the standard 30 um off, probed without noise, has no error after.

    Before, the volumetric error is exactly the misplacement; after it nothing but what the prior
    (a micrometre-wide machine beside a millimetre-wide set-up) takes wrongly.
    """
    chain = plan.touches.chain
    moved = pose(np.eye(3), np.array([0.03, 0.0, 0.0]))
    run, true = probed(plan, [], moved, np.random.default_rng(2))
    fit = fit_run(run, ordinary_model(chain))
    poses = probed_volume(run, 300, np.random.default_rng(3))
    proof = prove(fit, [], true, poses)
    np.testing.assert_allclose(
        proof.before, np.broadcast_to([-0.03, 0.0, 0.0], (300, 3)), atol=0.01 * NM
    )
    assert proof.rms_after < 3.0 * proof.rms_u
    assert proof.rms_after < 0.1 * proof.rms_before
