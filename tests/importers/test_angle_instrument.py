"""Instruments of angles: rotary tables under an autocollimator, and what they cannot feel."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.console import say
from matstd.diagnosis.answer import diagnose
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry import geometry_rows
from matstd.diagnosis.remarks import HarmonicsAlike, remarks
from matstd.diagnosis.residual import partial
from matstd.importers import (
    machine_text,
    one_axis_machine,
    positioning_run,
    read_positioning,
    read_sheet,
)
from matstd.importers.instruments import PositioningTest
from matstd.report.words import remark_sentence, verdict_sentence
from matstd.twin.effects.periodic import Harmonic
from matstd.twin.files import read_run
from matstd.twin.files.run_writer import run_text
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.machine import Axis, make_chain
from matstd.twin.model import Model
from matstd.twin.record import Instrument
from matstd.twin.units import DEG, UM, URAD
from matstd.twin.words import deviations_in

ARCSEC = DEG / 3600.0


@pytest.fixture(scope="module")
def tilting():
    """A table beside other axes, whose line stands anywhere."""
    axes = {
        "C": Axis(range=(-3.0, 3.0), point=(30.0, -20.0, 5.0)),
        "X": Axis(range=(-100.0, 100.0)),
        "Z": Axis(range=(-100.0, 100.0)),
    }
    chain = make_chain("table", "[w C' f X Z t]", axes, (10.0, 40.0, -60.0))
    angles = np.linspace(-2.9, 2.9, 9)
    whole = np.ones(len(angles), dtype=int)
    test = PositioningTest("C", angles, 2e-5 * whole, whole, whole, np.arange(len(angles)))
    return positioning_run(test, chain, 1e-3)


def test_a_table_of_angles_shows_its_first_harmonic(tmp_path):
    """It feels no eccentric clamping: the wave is the axis's own, and reversal its half."""
    angles = np.arange(0.0, 360.0, 30.0)
    wave = 4.0 * np.sin(angles * DEG + 0.4)
    rows = [f"{a},{w + 0.5:.3f},{w - 0.5:.3f}" for a, w in zip(angles, wave, strict=True)]
    text = "\n".join(["Target [deg],1 up [arcsec],1 down [arcsec]", *rows])
    (tmp_path / "table.csv").write_text(text)
    test = read_positioning(read_sheet(tmp_path / "table.csv"), "C")
    run = positioning_run(test, one_axis_machine("C", test.target), 0.5 * URAD)
    reported = {r.symbol: r for r in geometry_rows(fit_run(run, ordinary_model(run.touches.chain)))}
    assert list(reported) == ["ECC"]
    wanted = np.ptp(4.0 * np.sin(np.linspace(0.0, 330.0, 400) * DEG + 0.4)) * ARCSEC
    assert reported["ECC"].estimate.value == pytest.approx(wanted, rel=0.01)
    assert reported["ECC"].is_determined


def test_columns_are_differences_of_the_exact_chain(tilting):
    model, touches = ordinary_model(tilting.touches.chain), tilting.touches
    G, step = model.columns(touches), 1e-6
    for k, name in enumerate(model.names):
        theta = step * np.eye(len(model.parameters))[k]
        exact = (model.deviation(touches, theta) - model.deviation(touches, -theta)) / (2.0 * step)
        np.testing.assert_allclose(G[:, k], exact, atol=1e-4, err_msg=name)
    parts = [name.split("(")[1] for name in model.names]
    felt = {s[:3] for s, g in zip(parts, G.T, strict=True) if np.abs(g).max() > 1e-6}
    assert {"ECC", "EC0"} <= felt
    assert all(symbol[1] in "ABC" for symbol in felt)


def test_the_sign_is_that_of_a_zero(tilting):
    """Beyond its target by 20 µrad at every angle is a zero that adds to the reading."""
    model, touches = ordinary_model(tilting.touches.chain), tilting.touches
    theta = np.array([20.0 * URAD * (n == "location(EC0C)") for n in model.names])
    np.testing.assert_allclose(model.deviation(touches, theta), tilting.deviation, atol=1e-6)
    assert tilting.deviation == pytest.approx(-20.0 * UM)


def test_it_is_read_again_as_it_was_written(tilting, tmp_path):
    (tmp_path / "run.csv").write_text(run_text(tilting, "machine.toml"))
    again = read_run(tmp_path / "run.csv", tilting.touches.chain)
    model = ordinary_model(tilting.touches.chain)
    before, after = model.columns(tilting.touches), model.columns(again.touches)
    np.testing.assert_allclose(after, before, atol=1e-5)
    assert any("1 um is 1 urad" in remark for remark in again.remarks)


def test_a_cheap_encoder_off_by_degrees_is_read_and_its_harmonics_found(tmp_path):
    """A magnet beside its sensor: four harmonics, uneven, of 2.6 degrees; read to 0.06 degrees."""
    rng = np.random.default_rng(4)
    up = np.sort(rng.uniform(-90.0, 100.0, 50))
    encoder = np.r_[up, up[::-1] + 0.7]
    sizes, phases = [0.0, 2.0, 1.5, 0.5], rng.uniform(0.0, 6.0, 4)

    def off(at):
        waves = enumerate(zip(sizes, phases, strict=True), 1)
        return sum(a * np.sin(k * at * DEG + p) for k, (a, p) in waves)

    actual = encoder + off(encoder) + rng.normal(0.0, 0.06, len(encoder))
    rows = [f"{e:.4f},{a:.4f}" for e, a in zip(encoder, actual, strict=True)]
    (tmp_path / "joint.csv").write_text("\n".join(["encoder [deg],actual [deg]", *rows]))
    test = read_positioning(read_sheet(tmp_path / "joint.csv"), "C", named=("encoder", "actual"))
    run = positioning_run(test, one_axis_machine("C", test.target), 0.06 * DEG)
    (tmp_path / "run.csv").write_text(run_text(run, "machine.toml"))
    (tmp_path / "machine.toml").write_text(machine_text(run.touches.chain, "joint.csv", False))
    again = read_run(tmp_path / "run.csv")
    assert len(again) == len(run)
    assert np.abs(run.deviation).max() > 20.0  # mm at an arm of one metre
    result = diagnose(again)
    assert [e.name for e in result.found] == ["geometric(ECC,2-4)"]
    assert 50.0 * DEG < result.fit.test_rms < 90.0 * DEG


