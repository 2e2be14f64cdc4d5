"""Temperatures that the control's PLC hands to programs: logged with every touch, in the run."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from briefs import project_with
from programs import as_read, ran
from unchanged import folded

from matstd.artefact.brief import read_project
from matstd.probe_paths.campaign import VirtualMachine, evaluate
from matstd.probe_paths.control import read_log
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import Sensor
from matstd.probe_paths.stations import dialects_of
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run, write_run

ROOT = Path(__file__).parents[2]
SENSORS = (Sensor("spindle", 100, 1.0, 0.0), Sensor("bed", 103, 0.1, -5.0))
WORDS = replace(Dialect(), sensors=SENSORS)


@pytest.fixture(scope="module")
def made(plan):
    return make_programs(plan, WORDS)


def warm(name, now):
    """Two drifts of our own, degC at a time in s."""
    return 21.0 + now / 600.0 if name == "spindle" else 19.0 - now / 1800.0


@pytest.fixture(scope="module")
def log(made, plan):
    machine = VirtualMachine(plan.chain, temperature=warm)
    run = ran(as_read(made, plan.chain), plan.standard, machine, seed=1)
    ((_, text),) = run.log.items()
    return text, run.time[np.isfinite(run.time)]


def test_the_log_is_what_it_was(log, unchanged):
    unchanged(folded(log[0]))


def test_the_log_prints_what_the_plc_hands_over(log):
    """By the text alone: raw numbers of the parameters, and the scale in the head."""
    text, times = log
    assert "SENSOR spindle Q100 FACTOR+1.000000 OFFSET+0.000000" in text
    assert "SENSOR bed Q103 FACTOR+0.100000 OFFSET-5.000000" in text
    raw = np.array(re.findall(r"^TA *(\S+) TD *(\S+)$", text, re.MULTILINE), dtype=float)
    assert len(raw) == len(times) > 40
    # printed some tenths of a second after the trigger, when the log's block comes
    assert np.abs(raw[:, 0] - warm("spindle", times)).max() < 0.01
    assert np.abs(0.1 * raw[:, 1] - 5.0 - warm("bed", times)).max() < 0.01


def test_temperatures_are_covariates_of_the_run(log, plan, tmp_path):
    text, times = log
    run = evaluate(read_log("A.TXT", plan.chain.rotary_axes, text), plan.standard, plan.chain, 1e-3)
    write_run(tmp_path / "run.csv", run, "machine.toml")
    again = read_run(tmp_path / "run.csv", plan.chain).touches.temperature
    assert set(again) == {"spindle", "bed"}
    for name, values in again.items():
        assert np.abs(values - warm(name, times)).max() < 0.01
        assert np.ptp(values) > 0.05


def test_a_spoilt_reading_costs_no_touch(log, plan):
    text, times = log
    lines = text.splitlines()
    places = [i for i, line in enumerate(lines) if line.startswith("TA")]
    lines[places[7]] = "TA    21.1? TD   240.0"
    del lines[places[20]]
    parts = read_log("A.TXT", plan.chain.rotary_axes, "\n".join(lines) + "\n")
    run = evaluate(parts, plan.standard, plan.chain, 1e-3)
    assert len(run) == len(times)
    assert np.abs(run.touches.temperature["spindle"] - warm("spindle", times)).max() < 0.05
    output = " ".join(run.remarks)
    assert "21.1?" in output
    assert f"T_bed_degC: the control logged {len(times) - 2} of {len(times)}" in output


def _other_parameter(masks):
    return masks | {"MSPOINT.A": masks["MSPOINT.A"].replace("Q100", "Q101")}


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda t, m: (re.sub(r"\d+ ;SENSOR bed.*\r\n", "", t), m), "lines for the log"),
        (lambda t, m: (t.replace("Q103", "Q120"), m), "lines for the log|expected"),
        (lambda t, m: (t, _other_parameter(m)), "lines for the log"),
    ],
)  # fmt: skip
def test_a_sensor_that_the_head_does_not_state_is_refused(change, reason, made, plan):
    text, masks = change(made.programs[0].text, made.masks)
    bare = [re.sub(r"^\d+ ", "", line) for line in text.split("\r\n") if line]
    with pytest.raises(BadFile, match=reason):
        as_read(replace(made, masks=masks), plan.chain, text="\r\n".join(bare) + "\r\n")


@pytest.mark.parametrize(
    ("control", "keys", "reason"),
    [
        ("itnc530", 'bed = { parameter = 108 }', "temperatures.bed.parameter"),
        ("itnc530", "bed = { parameter = 100, factor = 0.0 }", "temperatures.bed.factor"),
        ("itnc530", '"b d" = { parameter = 100 }', "temperatures.b d: found 'b d'"),
        ("itnc530", "a = { parameter = 100 }\nb = { parameter = 100 }", "for each of a, b"),
        ("linuxcnc", "bed = { parameter = 100 }", "1 sensors for linuxcnc.*--sensors"),
    ],
)  # fmt: skip
def test_sensors_that_cannot_be_read_are_one_line(control, keys, reason, tmp_path):
    text = f'control = "{control}"\n[workshop.temperatures]\n{keys}\n'
    with pytest.raises(BadFile, match=reason):
        dialects_of(read_project(project_with(tmp_path, text)))


def test_sensors_of_a_project_reach_the_words(tmp_path):
    keys = 'control = "tnc640"\n[workshop.temperatures]\n'
    keys += "bed = { parameter = 103, factor = 0.1, offset = -5.0 }\n"
    (words,) = dialects_of(read_project(project_with(tmp_path, keys)))
    assert words.sensors == SENSORS[1:]
