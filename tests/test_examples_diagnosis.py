"""The examples of diagnosis run, and find what is known to be there; their READMEs quote them."""

import gzip
import importlib.util
import io
import json
import re
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np
import pytest

from matstd.cli import main
from matstd.diagnosis.answer import diagnose
from matstd.twin.files import read_run, write_run
from matstd.twin.units import NM, UM

EXAMPLES = Path(__file__).parents[1] / "examples"
THERMAL, HIDDEN = EXAMPLES / "fl_thermal", EXAMPLES / "hidden_effect"

NOISE = 0.6  # of the simulated runs, µm
NEAR_NOISE = 1.05  # what a model leaves over the noise, once the effect is in
NEAR = 1.12  # error of another run over the noise: 160 parameters of 780 touches add 10 %, or less
COVERED = 3.0  # standard uncertainties within which a planted size is found
HALF_DIGIT = 5e-4  # µm: the thinned record has three decimals


def module(path: Path):
    """A file of the examples as a module."""
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    loaded = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = loaded
    spec.loader.exec_module(loaded)
    return loaded


def matstd(*arguments: object) -> str:
    """Run the command in the folder of the example; its words."""
    words, errors = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(words), redirect_stderr(errors):
        patch.chdir(HIDDEN)
        patch.setenv("COLUMNS", "96")
        assert main([str(one) for one in arguments]) == 0, errors.getvalue()
    return words.getvalue()


def result(folder: Path) -> dict:
    return json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))


def truth(name: str) -> dict:
    return json.loads((HIDDEN / f"{name}_truth.json").read_text(encoding="utf-8"))


# a warm-up that the library knows


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(["--only", "thermal-lag", "backlash"], id="narrow"),
        pytest.param([], id="the library", marks=pytest.mark.slow),
    ],
)
def warm_up(request, tmp_path_factory):
    """Words and result of the command, and the model with what it found."""
    out = tmp_path_factory.mktemp("warm_up") / "out"
    quiet = ["--auto", "--no-report", "--no-learn", *request.param]
    words = matstd("diagnose", "warm_up.csv", *quiet, "-o", out)
    return words, result(out), out / "model.toml"


def test_the_warm_up_is_named_and_the_error_falls_to_the_noise(warm_up):
    words, found, _ = warm_up
    (hidden,) = truth("warm_up")["hidden"]
    first, last = found["steps"][0], found["steps"][-1]
    assert found["verdict"] == "missing effect"
    assert len(found["steps"]) == 2
    assert hidden["effect"] in [last["effect"], *last["cannot_be_told_from"]]
    size, u = last["parameters"]["amplitude_um"], last["uncertainty"]["amplitude_um"]
    assert abs(size - hidden["amplitude"]) < COVERED * u
    tau, u = last["parameters"]["tau_min"], last["uncertainty"]["tau_min"]
    assert abs(tau - hidden["inner"]["tau_min"]) < COVERED * u
    assert first["test_rms_um"] > 1.5 * NOISE
    assert last["test_rms_um"] < NEAR * NOISE
    assert f"[{last['effect']} or one of {len(last['cannot_be_told_from'])} more]" in words
    row = f"growth along Z .* {last['rms_um']:.3f} .* {last['test_rms_um']:.3f} "
    assert re.search(re.escape(row).replace(r"\ \.\*\ ", ".*"), words)


def test_all_chips_of_the_warm_up_are_reported_by_line(warm_up):
    words, _, _ = warm_up
    text = (HIDDEN / "warm_up.csv").read_text(encoding="utf-8").splitlines()
    head = next(i for i, line in enumerate(text) if not line.startswith("#"))
    chips = {head + 2 + row for row in truth("warm_up")["chips"]}  # lines count from 1
    stated = re.search(r"gross errors were left out.*?lines ([\d, \n]+)", words, re.DOTALL)
    assert {int(n) for n in stated.group(1).replace("\n", " ").split(",")} == chips


