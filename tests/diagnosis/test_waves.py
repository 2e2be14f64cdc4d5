"""Waves in time: found with their period, and never at the interval of the readings."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.evidence import EffectSet, ResidualSpace
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.residual.patterns import thinned
from matstd.diagnosis.residual.waves import best_wave
from matstd.twin.library import ordinary_model
from matstd.twin.units import UM

KEY = (1, "hmc1995")


def best(run):
    fit = fit_run(run, ordinary_model(run.touches.chain))
    complement = ResidualSpace.of(fit)
    nothing = EffectSet(complement, np.zeros((len(complement.residual), 0)))
    return best_wave(nothing, run.touches, thinned(complement))


def test_a_pump_is_found_with_its_period(case) -> None:
    run = case(*KEY).run
    pumped = run.deviation + 2.0 * UM * np.sin(2.0 * np.pi * run.touches.time / 311.0)
    wave = best(replace(run, deviation=pumped))
    assert wave.period == pytest.approx(311.0, rel=0.01)
    assert wave.p_value < 1e-9


def test_rows_at_one_time_have_no_wave_faster_than_two_of_their_steps(case) -> None:
    """Eight rows every twenty minutes: a wave of twenty minutes looks like a constant there."""
    run = case(*KEY).run
    step = 1200.0
    touches = replace(run.touches, time=step * (np.arange(len(run)) // 8))
    rng = np.random.default_rng(1)
    slow = 2.0 * UM * np.sin(2.0 * np.pi * touches.time / (5.0 * step))
    noise = rng.normal(0.0, 0.6 * UM, len(run))
    wave = best(replace(run, touches=touches, deviation=run.deviation + slow + noise))
    assert wave.period == pytest.approx(5.0 * step, rel=0.02)
