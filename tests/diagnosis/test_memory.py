"""Noise that remembers, against dense covariances and refits done the long way."""

from dataclasses import replace

import numpy as np
import pytest
from marks import slow
from mpmath import mp
from scipy.linalg import block_diag
from unchanged import answer_text

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.files import model_text
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import PRIOR_DOF, Memory, likely_memory, whitener
from matstd.diagnosis.regression.memory import MEMORY_PASSES, _marginal
from matstd.diagnosis.remarks import remarks
from matstd.report.words import remark_sentence, verdict_sentence
from matstd.twin.effects import setup_errors
from matstd.twin.library import ordinary_model, proposals
from matstd.twin.model import columns
from matstd.twin.units import UM

SEED = (2, "hmc1995")
STATED = 0.6 * UM
ROUNDING = 1e-9


def remembering(count: int, correlation: float, seed: int) -> np.ndarray:
    """Unit noise by the root of its covariance, which shares nothing with the filter."""
    lag = np.abs(np.arange(count)[:, None] - np.arange(count))
    root = np.linalg.cholesky(correlation**lag)
    return root @ np.random.default_rng(seed).standard_normal(count)


@pytest.fixture(scope="module")
def clean(case):
    """A simulated run whose own noise has been taken off as far as the model goes."""
    run = case(*SEED).run
    fit = fit_run(run, ordinary_model(run.touches.chain))
    return replace(run, deviation=run.deviation - fit.residual)


@pytest.fixture(scope="module")
def noisy(clean):
    """The same with noise of the stated size that keeps 0.8 of itself from touch to touch."""
    noise = STATED * remembering(len(clean), 0.8, 5)
    return replace(clean, deviation=clean.deviation + noise)


@pytest.mark.parametrize(
    "memory", [Memory(0.7), Memory(0.7, 20.0), Memory(0.6, 0.0, True), Memory(0.6, 20.0, True)]
)
def test_the_filter_makes_its_own_covariance_the_unit_matrix(clean, memory) -> None:
    rows = 60
    run = clean[np.arange(2 * rows)]
    used = np.arange(2 * rows) % 7 != 3  # rows left out of the fit widen the gaps in time
    filter_ = whitener(memory, run.touches, run.u, used)
    n = int(used.sum())
    W = filter_.filtered(np.eye(n))
    time = run.touches.time[used]
    place = np.column_stack([run.touches.point, run.touches.normal, run.touches.setup])[used]
    order = np.argsort(time, kind="stable")
    blocks, rank = [], []
    labels = (
        np.unique(place, axis=0, return_inverse=True)[1].reshape(-1)
        if memory.by_place
        else np.zeros(n, dtype=int)
    )
    for label in np.unique(labels):
        mine = [i for i in order if labels[i] == label]
        at = time[mine] / memory.step if memory.step else np.arange(len(mine))
        blocks.append(memory.correlation ** np.abs(np.subtract.outer(at, at)))
        rank += mine
    S = np.empty((n, n))
    S[np.ix_(rank, rank)] = block_diag(*blocks)
    np.testing.assert_allclose(W @ S @ W.T, np.eye(n), atol=1e-8)
    assert filter_.log_det == pytest.approx(-0.5 * np.linalg.slogdet(S)[1], abs=1e-8)
    z = np.random.default_rng(0).standard_normal(n)
    np.testing.assert_allclose(filter_.coloured(filter_.filtered(z)), z, atol=1e-9)


@pytest.mark.parametrize("correlation", [0.5, 0.8, 0.95])
def test_memory_is_found_beside_a_hundred_parameters(clean, correlation) -> None:
    """The fit takes most of a slow noise with it; the likelihood knows that."""
    noise = STATED * remembering(len(clean), correlation, 7)
    run = replace(clean, deviation=clean.deviation + noise)
    fit = fit_run(run, ordinary_model(run.touches.chain))
    memory, gain = likely_memory(run.touches, fit.u, fit.used, fit.X, fit.y)
    assert gain > POLICY.memory_gain
    length = memory.time / np.median(np.diff(run.touches.time)) if memory.time else memory.length
    free = len(run) - fit.solution.effective_parameters
    u = np.sqrt((1.0 - correlation**2) / free)  # of a correlation from so many independent steps
    assert np.exp(-1.0 / length) == pytest.approx(correlation, abs=3.0 * u)


def test_white_noise_has_none(case) -> None:
    run = case(*SEED).run
    fit = fit_run(run, ordinary_model(run.touches.chain))
    assert likely_memory(run.touches, fit.u, fit.used, fit.X, fit.y)[1] < POLICY.memory_gain


def test_estimates_are_those_of_generalised_least_squares(noisy) -> None:
    """Aitken's estimator with the dense covariance and the prior as further observations."""
    model = ordinary_model(noisy.touches.chain)
    fit = fit_run(noisy, model, memory=Memory(0.8))
    used = fit.used
    n = int(used.sum())
    A = columns(fit.effects, noisy.touches)[used]
    lag = np.abs(np.arange(n)[:, None] - np.arange(n))
    S = np.outer(fit.u[used], fit.u[used]) * 0.8**lag
    root = fit.prior.root
    prior = np.linalg.inv(root @ root.T)
    information = A.T @ np.linalg.solve(S, A) + prior
    theta = np.linalg.solve(information, A.T @ np.linalg.solve(S, noisy.deviation[used]))
    sd = np.sqrt(np.diag(np.linalg.inv(information)))
    assert np.max(np.abs(theta - fit.theta) / sd) < 1e-6
    np.testing.assert_allclose(np.sqrt(np.diag(fit.covariance)), sd, rtol=1e-6)
    plain = noisy.deviation - columns(fit.effects, noisy.touches) @ fit.theta
    np.testing.assert_allclose(fit.residual, plain, atol=ROUNDING)