def test_the_model_with_the_effect_leaves_noise(warm_up, tmp_path):
    _, found, model = warm_up
    matstd("compare", "warm_up.csv", "--model", model, "--no-report", "-o", tmp_path / "c")
    left = json.loads((tmp_path / "c" / "comparison.json").read_text(encoding="utf-8"))
    assert left["depends_on"] == []
    assert left["rms_um"] < NEAR_NOISE * NOISE
    assert found["steps"][0]["rms_um"] > left["rms_um"]


# a hose that no library knows


@pytest.mark.slow
def test_the_hose_is_unexplained_and_seen_where_it_is(tmp_path):
    matstd("diagnose", "hose.csv", "--no-report", "-o", tmp_path / "out")
    found = result(tmp_path / "out")
    assert found["verdict"] == "unexplained"
    assert {d["variable"] for d in found["depends_on"]} >= {"X_mm", "Y_mm"}


@pytest.mark.slow  # `diagnosis/test_files_and_commands` has an effect of the user's own
def test_the_users_own_effect_explains_the_hose(tmp_path):
    own = ["--effects", EXAMPLES / "my_effects.py", "--only", "hose", "backlash", "thermal-lag"]
    words = ["--auto", "--no-report", "--no-learn", "-o", tmp_path / "out"]
    matstd("diagnose", "hose.csv", *own, *words)
    found = result(tmp_path / "out")
    (hidden,) = truth("hose")["hidden"]
    assert found["verdict"] == "missing effect"
    step = found["steps"][-1]
    assert [s["effect"] for s in found["steps"]] == [None, "hose"]
    planted = {"lift_um": hidden["amplitude"], "x_mm": 35.0, "width_mm": 40.0}
    for name, value in planted.items():
        assert abs(step["parameters"][name] - value) < COVERED * step["uncertainty"][name]
    assert step["test_rms_um"] < NEAR * NOISE


