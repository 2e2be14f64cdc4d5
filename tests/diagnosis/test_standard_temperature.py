"""A standard at 25 degC, exactly simulated: scales without its temperature, with it, in doubt.

The standard grows by the simulator's own formula, true scales are its own product of matrices.
`benchmarks/standard_temperature.py` measures coverage on a hundred machines.
"""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from simulator import probe, run_text
from simulator_case import read_back
from simulator_effects import Hidden
from simulator_experiment import MACHINES, STATED_NOISE, random_experiment
from simulator_warmth import probed_warm, true_scales

from matstd.diagnosis.answer import compare
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry import Quantity, geometry_rows
from matstd.diagnosis.remarks import BodySize
from matstd.diagnosis.remarks.run_remarks import _fixing
from matstd.diagnosis.task import visits_of
from matstd.report.words import remark_sentence
from matstd.twin.files.run_writer import run_text as written
from matstd.twin.library import ordinary_model, parse_effect, proposals
from matstd.twin.model import Model
from matstd.twin.record import StatedBody, with_body

ALPHA = 10.5e-6
STATED = f"# standard = {{ expansion_1_K = {ALPHA}, expansion_u_1_K = 1e-6"
AT_25 = f"{STATED}, body_degC = 25.0, body_u_K = 0.1 }}"
UNKNOWN = f"{STATED} }}"


@pytest.fixture(scope="module")
def experiment():
    return random_experiment(np.random.default_rng(3), "hsm600u", 6)


@pytest.fixture(scope="module")
def found(experiment):
    """A function: temperature, head -> run, fit, and by name the scales with u and the truth."""

    @cache
    def made(temperature, head=""):
        run = probed_warm(experiment, np.random.default_rng(4), ALPHA, temperature, head)
        fit = fit_run(run, ordinary_model(run.touches.chain))
        truth = true_scales(experiment, run.touches[fit.used])
        rows = [r for r in geometry_rows(fit) if r.quantity is Quantity.SCALE]
        scales = {r.symbol: (r.estimate.value, r.estimate.u, truth[r.symbol]) for r in rows}
        return run, fit, scales

    return made


def test_without_its_temperature_every_scale_is_that_of_the_standard(found) -> None:
    """5 K of 10.5e-6 are 52.5 ppm, many times what the fit states."""
    _, _, scales = found(25.0)
    assert set(scales) == {"EXX", "EYY", "EZZ"}
    for value, u, truth in scales.values():
        assert abs(value - truth) == pytest.approx(52.5e-6, abs=4.0 * u)
        assert abs(value - truth) > 6.0 * u


def test_with_its_temperature_the_scales_come_back(found) -> None:
    """Those of the same touches at 20 degC, and u what expansion and thermometer leave open."""
    _, _, cold = found(20.0)
    _, _, warm = found(25.0, AT_25)
    left = np.hypot(ALPHA * 0.1, 5.0 * 1e-6)
    for name, (value, u, truth) in warm.items():
        assert abs(value - truth) < 2.0 * u
        # u of expansion and thermometer comes to it, less what is usual of the machine
        assert 0.9 * np.hypot(cold[name][1], left) < u <= 1.01 * np.hypot(cold[name][1], left)
        # the machine's usual scales draw a little on what the expansion may be
        assert value == pytest.approx(cold[name][0], abs=0.5 * left)


@pytest.mark.parametrize("temperature", [17.0, 22.5])
def test_an_unknown_temperature_is_in_the_uncertainty_of_every_scale(found, temperature) -> None:
    _, fit, scales = found(temperature, UNKNOWN)
    for value, u, truth in scales.values():
        assert abs(value - truth) < 2.0 * u
        assert 15e-6 < u < 25e-6  # 21 ppm, of which what is usual of a machine takes some
    # and one error of all: what they differ by is as certain as before
    C = fit.covariance
    rows = [r for r in geometry_rows(fit) if r.quantity is Quantity.SCALE]
    assert len(rows) == 3
    size = fit.of_effect("body-temperature")
    assert np.sqrt(C[size, size][0, 0]) > 1.0


