"""Choice by prediction, on records made by an integrator and against loops done the long way."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import gauge_touches
from scipy.integrate import solve_ivp

from matstd.api.diagnosing import Diagnosis as Saved
from matstd.api.diagnosing import candidates
from matstd.api.saved import extended
from matstd.diagnosis.accuracy import Promise, blocks
from matstd.diagnosis.answer import ConfusionClass, Diagnosis, Step, compare, diagnose
from matstd.diagnosis.answer.ambiguity import Rival
from matstd.diagnosis.answer.averaged import averaged
from matstd.diagnosis.answer.sizes import sizes
from matstd.diagnosis.choice import Choice, candidate_effects, prediction, with_chosen_set
from matstd.diagnosis.choice.bodies import bodies
from matstd.diagnosis.choice.field import PRIOR_SIZES, sized_field
from matstd.diagnosis.choice.prediction import without
from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, projected
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.regression import Memory
from matstd.diagnosis.search import DiagnosisTask, searched
from matstd.report.verdict import part_lines, promise_sentence
from matstd.report.words import verdict_sentence
from matstd.report.words.diagnosis_words import named_value
from matstd.twin.errors import DesignError
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import columns
from matstd.twin.record import Run
from matstd.twin.thermal import field
from matstd.twin.units import MINUTE, UM

N = 240
STATED = 1.0 * UM
TAUS = (3.0 * MINUTE, 45.0 * MINUTE)


def lag(time: np.ndarray, drive: np.ndarray, tau: float) -> np.ndarray:
    """``tau dy/dt = d - y``, regridded at the start, by Runge and Kutta."""
    found = solve_ivp(
        lambda at, y: (np.interp(at, time, drive) - y) / tau,
        (time[0], time[-1]),
        [drive[0]],
        t_eval=time,
        max_step=20.0,
        rtol=1e-7,
        atol=1e-9,
    )
    return found.y[0]


def record(seed: int = 3, wander: float = 0.0) -> Run:
    """A nozzle on a pin over four hours: bed heated and cooled twice, frame slow, Z follows both.

    Args:
        seed: Of the noise.
        wander: Size of a slow wandering that nothing recorded, µm.
    """
    rng = np.random.default_rng(seed)
    time = 60.0 * np.arange(N)
    wanted = np.where((time % 7200.0) < 4200.0, 100.0, 25.0)
    bed = lag(time, wanted, 240.0)
    frame = 22.0 + 0.15 * (lag(time, bed, 2400.0) - 25.0) + 0.3 * np.sin(time / 3100.0)
    z = 12.0 * (frame - 20.0) - 0.9 * (lag(time, bed - 20.0, TAUS[0]))
    z += 0.7 * lag(time, bed - 20.0, TAUS[1]) + rng.normal(size=N)
    slow = rng.normal(size=N)
    for i in range(1, N):
        slow[i] = 0.97 * slow[i - 1] + np.sqrt(1.0 - 0.97**2) * slow[i]
    z += wander * slow
    touches = gauge_touches(time, temperature={"bed": bed, "frame": frame})
    return Run(touches, z * UM, np.full(N, STATED))


def task_of(run: Run) -> DiagnosisTask:
    start = ordinary_model(run.touches.chain)
    return DiagnosisTask(run, start, Prior.of_effects(start.effects))


def test_both_time_constants_of_a_body_are_found_within_what_is_stated() -> None:
    task = task_of(record())
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    found = bodies(task, gross)
    names = {s.effect.name for s in found}
    assert {"thermal-lag(EZZ,bed)", "thermal-lag(EZZ,bed)#2", "thermal-static(EZZ,frame)"} <= names
    stated, _ = sizes(task, found, gross, ResidualSpace.of(task.fit((), gross)))
    lags = sorted((r.value, r.u) for reported in stated for r in reported if r.name == "tau_min")
    for (value, u), tau in zip(lags, TAUS, strict=True):
        assert abs(value - tau / MINUTE) < 3.0 * u
        assert u < 0.5 * value


def test_a_large_effect_does_not_hide_what_is_small_beside_it() -> None:
    """Evidence by the size of what is left: half the residual over n rows is n log 2, whatever
    the starting model leaves.
    """
    task = task_of(record())
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    base = task.fit((), gross)
    assert base.noise.factor > 20.0
    complement = ResidualSpace.of(base)
    nothing = EffectSet(complement, np.zeros((len(complement.residual), 0)))
    found = EffectSet(complement, projected(complement, bodies(task, gross)))
    fall = 0.5 * N * np.log(nothing.objective / found.objective)
    gained = found.evidence - nothing.evidence + 0.5 * found.log_det
    assert gained == pytest.approx(fall, rel=0.1)


def test_blocks_are_longer_than_what_is_remembered() -> None:
    run = record()
    fit = fit_run(run, ordinary_model(run.touches.chain))
    memory = Memory(np.exp(-1.0 / 12.0), 60.0)  # twelve minutes
    groups = blocks(fit, memory)
    np.testing.assert_array_equal(np.sort(np.concatenate(groups)), np.flatnonzero(fit.used))
    for rows in groups:
        time = run.touches.time[rows]
        assert np.ptp(time) >= 2.9 * 12.0 * 60.0
        assert np.all(np.diff(rows) > 0)
    cycles = replace(run.touches, pose=np.repeat(np.arange(4), N // 4))
    fit = fit_run(replace(run, touches=cycles), ordinary_model(run.touches.chain))
    assert [len(set(cycles.pose[rows])) for rows in blocks(fit, memory)] == [1, 1, 1, 1]


def test_the_size_of_a_field_is_that_of_ridge_regression_by_blocks() -> None:
    """Leave every block out, solve the augmented least squares, look at the plain errors."""
    run = record(wander=3.0)
    task = task_of(run)
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    warm = field(run.touches)
    groups = np.array_split(np.arange(N), 5)
    sized = sized_field(task, gross, warm, groups)
    fit = task.fit((sized,), gross)
    place = fit.of_effect(warm.name)
    C = columns(fit.effects, run.touches)
    sd = np.sqrt(np.diag(fit.prior.root @ fit.prior.root.T))

    def error(factor: float) -> float:
        scale = sd.copy()
        scale[place] *= factor
        X, y = C * scale / fit.u[:, None], run.deviation / fit.u
        out = []
        for rows in groups:
            keep = np.setdiff1d(np.arange(N), rows)
            A = np.vstack([X[keep], np.eye(X.shape[1])])
            b = np.concatenate([y[keep], np.zeros(X.shape[1])])
            phi = np.linalg.lstsq(A, b, rcond=None)[0]
            out.append((y[rows] - X[rows] @ phi) * fit.u[rows])
        return float(np.sqrt(np.mean(np.concatenate(out) ** 2)))

    errors = {f: error(f) for f in (1.0 / 16.0, 1.0, 16.0)}
    assert len(PRIOR_SIZES) == 13
    assert errors[1.0] < 1.02 * min(errors.values())


def test_a_long_run_is_judged_by_an_even_choice_of_its_instants(monkeypatch) -> None:
    monkeypatch.setattr(prediction, "MAX_ROWS", N // 2)
    run = record()
    twice = run[np.repeat(np.arange(N), 2)]  # two gauges that read together
    task = task_of(twice)
    small = prediction.thinned(task, task.fit())
    kept = small.run.touches.time[small.run.split != "test"]
    assert len(kept) == N // 2
    assert np.all(np.unique(kept, return_counts=True)[1] == 2)
    assert np.ptp(np.diff(np.unique(kept))) == 0.0


@pytest.fixture(scope="module")
def result() -> Diagnosis:
    """Of a run with a slow wandering that nothing recorded explains."""
    run = record(wander=6.0)
    return diagnose(run, candidates=[*single_of(run), field(run.touches)])


@pytest.fixture(scope="module")
def chosen(result) -> tuple[DiagnosisTask, Choice]:
    """Its choice by prediction."""
    assert result.choice is not None
    return task_of(record(wander=6.0)), result.choice


def single_of(run: Run) -> list:
    """Few candidates, so that every block is soon searched."""
    kinds = ("thermal-lag", "thermal-static")
    return [e for e in candidate_effects(run.touches) if e.kind in kinds and "EZZ" in e.name]


def test_the_stated_error_has_paid_for_the_choice(chosen) -> None:
    """Each block by hand: what is chosen without it predicts it with the error that is reported."""
    task, choice = chosen
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    way = next(w for w in choice.rules if w.name == "two time constants")
    assert choice.blocks == len(way.errors)
    assert way.rows.sum() == N
    first = np.arange(way.rows[0])
    part = without(task, first)
    fit = part.fit(bodies(part, gross), gross)
    predicted = columns(fit.effects, task.run.touches) @ fit.theta
    error = np.sqrt(np.mean((task.run.deviation - predicted)[first] ** 2))
    assert way.errors[0] == pytest.approx(error, rel=1e-6)
    total = np.sqrt(np.sum(way.rows * way.errors**2) / N)
    assert way.error == pytest.approx(total)
    assert choice.best.error <= 1.05 * min(w.error for w in choice.rules)


def test_the_error_of_a_choice_is_one_number_wherever_it_is_stated(result) -> None:
    """Verdict, parts and model file; before and after are of the same blocks."""
    before, after = (rule.error / UM for rule in (result.choice.rules[0], result.choice.best))
    assert before > after > 1.5 * result.fit.test_rms / UM  # no fit to all rows shows it
    fall = f"falls from {before:.2f} µm to {after:.2f} µm"
    line = dict(part_lines(result))["error to expect"]
    assert line.startswith(f"{before:.2f} µm → {after:.2f} µm at other places")
    assert f"{after:.2f} µm at the same touches" in line
    assert fall in verdict_sentence(result)
    for auto, error in ((True, after), (False, before)):
        saved = extended(Saved, result, auto=auto).model
        assert saved.source.promise.same / UM == pytest.approx(error)
        assert saved.source.promise.elsewhere / UM == pytest.approx(error)


def test_of_the_set_that_was_weighed_all_is_reported_but_what_chance_explains(result) -> None:
    assert result.choice is not None
    stated = [e.name for e in result.found]
    weighed = {s.effect.name for s in result.choice.best.effects}
    assert weighed >= set(stated) >= {"thermal-lag(EZZ,bed)", "thermal-static(EZZ,frame)"}
    assert all(step.p_value < 0.05 for step in result.steps[1:])
    assert len(set(stated)) == len(stated)
    assert result.remarks[0].chosen == result.choice.best.name
    names = [e.name for e in result.fit.model.effects]
    assert names[-len(stated) :] == stated


def test_a_way_that_is_followed_counts_independent_observations(chosen) -> None:
    task, choice = chosen
    single = single_of(task.run)
    way = next(w for w in choice.rules if w.name == "two time constants")
    other = Choice(choice.rules, way, choice.blocks, Memory(0.9))
    slow, final = with_chosen_set(task, searched(task, single), other, single)
    assert slow.memory is not None
    assert not slow.memory.is_filtered
    complement = final.search.complement
    assert complement.count < N / 7.0
    assert complement.dof < complement.count


def test_a_broken_promise_is_said() -> None:
    run = record()
    found = compare(run, ordinary_model(run.touches.chain))
    here = 0.5 * found.rms  # what counts is the promise for other places
    assert "worse than promised" in promise_sentence(found, Promise(here, here, ()))
    assert "as good as promised" in promise_sentence(found, Promise(here, found.rms, ()))


def test_a_noise_stated_too_large_is_no_uncertainty_of_the_model() -> None:
    run = record()
    noise = np.random.default_rng(5).normal(0.0, 0.2 * run.u)
    found = compare(replace(run, deviation=noise), ordinary_model(run.touches.chain))
    assert found.expected > 2.0 * found.rms
    words = promise_sentence(found, Promise(found.rms, 2.0 * found.rms, ()))
    assert "as good as promised" in words
    assert "an expected error" not in words


def test_candidates_are_narrowed_by_kind_and_by_name() -> None:
    run = record()
    assert candidates([], [], run) is None
    names = {e.name for e in candidates(["thermal-static"], ["thermal-static(EZZ, bed)"], run)}
    assert "thermal-static(EZZ,frame)" in names
    assert "thermal-static(EZZ,bed)" not in names
    assert {n.partition("(")[0] for n in names} == {"thermal-static"}
    assert all(e.kind != "thermal-field" for e in candidates([], ["thermal-field"], run))
    with pytest.raises(DesignError, match="only thermal-statik: expected a kind"):
        candidates(["thermal-statik"], [], run)
    with pytest.raises(DesignError, match="nothing is left to search for"):
        candidates(["drift"], ["drift"], run)


def test_a_time_constant_at_the_end_of_its_scan_is_a_bound() -> None:
    """A body that follows within seconds: all that the scan can say is `at most two minutes`."""
    run = record()
    quick = replace(run, deviation=12.0 * UM * (run.touches.temperature["frame"] - 20.0))
    noise = np.random.default_rng(8).normal(size=N) * UM
    task = task_of(replace(quick, deviation=quick.deviation + noise))
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    lag_frame = parse_effect("thermal-lag(EZZ,frame)", run.touches.chain).tuned(120.0)
    (stated,), _ = sizes(
        task, [ScaledEffect(lag_frame, 4.0)], gross, ResidualSpace.of(task.fit((), gross))
    )
    tau = next(r for r in stated if r.name == "tau_min")
    assert (tau.bound, tau.u) == (-1, None)
    assert named_value(tau) == ("time constant", "at most 2.00 min")


def test_a_slip_is_as_large_as_the_direction_that_was_probed_says() -> None:
    """Across the gauge nothing is seen: the prior of those directions is no uncertainty."""
    run = record()
    step = np.where(run.touches.time > 7000.0, 9.0 * UM, 0.0)
    noise = np.random.default_rng(9).normal(size=N) * UM
    task = task_of(replace(run, deviation=step + noise))
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    slip = parse_effect("artefact-slip", run.touches.chain).tuned(7000.0)
    (stated,), _ = sizes(
        task, [ScaledEffect(slip, 4.0)], gross, ResidualSpace.of(task.fit((), gross))
    )
    size = next(r for r in stated if r.name.startswith("amplitude"))
    assert abs(size.value - 9.0) < 3.0 * size.u
    assert size.u < 1.0


def test_members_of_a_class_share_what_they_explain() -> None:
    """Two sensors that agree today: half of the size each, and open when they part tomorrow.

    At 10 K of the first and none of the second, 12 um/K give 60 um by the mean of both; whichever
    it is, the truth (120 or 0) lies 60 um off.
    """
    run = record()
    frame = run.touches.temperature["frame"]
    alike = replace(run.touches, temperature={"frame": frame, "wall": frame.copy()})
    run = replace(run, touches=alike, deviation=-12.0 * UM * (frame - 20.0))
    task, chain = task_of(run), alike.chain
    one, other = (
        ScaledEffect(parse_effect(f"thermal-static(EZZ,{name})", chain), 4.0)
        for name in ("frame", "wall")
    )
    fits = (task.fit(), task.fit([one]))
    steps = [
        Step(effect=effect, fit=fit, p_value=0.0, reported=(), confusion=None)
        for effect, fit in zip((None, one.effect), fits, strict=True)
    ]
    found = ConfusionClass(one, (Rival(other, 0.0, 1.0),), ())
    whole = averaged(task, steps, [found], fits[1].gross)
    sizes = [whole.theta[whole.of_effect(s.effect.name)][0] / UM for s in (one, other)]
    assert sizes == pytest.approx([6.0, 6.0], rel=0.02)
    parted = replace(alike, temperature={"frame": frame + 10.0, "wall": frame})
    tomorrow = columns(whole.model.effects, parted) - columns(whole.model.effects, alike)
    m = len(whole.model.parameters)
    assert (tomorrow @ whole.theta[:m] / UM)[0] == pytest.approx(-60.0, rel=0.02)
    u = np.linalg.norm(tomorrow @ whole.spread[:m], axis=1)[0] / UM
    assert u == pytest.approx(60.0, rel=0.05)  # the deviation of both answers from their mean
    # where nothing else could be meant the named member stands alone
    alone = ConfusionClass(one, (), ())
    assert averaged(task, steps, [alone], fits[1].gross) is fits[1]
