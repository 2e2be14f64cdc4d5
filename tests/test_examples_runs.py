"""Examples with runs of the exact simulator: what was planted is found, and READMEs quote it."""

import importlib.util
import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from unchanged import table_text

from matstd.cli import main
from matstd.twin.files import read_run
from matstd.twin.units import NM

EXAMPLES = Path(__file__).parents[1] / "examples"
CRASH, WRONG, OLD = (EXAMPLES / n for n in ("crash", "wrong_description", "machine_1995"))

COVERED = 3.0
"""Standard uncertainties within which what was planted is found."""


def module(path):
    spec = importlib.util.spec_from_file_location(f"{path.parent.name}_{path.stem}", path)
    loaded = importlib.util.module_from_spec(spec)
    sys.modules[loaded.__name__] = loaded
    spec.loader.exec_module(loaded)
    return loaded


def quoted(folder):
    """The README without line breaks."""
    return " ".join((folder / "README.md").read_text(encoding="utf-8").split())


def result(folder):
    return json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))


def quantity(rows, symbol):
    return next(row for row in rows if row["symbol"] == symbol)


@pytest.mark.parametrize(
    "maker", [CRASH / "make_runs.py", WRONG / "make_runs.py", OLD / "make_run.py"]
)
def test_the_runs_are_what_their_makers_write(maker, tmp_path):
    module(maker).write(tmp_path)
    files = sorted(p.name for p in tmp_path.glob("*.csv"))
    assert files == sorted(p.name for p in maker.parent.glob("*.csv"))
    for name in files:
        if name == "direction.csv":  # refused by the reader, as it should be
            continue
        again, stored = read_run(tmp_path / name), read_run(maker.parent / name)
        np.testing.assert_allclose(again.touches.q, stored.touches.q, atol=10 * NM)
        np.testing.assert_allclose(again.deviation, stored.deviation, atol=10 * NM)


@pytest.fixture(scope="module")
def crash(tmp_path_factory):
    out = tmp_path_factory.mktemp("crash") / "out"
    files = [str(CRASH / f"{name}.csv") for name in ("spring", "summer", "after_crash")]
    assert main(["diagnose", *files, "--auto", "--no-report", "-o", str(out)]) == 0
    return out


@pytest.mark.slow
def test_the_crash_is_reported_and_nothing_before_it(crash):
    planted = module(CRASH / "make_runs.py")
    trend = result(crash)["trend"]
    assert [run["has_changed"] for run in trend["runs"]] == [False, False, True]
    changed = {q["symbol"]: q for q in trend["quantities"] if q["has_changed_into"]}
    assert set(changed) == set(planted.CRASH)
    for symbol, unit in (("EC0Y", "urad"), ("EX0C", "um")):
        size = planted.CRASH[symbol] * (1e6 if unit == "urad" else 1e3)
        found, u = (changed[symbol][f"{key}_{unit}"][2] for key in ("change", "change_uncertainty"))
        assert abs(found - size) < COVERED * u
        assert f"by {found:.1f} ± {u:.1f}" in quoted(CRASH)
    spring, summer, after = (run["left_out_rms_um"] for run in trend["runs"])
    assert max(spring, summer) < 0.75  # the noise is 0.6 µm
    assert after > 4.0


@pytest.mark.slow
def test_the_growth_is_one_for_all_runs(crash):
    planted = module(CRASH / "make_runs.py")
    (step,) = [s for s in result(crash)["steps"] if s["effect"]]
    assert "thermal-lag(EZZ)" in [step["effect"], *step["cannot_be_told_from"]]
    size, u = step["parameters"]["amplitude_um"], step["uncertainty"]["amplitude_um"]
    assert abs(size - planted.GROWTH) < COVERED * u
    assert f"amplitude {size:.2f} ± {u:.2f} µm" in quoted(CRASH)


@pytest.mark.slow  # tests/diagnosis/test_several_runs.py begins with a model as well
def test_the_model_of_the_spring_predicts_the_crash_as_well(tmp_path):
    model, since = tmp_path / "spring", tmp_path / "since"
    first = ["diagnose", str(CRASH / "spring.csv"), "--auto", "--no-report", "-o", str(model)]
    assert main(first) == 0
    later = ["diagnose", str(CRASH / "after_crash.csv"), "--model", str(model / "model.toml")]
    assert main([*later, "--no-report", "-o", str(since)]) == 0
    found = result(since)
    assert found["verdict"] == "no missing effect"
    row = quantity(found["geometry"]["quantities"], "EC0Y")
    assert row["has_changed"]
    assert f"changed by {row['change_urad']:.1f} ± {row['change_uncertainty_urad']:.1f}" in quoted(
        CRASH
    )