def test_what_is_said_beside_the_scales(found) -> None:
    """Sizes by hand: 52.5 ppm of growth; 1.05 and 5 ppm of u, or 21 where nothing is known."""
    message = {}
    for head in ("", AT_25, UNKNOWN):
        run, *_ = found(25.0, head)
        (size,) = [
            r
            for r in compare(run[::3], ordinary_model(run.touches.chain)).remarks
            if isinstance(r, BodySize)
        ]
        corners = np.ptp(run.touches.point[::3], axis=0)
        assert size.length == pytest.approx(np.sqrt(np.sum(corners**2)))
        message[head] = size, remark_sentence(size)
    assert message[AT_25][0].strain == pytest.approx(52.5e-6)
    assert message[AT_25][0].u == pytest.approx(np.hypot(1.05e-6, 5e-6))
    assert "was at 25.0 ± 0.1 °C: its growth of +52.5 ppm" in message[AT_25][1]
    assert message[UNKNOWN][0].u == pytest.approx(21e-6)
    assert (
        "20 ± 2 °C is assumed, which leaves a standard uncertainty of 21.0 ppm"
        in message[UNKNOWN][1]
    )
    assert "scales hold for a standard at 20 °C" in message[""][1]


def test_nothing_is_corrected_twice(found) -> None:
    """Growth by the sensor that is taken off is no candidate any more; by another it still is."""
    run, *_ = found(25.0)
    sensors = {**run.touches.temperature, "body": run.touches.temperature["artefact"] + 1.0}
    run = replace(run, touches=replace(run.touches, temperature=sensors))
    before, after = (
        {e.name for e in proposals(one.touches) if e.kind == "artefact-expansion"}
        for one in (run, with_body(run, StatedBody(ALPHA)))
    )
    assert before - after == {"artefact-expansion(body)"}
    assert "artefact-expansion(artefact)" in after


def test_what_the_size_leaves_open_is_in_the_budget_of_a_task(experiment) -> None:
    """It is shared by all visits, and by hand alpha dT and dalpha (T - 20) of every place."""
    runs = [probed_warm(experiment, np.random.default_rng(k), ALPHA, 25.0, AT_25) for k in range(2)]
    faces = [np.isin(r.touches.feature, ["pad0", "pad1", "pad2", "pad3"]) for r in runs]
    none = np.zeros((len(runs[0]), 0))
    visits = visits_of(runs, faces, [~f for f in faces], none)
    assert visits.shared.shape[1] == 2
    # both are one scale of the standard, 0.1 K of it and 1e-6 1/K at 5 K
    assert visits.shared[:, 1] == pytest.approx(visits.shared[:, 0] * 5e-6 / (ALPHA * 0.1))
    bare = [probed_warm(experiment, np.random.default_rng(k), ALPHA, 25.0) for k in range(2)]
    assert visits_of(bare, faces, [~f for f in faces], none).shared.shape[1] == 0


def test_a_standard_expands_from_where_it_is_held() -> None:
    """Held 280 mm beside the middle of the table: ``x = f + (1 + g)(x_0 - f)``, simulated exactly.

    Stated, the point gives the coefficient back; without it the movement of the whole standard,
    4 um a kelvin, is left over. It is read and written.
    """
    rng, held = np.random.default_rng(7), (280.0, 0.0, 0.0)
    e = random_experiment(rng, "hsm600u", 6)
    at = np.stack([(T @ [*held, 1.0])[:3] for T in e.actual])[e.setup]

    def act(state, amplitude):
        growth = amplitude * 1e-6 * (state.temperature["artefact"] - 20.0)
        return {"growth": growth, "shift": -growth[:, None] * at}

    hidden = Hidden("artefact-expansion(artefact)", "artefact-expansion", act)
    hidden.amplitude = 15.0
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    text = run_text(e, probe(e, [hidden], noise), False)
    stated = re.sub(r"(# \[setup\.\w+\]\n)", rf"\1# fixing_mm = {list(held)}\n", text)
    runs = [read_back(one, MACHINES["hsm600u"]) for one in (text, stated)]
    effect = parse_effect("artefact-expansion(artefact)", runs[0].touches.chain)
    fits = [
        fit_run(run, Model(run.touches.chain, (*ordinary_model(run.touches.chain).effects, effect)))
        for run in runs
    ]
    alpha, u = fits[1].theta[fits[1].of_effect(effect.name)][0], fits[1].spread
    own = float(np.linalg.norm(u[fits[1].of_effect(effect.name)]))
    assert alpha == pytest.approx(15e-6, abs=3.0 * own)
    assert fits[1].rms < 0.96 * fits[0].rms
    assert [bool(_fixing(fit)) for fit in fits] == [True, False]
    assert "fixing_mm = [280.0, 0.0, 0.0]" in written(runs[1], "m.toml")
