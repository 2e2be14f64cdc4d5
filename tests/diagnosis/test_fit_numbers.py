"""The fit in numbers: by hand, by brute force, by leaving out, and on noise that is not as stated.

The brute force here builds normal equations and inverts them, which the code never does.
"""

from dataclasses import replace

import numpy as np
import pytest
from marks import slow

from matstd.diagnosis.accuracy import repeatability
from matstd.diagnosis.fit import fit_run, unit_mistake
from matstd.diagnosis.regression import left_out, places_of, replicate_factor, solve
from matstd.diagnosis.remarks import What, noticed, remarks
from matstd.importers import one_axis_machine, positioning_run
from matstd.importers.instruments import PositioningTest
from matstd.twin.effects import SHIFT_SD, TURN_SD, setup_errors
from matstd.twin.errors import NotEnoughData
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.units import NM, UM

ROUNDING = 1e-12
"""Numbers of size 1 out of sums of two products."""
SAME = 1e-4
"""Share of a standard uncertainty: normal equations square a condition of some 1e5, so that brute
force keeps 6 of 16 digits, of estimates that are up to some hundred times their uncertainty."""
SIGMAS = 4.0
"""A sample statistic off by more than this has a probability of 6e-5."""


def test_two_parameters_by_hand() -> None:
    """X = [1 0; 1 1], y = (5, 10), unit prior: X'X + 1 = [3 1; 1 2] with determinant 5."""
    X, y = np.array([[1.0, 0.0], [1.0, 1.0]]), np.array([5.0, 10.0])
    s = solve(X, y)
    np.testing.assert_allclose(s.phi, [4.0, 3.0], atol=ROUNDING)
    np.testing.assert_allclose(s.covariance, [[0.4, -0.2], [-0.2, 0.6]], atol=ROUNDING)
    np.testing.assert_allclose(s.residual, [1.0, 3.0], atol=ROUNDING)
    np.testing.assert_allclose(s.leverage, [2 / 5, 3 / 5], atol=ROUNDING)
    assert s.effective_parameters == pytest.approx(1.0, abs=ROUNDING)
    assert s.dof == pytest.approx(1.0, abs=ROUNDING)
    # 1 + 9 of the residual, 16 + 9 of the distance from the prior
    assert s.objective == pytest.approx(35.0, abs=35.0 * ROUNDING)
    out = left_out(s.Q, s.residual, [np.array([0]), np.array([1])])
    # without row 0: phi = (10/3, 10/3); without row 1: phi = (5/2, 0); each against its y
    np.testing.assert_allclose(out.error, [5.0 - 10 / 3, 10.0 - 5 / 2], atol=10 * ROUNDING)
    # the variances of those errors are 5/3 and 5/2
    assert out.squared == pytest.approx((5 / 3) ** 2 / (5 / 3) + 7.5**2 / (5 / 2), rel=ROUNDING)
    assert out.log_det == pytest.approx(np.log(5 / 3) + np.log(5 / 2), rel=10 * ROUNDING)


def brute_force(fit, rows):
    """Estimates and covariance in base units by normal equations over some rows."""
    A = columns(fit.effects, fit.run.touches)[rows]
    W = 1.0 / fit.u[rows]
    sd = np.array([p.sd for e in fit.effects for p in e.parameters]) * fit.prior.factor
    X = A * W[:, None] * sd
    covariance = np.linalg.inv(X.T @ X + np.eye(len(sd)))
    phi = covariance @ (X.T @ (fit.run.deviation[rows] * W))
    return sd * phi, covariance * np.outer(sd, sd), A


@pytest.mark.parametrize("machine", ["hsm600u", "hmc1995"])
def test_estimates_are_those_of_the_normal_equations(fitted, machine) -> None:
    fit = fitted(1, machine)
    assert fit.widened == 1.0
    theta, covariance, A = brute_force(fit, fit.used)
    u = np.sqrt(np.diag(covariance))
    assert np.max(np.abs(fit.theta - theta) / u) < SAME
    assert np.max(np.abs(fit.covariance - covariance) / np.outer(u, u)) < SAME
    np.testing.assert_allclose(
        fit.residual[fit.used], fit.run.deviation[fit.used] - A @ theta, atol=0.1 * NM
    )


def test_set_ups_are_free(fitted) -> None:
    fit = fitted(1, "hmc1995")
    assert [e.name for e in fit.setups] == [f"setup({c})" for c in "abcde"]
    wanted = [SHIFT_SD] * 3 + [TURN_SD] * 3
    for e in fit.setups:
        assert list(fit.prior.sd[fit.of_effect(e.name)]) == pytest.approx(wanted)