NUMBERS = {"pivot": "-419.9903", "ball": "3.0006"}


@pytest.mark.parametrize(
    ("name", "mistake", "true"),
    [
        ("pivot", "point of a rotary axis", -2.0),
        pytest.param("ball", "ball radius", 0.1, marks=pytest.mark.slow),
    ],
)
def test_a_wrong_number_is_named_with_what_to_write(
    name, mistake, true, tmp_path, capsys, unchanged
):
    out = tmp_path / "out"
    assert main(["compare", str(WRONG / f"{name}.csv"), "--no-report", "-o", str(out)]) == 0
    message = " ".join(capsys.readouterr().out.split())
    table = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    (first,) = table["description_faults"]
    every = {f["mistake"]: f for f in (first, *first["cannot_be_told_from"])}
    (number,) = every[mistake]["numbers"]
    assert abs(number["change"] - true) < COVERED * number["uncertainty"]
    start = "this run cannot distinguish these" if name == "pivot" else "to copy: "
    (line,) = [t for t in message.split(" - ") if t.startswith(start) and NUMBERS[name] in t]
    assert line.strip() in quoted(WRONG)
    unchanged(table_text(table))


def test_an_axis_the_other_way_is_refused_with_the_line_to_write(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["compare", str(WRONG / "direction.csv"), "--no-report", "-o", str(out)]) == 2
    line = " ".join(capsys.readouterr().err.split())
    assert "C moves in the direction opposite to that in the machine file" in line
    copied = re.search(r"to copy: \[axis.C\] direction = \[.*?\]", line)
    assert copied[0] in quoted(WRONG)
    assert not out.exists()


@pytest.mark.parametrize(
    "only",
    [
        pytest.param(["--only", "thermal-lag", "thermal-expansion"], id="both"),
        pytest.param([], id="the library", marks=pytest.mark.slow),
    ],
)
def test_the_machine_of_1995_gives_its_errors_back(only, tmp_path, unchanged):
    planted = module(OLD / "make_run.py")
    out = tmp_path / "out"
    words = ["diagnose", str(OLD / "run.csv"), "--auto", "--no-report", "--no-learn"]
    assert main([*words, *only, "-o", str(out)]) == 0
    found = result(out)
    drift, screw = (s for s in found["steps"] if s["effect"])
    assert "thermal-lag(EZZ)" in [drift["effect"], *drift["cannot_be_told_from"]]
    assert "thermal-expansion(Y,scaleY)" in [screw["effect"], *screw["cannot_be_told_from"]]
    for step, name, true in (
        (drift, "amplitude_um", planted.DRIFT),
        (drift, "tau_min", planted.MINUTES),
        (screw, "amplitude_um_per_m_K", planted.SCREW),
    ):
        assert abs(step["parameters"][name] - true) < COVERED * step["uncertainty"][name]
    for symbol in ("EXX", "EZZ"):
        row = quantity(found["geometry"]["quantities"], symbol)
        ppm = planted.SLOPES[symbol] * 1e6
        assert abs(row["value_ppm"] - ppm) < COVERED * row["uncertainty_ppm"]
        assert f"{row['value_ppm']:.0f} ± {row['uncertainty_ppm']:.0f} ppm" in quoted(OLD)
    unchanged(table_text(found))


def test_the_jump_and_the_drift_of_the_trend_are_found_and_nothing_else():
    """15 µm between 2 and 9 February, -4 µrad a week, as make_runs.py planted them."""
    import matstd

    found = matstd.trend(EXAMPLES / "trend")
    changed = {chart.of.symbol or chart.of.quantity.value: chart for chart in found.changed}
    assert set(changed) == {"EX0C", "EC0Y", "error with the machine of the first run"}
    (step,) = changed["EX0C"].course.steps
    assert found.occasions[step.after].name == "2026-02-09"
    assert abs(step.size.value - 15.0e-3) < 3.0 * step.size.u
    rate = changed["EC0Y"].course.drift.rate
    assert abs(7.0 * rate.value + 4.0e-6) < 3.0 * 7.0 * rate.u
