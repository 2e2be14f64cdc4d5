"""What compare and diagnose start from: the set-up alone, geometry, or a saved model."""

import json

import numpy as np
import pytest

from matstd.cli import main

BAD = 2
SCALE = 0.05
"""Micrometres a millimetre by which the axis goes too far."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A positioning test of X, four cycles up and down: 50 ppm too long, 3 um of reversal."""
    place = tmp_path_factory.mktemp("start")
    rng = np.random.default_rng(3)
    rows = [
        f"{x:g},{j},{'+' if s > 0 else '-'},{SCALE * x + 1.5 * s + rng.normal(0.0, 0.2):.4f}"
        for j in range(1, 5)
        for s in (1, -1)
        for x in np.linspace(0.0, 300.0, 11)[::s]
    ]
    (place / "x.csv").write_text("target_mm,cycle,direction,dev_um\n" + "\n".join(rows) + "\n")
    words = ["--positioning", "X", "--u-um", "0.2", "-o", str(place / "run.csv")]
    assert main(["import", str(place / "x.csv"), *words]) == 0
    return place


def result_of(folder, command, *words):
    out = folder / "out"
    name = {"diagnose": "diagnosis.json", "compare": "comparison.json"}[command]
    run = [command, str(folder / "run.csv"), "--no-report", "-o", str(out), "--force"]
    run += ["--no-learn"] if command == "diagnose" else []
    assert main([*run, *words]) == 0
    return json.loads((out / name).read_text())


def rungs(result):
    return [step["model"] for step in result["geometry"]["ladder"]]


def test_the_ladder_begins_where_the_start_is(folder):
    alone = result_of(folder, "compare", "--start", "setup")
    whole = result_of(folder, "compare", "--start", "geometry")
    assert rungs(alone) == ["set-up alone"]
    assert rungs(whole) == ["set-up alone", "geometry"]
    # 50 ppm over 300 mm: 15 um, spread evenly
    assert alone["rms_um"] == pytest.approx(np.hypot(15.0 / np.sqrt(12.0), 1.5), rel=0.1)
    assert whole["rms_um"] == pytest.approx(1.5, rel=0.05)
    assert result_of(folder, "compare")["rms_um"] == whole["rms_um"], "geometry without the option"


def test_what_a_start_lacks_is_found(folder):
    """From the set-up alone the scale is an effect like any other; from geometry it is known."""
    alone = result_of(folder, "diagnose", "--start", "setup", "--auto")
    whole = result_of(folder, "diagnose", "--auto")
    names = [step["effect"] for step in alone["steps"][1:]]
    assert "backlash(X)" in names
    assert len(names) == 2
    assert rungs(alone) == ["set-up alone", "effects"]
    assert [step["effect"] for step in whole["steps"][1:]] == ["backlash(X)"]
    assert rungs(whole) == ["set-up alone", "geometry", "effects"]
    assert alone["steps"][-1]["rms_um"] == pytest.approx(whole["steps"][-1]["rms_um"], abs=0.05)


def test_a_saved_model_is_a_start_by_either_option(folder):
    result_of(folder, "diagnose", "--auto")
    model = folder / "model.toml"
    model.write_text((folder / "out" / "model.toml").read_text())
    one = result_of(folder, "compare", "--start", str(model))
    other = result_of(folder, "compare", "--model", str(model))
    assert one == other


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["--start", "machine"], "--start machine: expected setup, geometry or a model file"),
        (["--start", "setup", "--model", "m.toml"], "beside --model m.toml"),
        (["--pitch", "Q=10"], "Q"),
        (["--pitch", "X=ten"], "an axis and its pitch in mm"),
    ],
)
@pytest.mark.parametrize("command", ["compare", "diagnose"])
def test_starts_that_are_none(folder, capsys, command, words, fault):
    out = folder / "never"
    assert main([command, str(folder / "run.csv"), *words, "-o", str(out)]) == BAD
    said = capsys.readouterr().err
    assert fault in said
    assert said.count("\n") == 1
    assert not out.exists()
