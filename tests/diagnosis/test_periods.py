"""Periods on one axis: fine logs, and targets that cannot distinguish one period from another.

Data are made by a plain sine; periods that look alike come from the sampling theorem by hand.
"""

from dataclasses import replace

import numpy as np
import pytest
from made_up import run_of
from unchanged import answer_text

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.answer.alike import _fraction, even_step
from matstd.diagnosis.fit import Role
from matstd.report.words import scanned_sentence
from matstd.twin.effects.periodic import scanned_periods
from matstd.twin.frames import Array
from matstd.twin.model import Inner, is_tunable
from matstd.twin.record import Run
from matstd.twin.units import UM


def positioning(targets: Array, period: float, amplitude: float, seed: int = 0) -> Run:
    """Five cycles over some targets, both ways, scattering by 0.5 µm."""
    rng = np.random.default_rng(seed)
    x = np.tile(np.concatenate([targets, targets[::-1]]), 5)
    cycle = np.repeat(np.arange(5), 2 * len(targets))
    noise = rng.normal(0.0, 0.5 * UM, len(x))
    # a row says where the tool believes the surface to stand: minus the error of the axis
    return run_of(x, -amplitude * np.sin(2.0 * np.pi * x / period + 0.4) + noise, cycle=cycle)


def aliases(step: float, period: float) -> list[float]:
    """Periods that read as one at targets so far apart: ``1/p' = k/step ± 1/p``, longest first."""
    inside = [abs(k / step + sign / period) for k in range(0, 9) for sign in (1.0, -1.0)]
    found = {round(1.0 / f, 12) for f in inside if 1.0 / 50.0 <= f <= 1.0}
    return sorted(found, reverse=True)


@pytest.mark.parametrize("period", [0.25, 2.0])
def test_a_fine_log_shows_a_short_period(period: float) -> None:
    rng = np.random.default_rng(3)
    x = np.arange(5.0, 15.0, 0.01)
    error = 20.0 * UM * np.sin(2.0 * np.pi * x / period)
    found = diagnose(run_of(x, -error + rng.normal(0.0, 0.5 * UM, len(x))))
    assert found.verdict is Verdict.MISSING
    (effect,) = found.found
    assert effect.name == "periodic(EXX)"
    assert is_tunable(effect)
    assert effect.tuning["period"] == pytest.approx(period, rel=1e-3)
    confusion = found.steps[1].confusion
    assert confusion is not None
    assert confusion.alike is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("encoder", "expected"),
    [
        pytest.param(0.27, [("periodic(EXX)", 0.27), ("periodic(EXX)", 2.0)], id="no harmonic"),
        pytest.param(0.25, [("periodic(EXX,8)", 2.0)], id="the eighth harmonic, which it may be"),
    ],
)
def test_a_fine_log_of_many_rows_shows_two_periods(
    encoder: float, expected: list[tuple[str, float]], unchanged
) -> None:
    """A screw of 2 mm and an encoder, written down while the axis moves evenly."""
    rng = np.random.default_rng(4)
    x = np.arange(0.0, 100.0, 100.0 / 12000.0)
    error = 3.0 * np.sin(2.0 * np.pi * x / 2.0 + 1.0) + 0.8 * np.sin(2.0 * np.pi * x / encoder)
    run = run_of(x, -error * UM + rng.normal(0.0, 0.05 * UM, len(x)), 0.05 * UM)
    run = replace(run, touches=replace(run.touches, time=0.1 * np.arange(len(x))))
    found = diagnose(run)
    assert found.verdict is Verdict.MISSING
    tuned = [e for e in found.found if is_tunable(e)]
    waves = sorted((e.tuning["period"], e.name.partition("#")[0]) for e in tuned)
    assert [name for _, name in waves] == [name for name, _ in expected]
    assert [p for p, _ in waves] == pytest.approx([p for _, p in expected], rel=1e-4)
    assert found.fit.rms < 0.055 * UM
    unchanged(answer_text(found))


def evenly_timed(run: Run, step: float = 0.1) -> Run:
    """The same, read while the axis moved evenly: a sine over X is a wave in time as well."""
    times = step * np.arange(len(run))
    return replace(run, touches=replace(run.touches, time=times))