@pytest.mark.slow
def test_the_page_shows_the_formula_of_the_users_own_effect(tmp_path):
    own = ["--effects", EXAMPLES / "my_effects.py"]
    matstd("diagnose", "hose.csv", *own, "--auto", "-o", tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "EZZ = a exp(-((X - x)/width)^2) for Y &gt; y" in page


def test_a_users_effect_is_a_page_of_code():
    text = (EXAMPLES / "my_effects.py").read_text(encoding="utf-8")
    body = text.split("class Hose")[1].split("HOSE = Kind")[0]
    assert len([line for line in body.splitlines() if line.strip()]) <= 30


def test_the_runs_are_what_their_maker_writes(tmp_path):
    maker = module(HIDDEN / "make_runs.py")
    maker.write("hose", tmp_path)
    again, stored = read_run(tmp_path / "hose.csv"), read_run(HIDDEN / "hose.csv")
    np.testing.assert_allclose(again.touches.q, stored.touches.q, atol=10 * NM)
    np.testing.assert_allclose(again.deviation, stored.deviation, atol=10 * NM)


# a real spindle


def test_the_spindle_run_is_the_record(tmp_path):
    make_run = module(THERMAL / "make_run.py")
    run = make_run.spindle_run()
    with gzip.open(THERMAL / "fl_thermal_1min.csv.gz", "rt", encoding="utf-8") as file:
        data = np.genfromtxt(file, delimiter=",", names=True)
    assert len(data) == 2779
    assert len(run) == 5 * len(range(make_run.FIRST, 2779, make_run.EVERY))
    instant = data[make_run.FIRST + 7 * make_run.EVERY]
    rows = slice(35, 40)
    np.testing.assert_array_equal(run.touches.time[rows], instant["time_s"])
    readings = [instant[f"ch{i}_um"] for i in range(1, 6)]
    np.testing.assert_allclose(run.deviation[rows] / UM, readings, atol=HALF_DIGIT)
    np.testing.assert_allclose(run.touches.temperature["t16"][rows], instant["t16_degC"])
    np.testing.assert_allclose(run.touches.spindle_rpm[rows], instant["spindle_rpm"])
    hours = run.touches.time / 3600.0
    np.testing.assert_array_equal(run.split == "test", hours >= 32.13)
    assert set(run.touches.pose[run.split == "train"]) == {0, 1, 2, 3}

    write_run(tmp_path / "run.csv", run, str(THERMAL / "spindle.toml"))
    again = read_run(tmp_path / "run.csv")
    np.testing.assert_allclose(again.deviation, run.deviation, atol=NM)
    np.testing.assert_array_equal(again.split, run.split)


@pytest.mark.slow
def test_thermal_memory_is_found_in_the_spindle_and_halves_the_held_out_error():
    """What is found does not rest on the sampling: here a row in 25 minutes instead of five."""
    make_run, warm_body = module(THERMAL / "make_run.py"), module(THERMAL / "warm_body.py")
    before_after = module(THERMAL / "before_after.py")
    run = make_run.spindle_run(every=25)
    found = diagnose(run, candidates=list(warm_body.propose(run.touches)))
    names = [e.name for e in found.found]
    assert "warm-body(C1,spindle_rpm)" in names
    assert "warm-body(C1,t4)" in names
    errors = list(before_after.held_out(found).values())
    together = [float(np.sqrt(np.mean(np.square(e)))) for e in errors]
    assert together[-1] < 0.5 * together[0]
    simple = before_after.SIMPLE_FITS["... and one temperature"]
    assert together[-1] < float(np.sqrt(np.mean(np.square(simple))))
    # the constant of the data's own table, which holds for every minute of the record
    np.testing.assert_allclose(errors[0], before_after.SIMPLE_FITS["constant"], rtol=0.02)


def test_the_licence_goes_with_the_data():
    text = (THERMAL / "LICENSE").read_text(encoding="utf-8")
    assert "MIT License" in text
    assert "CAIVIAC" in text
    readme = (THERMAL / "README.md").read_text(encoding="utf-8")
    assert "CAIVIAC/FL_THERMAL" in readme


@pytest.mark.slow
def test_the_commands_of_the_spindle_say_what_the_readme_quotes(tmp_path):
    subprocess.run([sys.executable, THERMAL / "make_run.py", tmp_path / "run.csv"], check=True)
    (tmp_path / "spindle.toml").write_text((THERMAL / "spindle.toml").read_text())
    own = ["--effects", THERMAL / "warm_body.py"]
    words = matstd("diagnose", tmp_path / "run.csv", *own, "--auto", "-o", tmp_path / "out")
    readme = (THERMAL / "README.md").read_text(encoding="utf-8")
    for step in result(tmp_path / "out")["steps"][1:]:
        assert step["effect"] in readme  # a console of 120 letters breaks the row of a field
        assert f"with effects {step['test_rms_um']:.2f} µm" in words
        assert f"with effects {step['test_rms_um']:.2f} µm" in readme


@pytest.mark.slow
def test_the_python_of_the_readme_runs_as_it_stands(tmp_path, capsys, monkeypatch):
    text = (EXAMPLES.parent / "README.md").read_text(encoding="utf-8")
    code = text.split("## Use it from Python")[1].split("```python\n")[1].split("```")[0]
    (tmp_path / "examples").symlink_to(EXAMPLES)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "README.md", "exec"), {})
    found, compared = capsys.readouterr().out.splitlines()
    assert found.startswith("The model lacks one effect: growth along Z after switching on (")
    assert found in " ".join(text.split())  # as the command says it, some pages before
    assert compared.endswith("The residual looks like noise.")
    assert (tmp_path / "diagnosis" / "model.toml").is_file()
    assert (tmp_path / "tables" / "iso230" / "iso230.csv").is_file()