@pytest.mark.parametrize("memory", [None, Memory(0.8, 0.0, False, is_filtered=False)])
def test_plain_held_out_errors_are_those_of_refits(noisy, memory) -> None:
    """Three poses left out by hand: the fit without them, on their rows, nothing weighted."""
    model = ordinary_model(noisy.touches.chain)
    fit = fit_run(noisy, model, memory=memory)
    rows = np.flatnonzero(fit.used)
    for group in fit.groups[:3]:
        keep = np.setdiff1d(np.arange(len(rows)), group)
        A = columns(fit.effects, noisy.touches)[rows] @ fit.prior.root
        unit = fit.u[rows][:, None] * fit.weight
        X, y = A / unit, noisy.deviation[rows] / unit[:, 0]
        phi = np.linalg.solve(X[keep].T @ X[keep] + np.eye(X.shape[1]), X[keep].T @ y[keep])
        error = noisy.deviation[rows][group] - A[group] @ phi
        np.testing.assert_allclose(fit.held_out_errors[group], error, atol=1e-7)


def second_runs(clean, memory, draws):
    """Plain errors of another run of the same touches, and what was stated, draw by draw.

    Two runs of one random machine: on the second its estimates are held, and the set-ups, which
    stand elsewhere, are placed by least squares.
    """
    model = ordinary_model(clean.touches.chain)
    setups = setup_errors(clean.touches)
    M = columns(model.effects, clean.touches)
    S = columns(setups, clean.touches)  # mm and rad times some 100 mm: no column is small
    sd = np.array([p.sd for e in (*model.effects, *setups) for p in e.parameters])
    n, m = M.shape
    for draw in range(draws):
        rng = np.random.default_rng([9, draw])
        theta = sd * rng.standard_normal(len(sd))

        def noise(draw=draw, rng=rng):
            if memory is None:
                return STATED * rng.standard_normal(n)
            return STATED * remembering(n, memory.correlation, int(rng.integers(2**31)))

        first = replace(clean, deviation=M @ theta[:m] + S @ theta[m:] + noise())
        moved = sd[m:] * rng.standard_normal(len(sd) - m)
        left = M @ theta[:m] + S @ moved + noise()
        fit = fit_run(first, model, memory=memory)
        left -= M @ fit.theta[:m]
        left -= S @ np.linalg.lstsq(S, left, rcond=None)[0]
        yield np.sqrt(np.mean(left**2)), fit.test_rms


@pytest.mark.parametrize("memory", slow(Memory(0.7), None), ids=["remembers", "white"])
def test_the_stated_error_is_that_of_another_run(clean, memory) -> None:
    """Runs of 780 touches: their plain errors scatter by 2.5 % (3 times as much with memory)."""
    plain, stated = np.array(list(second_runs(clean, memory, 12))).T
    ratio = plain / stated
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.03)
    assert np.mean(np.abs(ratio - 1.0) < (0.1 if memory is None else 0.2)) >= 0.9


def test_rows_that_count_for_less_widen_what_is_reported(noisy) -> None:
    """With a = 0.8 nine touches are one observation: uncertainties of the well known grow by 3."""
    model = ordinary_model(noisy.touches.chain)
    prior, gross = Prior.of_effects(model.effects), fit_run(noisy, model).gross
    whole = fit_run(noisy, model, prior, gross=gross)
    slow = fit_run(noisy, model, prior, gross=gross, memory=Memory(0.8, is_filtered=False))
    assert slow.weight == pytest.approx(3.0)
    ratio = np.sqrt(np.diag(slow.covariance) / np.diag(whole.covariance))
    assert np.all(ratio > 0.999)
    assert 2.0 < ratio.max() < 3.5


def test_noise_that_remembers_is_said_to_and_nothing_is_named(noisy, tmp_path, unchanged) -> None:
    few = proposals(noisy.touches, ("backlash", "thermal-lag", "drift"))
    result = diagnose(noisy, candidates=few)
    assert result.verdict is Verdict.NONE
    assert result.found == ()
    memory = result.fit.memory
    assert memory is not None
    stated = f"correlation {memory.correlation:.2f}"
    assert f"and is correlated ({stated}" in verdict_sentence(result)
    assert any(
        f"the noise is correlated ({stated}" in remark_sentence(r) for r in remarks(result.fit)
    )
    (tmp_path / "model.toml").write_text(model_text(result.fit, "run.csv"), encoding="utf-8")
    assert "held_out_um" in (tmp_path / "model.toml").read_text(encoding="utf-8")
    unchanged(answer_text(result))


def test_evidence_beside_columns_of_a_wide_prior_is_that_of_all_digits() -> None:
    """Two columns of a prior 1e8 times the noise point the same way, as those of two lines do."""
    rng = np.random.default_rng(8)
    X, y = rng.standard_normal((12, 4)), 3.0 * rng.standard_normal(12)
    X[:, :2] = 1e8 * X[:, :1]
    with mp.workdps(60):
        C, z = mp.matrix(X.tolist()), mp.matrix(y.tolist())
        square = mp.mpf(1)
        for remaining in reversed(range(MEMORY_PASSES + 1)):
            V = square * mp.eye(12) + C * C.T  # the covariance of the deviations, not the normals
            objective = (z.T * mp.lu_solve(V, z))[0]
            if remaining:
                square *= (objective + PRIOR_DOF) / (12 + PRIOR_DOF)
        expected = float(-(mp.log(mp.det(V)) + objective) / 2)
    assert _marginal(X, y, 0.0) == pytest.approx(expected, abs=1e-6)