def test_left_out_poses_are_what_a_refit_predicts(fitted) -> None:
    fit = fitted(1, "hmc1995")
    used = np.flatnonzero(fit.used)
    assert sum(map(len, fit.groups)) == len(used)
    squared = 0.0
    for group in fit.groups:
        rows = used[group]
        others = np.setdiff1d(used, rows)
        theta, covariance, _ = brute_force(fit, others)
        A = columns(fit.effects, fit.run.touches[rows]) / fit.u[rows, None]
        error = fit.run.deviation[rows] / fit.u[rows] - A @ theta
        np.testing.assert_allclose(fit.held_out.error[group], error, atol=SAME)
        spread = np.eye(len(rows)) + A @ covariance @ A.T
        squared += float(error @ np.linalg.solve(spread, error))
    assert fit.held_out.squared == pytest.approx(squared, rel=SAME)


def test_rows_marked_as_held_out_teach_nothing(case) -> None:
    """Nonsense in held-out rows leaves the estimates as they are, to the last digit."""
    run, _ = case(1, "hmc1995")
    split = np.where(run.touches.pose % 5 == 0, "test", "train")
    spoilt = np.where(split == "test", run.deviation + 1.0, run.deviation)
    model = ordinary_model(run.touches.chain)
    fits = [fit_run(replace(run, split=split, deviation=d), model) for d in (run.deviation, spoilt)]
    np.testing.assert_array_equal(fits[0].theta, fits[1].theta)
    n = int((split == "test").sum())
    # the held-out error is the noise, within the scatter of n squares (prediction allowed for)
    assert fits[0].standardised_test_rms == pytest.approx(0.6 * UM, rel=SIGMAS / np.sqrt(2.0 * n))


@pytest.mark.parametrize("seed", [3, *slow(4, 5)])
def test_chips_are_found_reported_and_kept_out(case, fitted, seed) -> None:
    """Chips of 15 to 60 um at a noise below 0.85 um: all of them, and hardly ever another row."""
    run, truth = case(seed, "hsm600u", (), True)
    fit = fitted(seed, "hsm600u", (), True)
    assert np.flatnonzero(fit.gross.rows).tolist() == truth["chips"]
    np.testing.assert_array_equal(fit.used, ~fit.gross.rows)
    assert np.min(fit.residual[truth["chips"]]) > 10.0 * UM
    (remark,) = [r for r in remarks(fit) if getattr(r, "what", None) is What.OUTLIERS_LEFT_OUT]
    assert sorted(remark.lines) == sorted(run.line[truth["chips"]])
    assert remark.largest == pytest.approx(fit.residual[truth["chips"]].max())


def test_nothing_is_dropped_where_nothing_stands_out(fitted) -> None:
    fit = fitted(1, "hsm600u")
    assert fit.used.all()
    assert not any(getattr(r, "what", None) is What.OUTLIERS_LEFT_OUT for r in remarks(fit))


def test_too_many_outliers_are_structure_and_stay(case) -> None:
    """Every tenth touch 20 um off is no accident: all are kept, and it is reported."""
    run, _ = case(1, "hmc1995")
    off = np.where(np.arange(len(run)) % 10 == 0, 20.0 * UM, 0.0)
    model = ordinary_model(run.touches.chain)
    fit = fit_run(replace(run, deviation=run.deviation + off), model)
    assert fit.used.all()
    assert noticed(What.OUTLIERS_KEPT) in remarks(fit)


@pytest.mark.parametrize("factor", [0.45 / 0.6, 0.85 / 0.6])
def test_noise_wrongly_stated_is_recognised(case, factor) -> None:
    """The simulator's 0.6 um stated as 0.8 or as 0.424 um: a true noise of 0.45 or 0.85 per 0.6."""
    run, _ = case(1, "hmc1995")
    fit = fit_run(replace(run, u=run.u / factor), ordinary_model(run.touches.chain))
    assert fit.noise.factor == pytest.approx(factor, rel=SIGMAS / np.sqrt(2.0 * fit.noise.dof))
    assert fit.noise.is_wrongly_stated
    (remark,) = [r for r in remarks(fit) if getattr(r, "what", None) is What.NOISE_MISSTATED]
    assert remark.found / remark.stated == fit.noise.factor


@pytest.mark.parametrize("seed", [3, *slow(4, 5)])
def test_noise_of_hard_cases_is_found_beside_chips(case, fitted, seed) -> None:
    truth, noise = case(seed, "hsm600u", (), True)[1], fitted(seed, "hsm600u", (), True).noise
    assert noise.factor * 0.6 == pytest.approx(
        truth["noise_um"], rel=SIGMAS / np.sqrt(2.0 * noise.dof)
    )


def test_noise_rightly_stated_is_left_alone(fitted) -> None:
    fit = fitted(1, "hsm600u")
    assert fit.noise.factor == pytest.approx(1.0, abs=SIGMAS / np.sqrt(2.0 * fit.noise.dof))
    assert not any(getattr(r, "what", None) is What.NOISE_MISSTATED for r in remarks(fit))


