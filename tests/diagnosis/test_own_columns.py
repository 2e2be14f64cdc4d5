"""Columns of the user's own as drives: found with a lag, in fields, kept by a model file."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import gauge_touches
from scipy.integrate import solve_ivp
from unchanged import answer_text

from matstd.diagnosis.answer import compare, diagnose
from matstd.diagnosis.choice import candidate_effects
from matstd.diagnosis.choice.field import sized_field
from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.files import model_text, read_model
from matstd.diagnosis.fit import Prior
from matstd.diagnosis.search import DiagnosisTask
from matstd.report.words import values
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.record import Run
from matstd.twin.units import MINUTE, UM

N = 150
TAU = 25.0 * MINUTE
PER_BAR = -0.8
"""What Z grows by after a bar of coolant pressure, µm."""


@pytest.fixture(scope="module")
def run() -> Run:
    """A dial gauge along Z for five hours; coolant of 20 to 60 bar, which a column bends under."""
    rng = np.random.default_rng(6)
    time = 120.0 * np.arange(N) + rng.uniform(0.0, 30.0, N)
    pressure = 40.0 + 20.0 * np.sin(time / 2700.0) * np.cos(time / 7000.0)
    y = solve_ivp(
        lambda t, y: (np.interp(t, time, pressure) - y) / TAU,
        (time[0], time[-1]),
        [pressure[0]],
        t_eval=time,
        max_step=30.0,
        rtol=1e-8,
    ).y[0]
    touches = gauge_touches(time, value={"coolant_bar": pressure})
    # Z longer on the tool side: a surface that looks up seems to stand lower
    deviation = -PER_BAR * (y - 40.0) + rng.normal(0.0, 0.5, N)
    return Run(touches, deviation * UM, np.full(N, 0.5 * UM))


def test_a_lag_after_an_own_column_is_found_with_its_size(run, tmp_path, unchanged) -> None:
    kinds = ("thermal-lag", "follows", "thermal-field")
    result = diagnose(
        run, candidates=[e for e in candidate_effects(run.touches) if e.kind in kinds]
    )
    assert [e.name for e in result.found] == ["thermal-lag(EZZ,V_coolant_bar)"]
    reported = {r.name: r for r in result.steps[-1].reported}
    assert abs(reported["tau_min"].value - TAU / MINUTE) < 3.0 * reported["tau_min"].u
    assert reported["tau_min"].u < 3.0
    step = result.found[0].tuning["step"]
    assert step == 10.0
    assert values(result.steps[-1])[0][1].endswith(" µm per step of 10")
    assert abs(reported["amplitude_um"].value - PER_BAR * step) < 3.0 * reported["amplitude_um"].u
    (tmp_path / "model.toml").write_text(model_text(result.fit, "run.csv"), encoding="utf-8")
    saved = read_model(tmp_path / "model.toml")
    assert [e.tuning["step"] for e in saved.model.effects if e.kind == "thermal-lag"] == [step]
    higher = {"coolant_bar": 10.0 * run.touches.value["coolant_bar"]}
    # the same pressure in another spread, as another day has: what is predicted goes with it
    other = replace(run.touches, value=higher)
    lag = next(e for e in saved.model.effects if e.kind == "thermal-lag")
    np.testing.assert_allclose(lag.response(other), 10.0 * lag.response(run.touches))
    again = compare(run, saved.model, saved.estimates)
    assert again.rms < 1.1 * result.fit.rms
    unchanged(answer_text(result))


def test_a_field_of_own_columns_predicts_what_a_lag_between_its_own_does(run) -> None:
    """No lag of the field is that of the machine; those around it stand in for it together."""
    start = ordinary_model(run.touches.chain)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    gross = replace(task.fit().gross, rows=np.zeros(N, dtype=bool))
    warm = next(e for e in candidate_effects(run.touches) if e.kind == "thermal-field")
    assert warm.name == "thermal-field(Z,V_coolant_bar)"
    groups = np.array_split(np.arange(N), 5)
    sized = sized_field(task, gross, warm, groups)
    held = np.arange(N) % 30 < 10
    split = np.where(held, "test", "train").astype("U5")
    part = replace(task, run=replace(run, split=split))
    fit = part.fit((sized,), gross)
    assert np.sqrt(np.mean(fit.residual[held] ** 2)) < 0.8 * UM
    assert np.sqrt(np.mean(part.fit((), gross).residual[held] ** 2)) > 4.0 * UM


def test_a_field_of_own_columns_keeps_its_steps_in_a_model_file(run, tmp_path) -> None:
    start = ordinary_model(run.touches.chain)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    warm = next(e for e in candidate_effects(run.touches) if e.kind == "thermal-field")
    bare = parse_effect(warm.name, run.touches.chain)
    assert (bare.steps, warm.steps) == ((1.0,), (10.0,))
    (tmp_path / "model.toml").write_text(
        model_text(task.fit((ScaledEffect(warm),)), "run.csv"), encoding="utf-8"
    )
    assert warm in read_model(tmp_path / "model.toml").model.effects