def test_angles_are_reported_in_their_own_unit(tilting, capsys):
    """At an arm of a metre a µm is a µrad; at another, and of lengths, it is not."""
    touches = tilting.touches
    assert touches.deviation_unit == "µrad"
    assert replace(touches, point=0.5 * touches.point).deviation_unit == "µm"
    assert replace(touches, instrument=Instrument.LASER).deviation_unit == "µm"
    with deviations_in(touches.deviation_unit):
        say("left are 3.2 µm rms")
    say("left are 3.2 µm rms")
    assert capsys.readouterr().out.splitlines() == ["left are 3.2 µrad rms", "left are 3.2 µm rms"]


def turned(targets: int, harmonic: int, seed: int = 2):
    """Three turns to and fro over even targets of a table with one wave of 30 µrad."""
    return turned_at(np.arange(targets) * 2.0 * np.pi / targets, harmonic, seed)


def turned_at(at, harmonic: int, seed: int = 2):
    """The same over any targets, rad, ascending."""
    rng, targets = np.random.default_rng(seed), len(at)
    angle = np.tile(np.concatenate([at, at[::-1]]), 3)
    way = np.tile(np.repeat([1, -1], targets), 3)
    cycle = np.repeat([1, 2, 3], 2 * targets)
    error = 30.0 * URAD * np.sin(harmonic * angle + 0.3) + rng.normal(0.0, 2.0 * URAD, len(angle))
    test = PositioningTest("C", angle, error, cycle, way, np.arange(len(angle)))
    return positioning_run(test, one_axis_machine("C", angle), 2.0 * URAD)


def test_a_worm_is_found_where_targets_resolve_it():
    found = diagnose(turned(120, 45))
    (effect,) = found.found
    assert effect.name == "periodic(ECC)"
    assert effect.tuning["harmonic"] == 45.0
    drawn = partial(found.fit, effect)
    assert drawn.driver == ("C_deg", pytest.approx(8.0))
    assert 0.0 <= drawn.x.min() < drawn.x.max() <= 8.0


def test_harmonics_that_even_targets_confuse_are_listed():
    """A harmonic of 45 at 120 targets may be one of 75, 165, 195, 285; a curve may be anything."""
    (alike,) = reported_of(turned(120, 45), "periodic(ECC)", 45.0)
    assert alike == HarmonicsAlike("C", 120, 45, (75, 165, 195, 285))
    assert "cannot distinguish harmonic 45 from 75, 165, 195 or 285" in remark_sentence(alike)
    (curve,) = reported_of(turned(12, 40), "geometric(ECC,2-4)")
    assert curve == HarmonicsAlike("C", 12, 0, ())
    assert (
        "12 evenly spaced targets per turn of C show errors that repeat more than 6 times"
        in remark_sentence(curve)
    )


def reported_of(run, name, *inner):
    """Remarks on harmonics about the ordinary model with one effect."""
    start = ordinary_model(run.touches.chain)
    effect = parse_effect(name, run.touches.chain)
    effect = effect.tuned(*inner) if inner else effect
    fit = fit_run(run, Model(start.chain, (*start.effects, effect)))
    return [r for r in remarks(fit) if isinstance(r, HarmonicsAlike)]


@pytest.mark.slow
def test_a_worm_is_found_at_uneven_targets_and_its_look_alikes_are_reported():
    """Eight uneven targets find 72 waves a turn from 2 to 400; six leave dozens that may be it."""
    (effect,) = diagnose(turned_at(uneven(8), 72)).found
    assert (effect.name, effect.tuning["harmonic"]) == ("periodic(ECC)", 72.0)
    few = diagnose(turned_at(uneven(6), 72), rng=np.random.default_rng(1))
    (step,) = few.steps[1:]
    assert 72.0 in step.confusion.alike.periods
    message = verdict_sentence(few)
    assert "it cannot be distinguished from harmonic 69, 71, 72, 73 or one of " in message
    assert "higher ones; to distinguish them, measure at C " in message
    assert "°)" in message


def uneven(targets: int):
    """Targets anywhere in a turn, rad, ascending."""
    return np.sort(np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, targets))


def test_gears_are_looked_for_where_many_poses_determine_them():
    """Waves of 12 a turn at most, felt as displacements, until 40 readings are there."""
    rng = np.random.default_rng(3)
    for readings, highest in ((30, 12.0), (60, 400.0)):
        touches = turned_at(np.sort(rng.uniform(0.0, 6.2, readings)), 50).touches
        touches = replace(touches, instrument=Instrument.TRACKER)
        (inner,) = Harmonic(touches.chain.symbol("ECC")).inner(touches)
        assert inner.grid[-1] == highest