def test_the_machine_does_not_depend_on_where_the_standard_was_clamped(case, fitted) -> None:
    """Every set-up moved by 0.2 mm and 1 mrad more: the machine's estimates stay.

    The wide prior of a set-up (1 mm, 5 mrad) holds back a millionth of what the run shows; what a
    machine parameter can imitate is shared by the squares of the prior deviations, 10 um : 1 mm,
    so that 1e-4 of 0.2 mm, 20 nm, may go there. Uncertainties of such parameters are micrometres.
    """
    run, _ = case(1, "hmc1995")
    before = fitted(1, "hmc1995")
    move = np.tile([0.2, -0.2, 0.2, 1e-3, -1e-3, 1e-3], len(before.setups))
    moved = run.deviation + columns(setup_errors(run.touches), run.touches) @ move
    after = fit_run(replace(run, deviation=moved), before.model)
    machine = len(before.model.parameters)
    u = np.sqrt(np.diag(before.covariance))
    assert np.max(np.abs(after.theta - before.theta)[:machine] / u[:machine]) < 0.1
    np.testing.assert_allclose(after.residual, before.residual, atol=20.0 * NM)
    # the set-ups themselves follow, up to what the machine's own set-up parameters keep
    np.testing.assert_allclose((after.theta - before.theta)[machine:], move, rtol=0.1)


def test_fewer_touches_than_parameters(case) -> None:
    """60 touches, 155 parameters: estimates kept by the prior, uncertainties that hold.

    Machines are drawn from the prior; the scaled error of every parameter then has a mean square
    of 1. The 40 machines are independent, the parameters of one are not: their scatter decides.
    """
    run, _ = case(1, "hsm600u")
    few = run[np.arange(0, len(run), 13)]
    model = ordinary_model(few.touches.chain)
    effects = (*model.effects, *setup_errors(few.touches))
    A, sd = columns(effects, few.touches), np.array([p.sd for e in effects for p in e.parameters])
    assert len(few) < len(sd)
    rng = np.random.default_rng(7)
    squares = []
    for _ in range(40):
        theta = sd * rng.normal(size=len(sd))
        fit = fit_run(replace(few, deviation=A @ theta + rng.normal(0.0, few.u)), model)
        u = np.sqrt(np.diag(fit.covariance))
        assert np.all(u <= sd * fit.widened * (1.0 + SAME))
        squares.append(np.mean(((fit.theta - theta) / u) ** 2))
    stated = {r.what: r for r in remarks(fit) if hasattr(r, "what")}
    remark, room = stated[What.FEW_TOUCHES], stated[What.FEW_DEGREES_OF_FREEDOM]
    assert remark.touches == len(few) < remark.parameters < len(sd)  # some errors nothing feels
    assert room.dof == pytest.approx(len(few) - fit.solution.effective_parameters)
    assert fit.solution.effective_parameters < len(few)
    error = np.std(squares) / np.sqrt(len(squares))
    assert np.mean(squares) == pytest.approx(1.0, abs=SIGMAS * error)
    assert error < 0.05  # else the line above would pass anything


def test_so_few_touches_are_refused(case) -> None:
    run, _ = case(1, "hmc1995")
    with pytest.raises(NotEnoughData, match="5 touches, expected at least 8"):
        fit_run(run[:5], ordinary_model(run.touches.chain))


def test_replicates_distinguish_noise_from_what_the_model_lacks(case) -> None:
    """Every touch twice, 0.9 um apart by chance, beside 0.6 um that both share."""
    run, _ = case(1, "hmc1995")
    twice = run[np.repeat(np.arange(len(run)), 2)]
    rng = np.random.default_rng(9)
    scatter = rng.normal(0.0, 0.9 * UM, len(twice))
    fit = fit_run(
        replace(twice, deviation=twice.deviation + scatter), ordinary_model(run.touches.chain)
    )
    assert fit.noise.replicates_dof == len(run)
    assert fit.noise.replicates == pytest.approx(0.9 / 0.6, rel=SIGMAS / np.sqrt(2.0 * len(run)))
    # the residual holds both
    both = np.hypot(0.9, 0.6) / 0.6
    assert fit.noise.factor == pytest.approx(both, rel=SIGMAS / np.sqrt(2.0 * len(run)))
    (remark,) = [r for r in remarks(fit) if getattr(r, "what", None) is What.WORSE_THAN_REPLICATES]
    assert remark.ratio == pytest.approx(fit.noise.factor / fit.noise.replicates)
    assert fit_run(run, fit.model).noise.replicates is None
    # readings that repeat to the last digit scatter by nothing, which no residual is a ratio of
    equal = fit_run(twice, fit.model)
    assert equal.noise.replicates == 0.0
    assert not [r for r in remarks(equal) if getattr(r, "what", 0) is What.WORSE_THAN_REPLICATES]