def test_a_large_sine_keeps_its_name_beside_a_wave_in_time() -> None:
    rng = np.random.default_rng(6)
    x = np.linspace(0.0, 400.0, 1500)
    error = 100.0 * UM * np.sin(2.0 * np.pi * x / 10.0 + 1.0)
    found = diagnose(evenly_timed(run_of(x, -error + rng.normal(0.0, UM, len(x)), UM)))
    assert found.verdict is Verdict.MISSING
    (effect,) = found.found
    assert is_tunable(effect)
    assert effect.tuning["period"] == pytest.approx(10.0, rel=1e-3)
    assert found.fit.rms == pytest.approx(UM, rel=0.06)


@pytest.mark.slow
def test_a_small_sine_is_found_beside_a_large_one_in_a_long_log() -> None:
    """Six thousand rows are screened: the second period stands only in the second screening."""
    rng = np.random.default_rng(99)
    x = np.linspace(0.0, 300.0, 6000)
    error = 5.0 * np.sin(2.0 * np.pi * x / 20.0 + 0.3) + 0.4 * np.sin(2.0 * np.pi * x / 0.8)
    run = run_of(x, -error * UM + rng.normal(0.0, 0.1 * UM, len(x)), 0.1 * UM)
    found = diagnose(evenly_timed(run, 0.05))
    assert found.verdict is Verdict.MISSING
    periods = [e.tuning["period"] for e in found.found if is_tunable(e)]
    assert sorted(periods) == pytest.approx([0.8, 20.0], rel=1e-4)


def test_what_was_scanned_is_reported() -> None:
    """Targets 6 mm apart over 295 mm: periods from 1 to 50 mm."""
    found = diagnose(positioning(np.arange(5.0, 300.0, 6.0), 2.5, 0.0))
    assert found.verdict is Verdict.NONE
    (scan,) = next(d for d in found.detectable if d.effect.name == "periodic(EXX)").scanned
    assert (scan.quantity, scan.unit, scan.high) == ("period", "mm", 50.0)
    assert scan.low == pytest.approx(1.0, rel=0.01)
    sentence = scanned_sentence(found.detectable)
    assert "periods of 1.00 to 50.0 mm" in sentence
    assert "nothing is known outside these ranges" in sentence


@pytest.mark.slow
def test_effects_of_a_log_do_not_cancel_one_another() -> None:
    """Reading and time run together: growth and polynomials would cancel, thousands of µm each."""
    rng = np.random.default_rng(0)
    x = np.linspace(0.0, 400.0, 3000)
    u = x / 200.0 - 1.0
    error = 2.0 * (8.0 * u**4 - 8.0 * u**2 + 1.0) + 0.5 * np.cos(7.0 * np.arccos(u))
    run = run_of(x, -error * UM + rng.normal(0.0, 0.1 * UM, len(x)), 0.1 * UM)
    found = diagnose(evenly_timed(run))
    for step in found.steps[1:]:
        size = next(r for r in step.reported if r.role is Role.SIZE)
        assert size.u is not None
        assert abs(size.value) < 10.0
        assert size.u < 1.0


def test_even_targets_report_every_period_that_looks_alike(unchanged) -> None:
    run = positioning(np.arange(5.0, 300.0, 6.0), 2.5, 8.0 * UM)
    found = diagnose(run, rng=np.random.default_rng(0))
    confusion = found.steps[1].confusion
    assert confusion is not None
    assert confusion.alike is not None
    alike = confusion.alike
    assert alike.step == pytest.approx(6.0)
    assert alike.pitch is None
    own = next(r.value for r in found.steps[1].reported if r.quantity == "period")
    every = aliases(6.0, 2.5)
    assert 15.0 in every
    assert 10.0 in every
    np.testing.assert_allclose(sorted([own, *alike.periods], reverse=True), every, rtol=2e-3)
    # the plan's places distinguish the true period from every other one by hand
    plan = found.plans[0]
    assert plan.periods_of == "periodic(EXX)"
    x = plan.touches.reading("X")
    seen = run.touches.reading("X")
    for other in (p for p in every if abs(p - 2.5) > 1e-6):
        wave = 2.0 * np.pi * seen[:, None] / other
        basis = np.hstack([np.sin(wave), np.cos(wave)])
        true = 8.0 * np.sin(2.0 * np.pi * seen / 2.5 + 0.4)
        theta = np.linalg.lstsq(basis, true, rcond=None)[0]
        assert np.abs(basis @ theta - true).max() < 1e-6
        wave = 2.0 * np.pi * x[:, None] / other
        there = np.hstack([np.sin(wave), np.cos(wave)]) @ theta
        off = there - 8.0 * np.sin(2.0 * np.pi * x / 2.5 + 0.4)
        assert np.sqrt(np.mean(off**2)) > 2.0
    unchanged(answer_text(found))


