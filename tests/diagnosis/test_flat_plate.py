"""Readings of a trigger probe are no regressors; noise that nothing shows is not believed."""

from dataclasses import replace

import numpy as np
import pytest
from flat_plate import HEIGHT, lag, write_plate
from made_up import run_of
from marks import slow
from unchanged import answer_text

from matstd.diagnosis.accuracy import repeatability
from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.answer.remainder import to_repeat
from matstd.diagnosis.laws import learn_laws
from matstd.report.words import verdict_sentence
from matstd.twin.fields import travelling_axes
from matstd.twin.files import read_run
from matstd.twin.library import parse_effect
from matstd.twin.record import with_commanded
from matstd.twin.units import UM


def test_commanded_readings_are_those_of_the_plane(tmp_path):
    """The plane stands at one height: where Z was sent is one number, whatever was measured."""
    run = with_commanded(read_run(write_plate(tmp_path, 1, noise=5.0)))
    touches = run.touches
    assert np.ptp(touches.q[:, 2]) > 20 * UM
    # the rigid motion that fits 144 touches of 5 µm noise best is what is left of it
    tilted = np.column_stack([np.ones(len(run)), touches.point[:, :2]])
    z = touches.reading("Z")
    off = z - tilted @ np.linalg.lstsq(tilted, z, rcond=None)[0]
    assert np.abs(off).max() < 1e-9
    np.testing.assert_allclose(z, HEIGHT + 103.0, atol=5 * UM)
    np.testing.assert_array_equal(touches.reading("X"), touches.q[:, 0])


@pytest.mark.parametrize(("seed", "tilt"), [(0, 0.0), (1, 1e-4), *slow((1, 0.0), (2, 5e-4))])
def test_noise_of_a_plate_is_noise(tmp_path, seed, tilt, unchanged):
    """Also of a plate that leans by 0.15 mm, over whose height fine periods were scanned."""
    result = diagnose(read_run(write_plate(tmp_path, seed, lambda x, y, t: tilt * x)))
    assert result.verdict is Verdict.NONE, verdict_sentence(result)
    unchanged(answer_text(result))


def test_a_lag_behind_a_plate_is_found(tmp_path, unchanged):
    """It was a positioning error of Z of 14 µm with p = 1e-295."""
    result = diagnose(read_run(write_plate(tmp_path, 3, lag)))
    assert result.verdict is Verdict.MISSING
    (step,) = result.steps[1:]
    assert step.effect.kind == "thermal-lag"
    reported = {r.quantity: r.value for r in step.reported}
    assert abs(reported["amplitude"] - 10.0) < 1.5  # the tip grows down, the plane is met lower
    assert abs(reported["tau"] - 5.0) < 1.5
    unchanged(answer_text(result))


def test_noise_that_nothing_shows_is_undecided(tmp_path):
    result = diagnose(read_run(write_plate(tmp_path, 5, noise=4.0)))
    assert result.verdict is Verdict.UNDECIDED
    words = verdict_sentence(result)
    assert "cannot decide" in words
    assert "no touch was repeated" in words
    lines = [str(line) for line in sorted(result.run.line[result.repeat])]
    assert len(lines) == 6
    assert all(line in words for line in lines)


def test_no_touch_is_asked_for_again_where_an_effect_is_named():
    """The noise of a backlash of 40 µm is four times the stated one; poses would be repeated."""
    x, way = np.linspace(0.0, 400.0, 40), np.where(np.arange(40) % 2, 1.0, -1.0)
    noise = np.random.default_rng(2).normal(0.0, 4.0 * UM, 40)
    run = run_of(x, 20.0 * UM * way + noise, u=UM, cycle=np.arange(40) // 8)
    run = replace(run, touches=replace(run.touches, approach=way[:, None]))
    found = diagnose(run, candidates=[parse_effect("backlash(X)", run.touches.chain)])
    assert found.verdict is Verdict.MISSING
    assert len(found.repeat) == 0
    off = np.abs(found.fit.residual)
    worst = [8 * pose + int(np.argmax(off[8 * pose : 8 * pose + 8])) for pose in range(5)]
    asked = to_repeat(found.fit, repeatability(found.fit))
    assert set(asked[:5]) == set(worst)  # the largest of each pose, then the next largest
    assert asked[5] == max(set(range(40)) - set(worst), key=lambda row: off[row])
    assert np.all(np.diff(off[asked[:5]]) < 0.0)


def test_repeats_show_the_noise(tmp_path, unchanged):
    result = diagnose(read_run(write_plate(tmp_path, 5, noise=4.0, again=2)))
    assert result.verdict is Verdict.NONE
    assert len(result.repeat) == 0
    unchanged(answer_text(result))


def test_a_step_over_a_plate_is_no_wave_of_the_axis_that_stands(tmp_path):
    """Both axes of the plate travel; Z only follows the plane through the step.

    The step was a wave of Z with a period of 3 µm, over the 7 µm by which that plane rises.
    """
    run = read_run(write_plate(tmp_path, 3, lambda x, y, t: 0.005 * (x > 0.0)))
    assert np.ptp(with_commanded(run).touches.reading("Z")) > 5 * UM
    assert travelling_axes(with_commanded(run).touches) == ["X", "Y"]
    (law,) = learn_laws(run).laws
    assert [driver.name for driver in law.law.drivers] == ["X"]
    assert "periodic" not in {effect.kind for effect in diagnose(run).found}
    leaning = read_run(write_plate(tmp_path / "leaning", 3, lambda x, y, t: 1e-3 * x))
    assert travelling_axes(with_commanded(leaning).touches) == ["X", "Y", "Z"]