def _readings_at(time, target, deviation, u):
    test = PositioningTest(
        axis="X",
        target=target,
        deviation=deviation,
        cycle=np.ones(len(time), dtype=np.int64),
        direction=np.ones(len(time), dtype=np.int64),
        line=np.arange(len(time)),
        time=time,
    )
    return positioning_run(test, one_axis_machine("X", np.array([0.0, 100.0])), u)


def test_readings_on_the_way_are_no_replicates() -> None:
    """Steps of 10 µm of an encoder over 1.2 mm, and steps of 2 µm of a laser over as much."""
    for time, step in ((np.arange(120.0), 0.01), (np.zeros(600), 0.002)):
        at = 5.0 + step * np.arange(len(time))
        run = _readings_at(time, at, np.zeros(len(at)), 1.0 * UM)
        place, _ = places_of(run, np.ones(len(at), dtype=bool))
        assert len(np.unique(place)) == len(at)


def test_a_drift_between_replicates_is_no_repeatability() -> None:
    """Triplets seconds apart in a warming of 150 µm; numpy pools the deviations of the triplets."""
    rng = np.random.default_rng(3)
    triplets = 400
    time = (60.0 * np.arange(triplets)[:, None] + [0.0, 4.0, 8.0]).ravel()
    drift = 150.0 * UM * (1.0 - np.exp(-time / 6000.0))
    deviation = drift + rng.normal(0.0, 1.2 * UM, len(time))
    run = _readings_at(time, np.full(len(time), 50.0), deviation, 2.0 * UM)
    factor, dof = replicate_factor(run, deviation / run.u, np.ones(len(time), dtype=bool))
    pooled = np.sqrt(deviation.reshape(triplets, 3).var(axis=1, ddof=1).mean())
    assert factor * 2.0 * UM == pytest.approx(pooled, rel=SIGMAS / np.sqrt(2.0 * dof))
    assert dof == int(2 * 800**2 / (3 * 800 - 400))  # chains of two differences
    # no axis moves, so the machine is expected to be off by nothing: no hint at another unit
    assert unit_mistake(fit_run(run, ordinary_model(run.touches.chain))) is None


def test_steady_readings_show_their_noise_while_they_drift() -> None:
    """Readings a minute apart without a pause; numpy removes the drift that was put in."""
    rng = np.random.default_rng(4)
    time = 60.0 * np.arange(300)
    noise = rng.normal(0.0, 0.5 * UM, len(time))
    deviation = 12.0 * UM * (1.0 - np.exp(-time / 2400.0)) + noise
    run = _readings_at(time, np.full(len(time), 50.0), deviation, 0.5 * UM)
    factor, dof = replicate_factor(run, deviation / run.u, np.ones(len(time), dtype=bool))
    assert factor * 0.5 * UM == pytest.approx(noise.std(), rel=SIGMAS / np.sqrt(2.0 * dof))


def test_a_place_that_was_left_is_revisited_and_not_replicated() -> None:
    """Five targets in turn, 20 rounds: what drifts between the rounds is in the re-visits alone."""
    rng = np.random.default_rng(5)
    target = np.tile(20.0 * np.arange(5), 20)
    time = 10.0 * np.arange(len(target))
    deviation = 0.05 * UM * time / 10.0 + rng.normal(0.0, 0.3 * UM, len(time))
    run = _readings_at(time, target, deviation, 0.5 * UM)
    assert replicate_factor(run, deviation / run.u, np.ones(len(time), dtype=bool)) == (None, 0)
    fit = fit_run(run, ordinary_model(run.touches.chain))
    found = repeatability(fit)
    assert found.replicates is None
    left = fit.residual.reshape(20, 5)
    assert found.revisits.size == pytest.approx(np.sqrt(left.var(axis=0, ddof=1).mean()))
    assert found.revisits.dof == 95


def test_an_instant_has_no_tangent_a_time_constant_has_one(case) -> None:
    """Columns of a jump step where its instant passes a touch; those of a lag have a slope."""
    run = case(5, "hsm600u", ("thermal-lag(EXC)",)).run[::6]
    chain, time = run.touches.chain, run.touches.time
    lag = parse_effect("thermal-lag(EXC)", chain)
    jump = parse_effect("jump(EXX)", chain).tuned(time[len(time) // 2])
    model = Model(chain, (*ordinary_model(chain).effects, lag, jump))
    free = np.ones(sum(len(e.parameters) for e in model.effects))
    tangents = fit_run(run, model, free_inner=free).tangents
    assert [t.effect.name for t in tangents] == [lag.name]