@pytest.mark.parametrize(("pitch", "named"), [(10.0, 10.0), (5.0, 2.5), (None, 15.0)])
def test_a_stated_pitch_names_the_period(pitch: float | None, named: float, unchanged) -> None:
    """10 mm reads as 2.5 mm does, which is half of 5 mm; without a pitch the longest is named."""
    run = positioning(np.arange(5.0, 300.0, 6.0), 2.5, 8.0 * UM)
    if pitch is not None:
        chain = run.touches.chain.with_pitch("X", pitch)
        run = replace(run, touches=replace(run.touches, chain=chain))
    found = diagnose(run)
    confusion = found.steps[1].confusion
    assert confusion is not None
    assert confusion.alike is not None
    assert confusion.alike.pitch == pitch
    own = next(r.value for r in found.steps[1].reported if r.quantity == "period")
    assert own == pytest.approx(named, rel=2e-3)
    unchanged(answer_text(found))


def test_uneven_targets_determine_one_period() -> None:
    rng = np.random.default_rng(5)
    targets = np.sort(np.arange(5.0, 300.0, 6.0) + rng.uniform(-2.5, 2.5, 50))
    found = diagnose(positioning(targets, 2.5, 8.0 * UM))
    confusion = found.steps[1].confusion
    assert confusion is not None
    assert confusion.alike is None
    own = next(r.value for r in found.steps[1].reported if r.quantity == "period")
    assert own == pytest.approx(2.5, rel=1e-3)


@pytest.mark.parametrize(
    ("travel", "longest"), [(60.0, 30.0), (280.0, 50.0), (660.0, 110.0), (4000.0, 250.0)]
)
def test_a_long_axis_is_scanned_up_to_the_turn_of_a_pinion(travel: float, longest: float) -> None:
    """Six of a period beyond 50 mm must lie in the travel, so that it is no curve."""
    scanned = scanned_periods(np.linspace(0.0, travel, 2001))
    assert scanned[-1] == pytest.approx(longest)
    assert np.all(np.diff(scanned) > 0.0)


def test_periods_are_scanned_down_to_what_readings_resolve() -> None:
    fine = scanned_periods(np.arange(0.0, 100.0, 0.01))
    assert fine[0] == pytest.approx(0.02)
    assert fine[-1] == pytest.approx(50.0, rel=1e-3)
    uneven = scanned_periods(np.sort(np.random.default_rng(0).uniform(0.0, 60.0, 1000)))
    assert uneven[0] == pytest.approx(60.0 / 4000.0, rel=1e-2)
    # a choice of even readings stands on their grid: shorter periods look like longer ones
    rng = np.random.default_rng(0)
    chosen = np.sort(rng.choice(np.arange(0.0, 100.0, 1.0 / 120.0), 3000, replace=False))
    for scatter in (0.0, 4e-4):
        off = rng.normal(0.0, scatter, len(chosen))
        assert scanned_periods(chosen + off)[0] == pytest.approx(1.0 / 60.0, rel=1e-4)
    coarse = scanned_periods(np.arange(0.0, 300.0, 6.0))
    assert coarse[0] == pytest.approx(1.0)
    # repeated targets stand no closer for their scatter
    near = np.tile(np.arange(0.0, 300.0, 6.0), 5)
    near = near + np.random.default_rng(0).normal(0.0, 1e-3, len(near))
    assert scanned_periods(near)[0] == pytest.approx(1.0)
    # no wave longer than half the record
    assert scanned_periods(np.arange(0.0, 10.0, 0.01))[-1] == pytest.approx(5.0, rel=1e-2)
    assert np.all(np.diff(fine) > 0.0)


def test_a_stated_pitch_is_scanned_beyond_what_readings_resolve() -> None:
    q = np.arange(0.0, 300.0, 6.0)
    for k in (1, 2, 4):
        assert np.abs(scanned_periods(q, 0.8) - 0.8 / k).min() < 1e-9
    assert np.abs(scanned_periods(q) - 0.8).min() > 0.1


def test_even_step_by_hand() -> None:
    assert even_step(np.array([3.0, 9.0, 15.0, 27.0])) == pytest.approx(6.0)
    assert even_step(np.array([3.0, 9.0, 17.0, 27.0])) is None
    assert even_step(np.array([0.3, 0.1, 0.6, 0.2, 0.4])) == pytest.approx(0.1)
    assert even_step(np.array([0.3, 0.3])) is None


@pytest.mark.parametrize(
    ("period", "whole"),
    [(24.0, 1), (3.0, 8), (24.0 / 9.0, np.inf), (12.1, 2), (13.0, np.inf), (60.0, np.inf)],
)
def test_fractions_of_a_pitch_by_hand(period, whole) -> None:
    """Of 24 mm, up to the eighth, where frequencies were scanned 1/400 mm apart."""
    scanned = Inner("period", "mm", 1.0 / np.arange(0.01, 0.5, 0.0025), acts="with a period")
    assert _fraction(period, 24.0, scanned) == whole
    assert _fraction(period, None, scanned) == np.inf


def test_a_stated_pitch_is_named_though_hundreds_of_periods_explain_few_targets(unchanged) -> None:
    """Eleven uneven targets 39 mm apart: more periods do as well than can be looked at closely."""
    rng = np.random.default_rng(7)
    targets = np.round(np.linspace(5.0, 395.0, 11) + rng.uniform(-1.5, 1.5, 11), 1)
    run = positioning(targets, 10.0, 1.5 * UM, seed=2)
    chain = run.touches.chain.with_pitch("X", 10.0)
    found = diagnose(replace(run, touches=replace(run.touches, chain=chain)))
    effect = next(e for e in found.found if e.name == "periodic(EXX)")
    assert is_tunable(effect)
    assert effect.tuning["period"] == pytest.approx(10.0, rel=2e-3)
    confusion = found.steps[-1].confusion
    assert confusion is not None
    assert confusion.alike is not None
    assert confusion.alike.pitch == 10.0
    assert len(confusion.alike.periods) > 3
    unchanged(answer_text(found))


def test_the_true_period_is_named_or_listed_where_targets_are_few_and_uneven() -> None:
    """Every period is tried: eleven targets know little of a spectrum."""
    targets = np.array([3.7, 41.3, 78.2, 127.9, 161.4, 209.6, 242.1, 291.8, 328.3, 372.7, 397.9])
    found = diagnose(positioning(targets, 10.0, 2.1 * UM))
    (step,) = found.steps[1:]
    assert step.effect is not None
    (period,) = step.effect.tuning.values()
    alike = () if step.confusion.alike is None else step.confusion.alike.periods
    assert any(abs(p - 10.0) < 0.05 for p in (period, *alike))


def test_a_period_longer_than_the_scanned_ones_is_mentioned_and_none_has_an_uncertainty() -> None:
    """Eleven targets of a laser over 494 mm and a wave of 100 mm, which is not searched."""
    targets = np.array([3.0, 53.2, 101.7, 148.9, 203.1, 249.4, 301.8, 352.6, 398.3, 451.9, 497.0])
    run = positioning(targets, 100.0, 3.0 * UM)
    (step,) = diagnose(run).steps[1:]
    assert step.confusion is not None
    alike = step.confusion.alike
    assert alike is not None
    period = next(r for r in step.reported if r.quantity == "period")
    assert period.u is None
    assert max(period.value, *alike.periods) < 494.0 / 6.0
    assert any(abs(p - 100.0) < 2.0 for p in alike.beyond)

    def left(p: float) -> float:
        """Squared residual of a plain sine beside constant and slope, over that of the noise."""
        x = run.touches.reading("X")
        wave = 2.0 * np.pi * x / p
        A = np.column_stack([np.ones_like(x), x, np.sin(wave), np.cos(wave)])
        rest = run.deviation - A @ np.linalg.lstsq(A, run.deviation, rcond=None)[0]
        return float(rest @ rest) / (0.5 * UM) ** 2

    # the true one is at most as far behind as odds of 100 : 1 allow
    assert left(100.0) - left(period.value) < 2.0 * np.log(100.0)
