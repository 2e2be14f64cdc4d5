"""Files of a diagnosis as the contract states them, and the commands on good and on bad input."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from run_text import every
from simulator_case import simulate_case
from unchanged import table_text

from matstd.cli import main
from matstd.diagnosis.files import model_text, read_model
from matstd.diagnosis.fit import fit_run, unit_mistake
from matstd.diagnosis.remarks import remarks
from matstd.report.words import remark_sentence
from matstd.twin.library import ordinary_model
from matstd.twin.record import without_copies
from matstd.twin.units import NM

NUMBER = (int, float)
QUICK = ["--no-report", "--no-learn"]
"""Neither a page nor a law of what remains, which have tests of their own."""

DIGITS = 2e-6
"""Numbers in json files have six significant digits."""

STEP = {"effect", "kind", "parameters", "uncertainty", "p_value", "rms_um", "test_rms_um"}
STEP |= {"chi2_ratio", "cannot_be_told_from"}
KEYS = {
    "candidates": {"effect", "kind", "p_value", "rms_um", "test_rms_um"},
    "where": {"region", "error", "mean_um", "mean_u_um", "rms_um", "touches"},
    "depends_on": {"variable", "p_value"},
    "next_measurement": {"tells_apart", "touches"},
}
HOSE = """
from dataclasses import dataclass
from matstd.twin.model import Parameter, Term, Where
from matstd.twin.model import Kind

@dataclass(frozen=True)
class Hose:
    name = kind = "tested-hose"
    parameters = (Parameter("lift", "mm", 0.01),)

    def terms(self, touches):
        push = 1.0 * (touches.reading("Y") > 0.0)
        return (Term(0, Where("twist", touches.chain.link_index("Z"), 2), push),)

KIND = Kind("tested-hose", "", "EZZ = a for Y > 0", "a: µm", "some µm", "seen",
            lambda chain, arguments: Hose(), lambda touches: (Hose(),), (Hose,))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run with a hidden reversal of Y, and its machine."""
    place = tmp_path_factory.mktemp("run")
    run, machine, _ = simulate_case(
        np.random.default_rng(21), "hmc1995", ("backlash(Y)",), with_alike=False
    )
    (place / "run.csv").write_text(every(2, run), encoding="utf-8")
    (place / "machine.toml").write_text(machine, encoding="utf-8")
    return place


@pytest.fixture
def changed(folder, tmp_path):
    """A function (change of rows) that writes the run so changed; its path."""

    def write(change):
        lines = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
        n = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        columns = lines[n].split(",")
        rows = [dict(zip(columns, line.split(","), strict=True)) for line in lines[n + 1 :]]
        rows = change(rows)
        table = [",".join(rows[0]), *(",".join(row.values()) for row in rows)]
        (tmp_path / "run.csv").write_text("\n".join([*lines[:n], *table]) + "\n")
        (tmp_path / "machine.toml").write_text((folder / "machine.toml").read_text())
        return str(tmp_path / "run.csv")

    return write


# diagnosis.json


@pytest.fixture(scope="module")
def warmed(tmp_path_factory):
    """What the command writes of a run with a lag, which has rivals and thus a next measurement."""
    place = tmp_path_factory.mktemp("warmed")
    run, machine, _ = simulate_case(
        np.random.default_rng(5), "hsm600u", ("thermal-lag(EXC)",), with_alike=False
    )
    (place / "run.csv").write_text(run, encoding="utf-8")
    (place / "machine.toml").write_text(machine, encoding="utf-8")
    words = ["diagnose", str(place / "run.csv"), "-o", str(place / "out"), *QUICK]
    assert main([*words, "--only", "thermal-lag", "backlash", "periodic(EXX)"]) == 0
    return place


@pytest.fixture(scope="module")
def table(warmed):
    """Its diagnosis.json."""
    return json.loads((warmed / "out" / "diagnosis.json").read_text(encoding="utf-8"))


def test_keys_and_types_are_those_of_the_contract(table) -> None:
    assert list(table) == [
        "format",
        "touches",
        "u_um",
        "verdict",
        "headline",
        "parts",
        "repeatability",
        "promise",
        "promise_before",
        "policy",
        "steps",
        "candidates",
        "nearest",
        "repeat_lines",
        "where",
        "depends_on",
        "detectable",
        "next_measurement",
        "geometry",
        "description_faults",
        "remarks",
    ]
    assert table["format"] == "diagnosis/1"
    assert table["touches"] == 780
    assert table["u_um"] == pytest.approx(0.6, rel=DIGITS)
    assert table["verdict"] == "missing effect"
    for name, keys in KEYS.items():
        assert table[name], name
        for entry in table[name]:
            assert set(entry) == keys, name


def test_steps_of_the_contract(table) -> None:
    first, step = table["steps"]
    assert set(first) == {"effect", "rms_um", "test_rms_um", "chi2_ratio"}
    assert first["effect"] is None
    assert set(step) == STEP
    assert step["kind"] == "thermal-lag"
    assert set(step["parameters"]) == {"tau_min", "amplitude_um"}
    assert set(step["uncertainty"]) <= set(step["parameters"])
    assert all(isinstance(v, NUMBER) for v in step["parameters"].values())
    assert 0.0 <= step["p_value"] < 1e-6
    names = [step["effect"], *step["cannot_be_told_from"]]
    assert "thermal-lag(EXC)" in names
    assert len(set(names)) == len(names)
    assert step["rms_um"] < first["rms_um"]


def test_limits_and_regions_of_the_contract(table) -> None:
    """A length has its size in smallest_um alone; anything else beside it in its own unit."""
    for entry in table["detectable"]:
        assert {"effect", "smallest_um"} <= set(entry)
        sizes = {k: v for k, v in entry.items() if k not in ("effect", "scanned")}
        assert len(sizes) <= 2
        assert all(v is None or v > 0.0 for v in sizes.values())
    by_name = {e["effect"]: set(e) for e in table["detectable"]}
    scanned = {e["effect"]: e.get("scanned") for e in table["detectable"]}
    (scan,) = scanned["periodic(EXX)"].values()  # up to a sixth of the travel that was probed
    assert scan == pytest.approx([1.0, 65.0], rel=1e-3)
    assert scanned["backlash(X)"] is None
    assert by_name["backlash(X)"] == {"effect", "smallest_um"}
    assert by_name["backlash(B)"] == {"effect", "smallest_um", "smallest_urad"}
    assert all(0 < w["touches"] <= 780 and w["region"] for w in table["where"])
    assert "time_s" in [d["variable"] for d in table["depends_on"] if d["p_value"] < 1e-20]
    for region in table["where"]:
        keys = {k.removesuffix("_um").removesuffix("_urad"): v for k, v in region["error"].items()}
        assert set(keys) == {"carrier", "size", "uncertainty", "cannot_be_told_from"}
        assert abs(keys["size"]) > 3.0 * keys["uncertainty"] > 0.0
    assert max(w["rms_um"] for w in table["where"]) > table["u_um"]


def test_next_measurement_is_a_run_plan(table, case) -> None:
    """Touches with the columns of a run file, within the travels, on points that are known."""
    run = case(5, "hsm600u", ("thermal-lag(EXC)",)).run
    (plan,) = table["next_measurement"]
    assert len(plan["tells_apart"]) == 2
    assert plan["touches"]
    known = np.round(run.touches.point, 6)
    for touch in plan["touches"]:
        assert list(touch)[:4] == ["feature", "setup", "pose", "time_s"]
        for axis, unit in zip("XYZBC", ("mm", "mm", "mm", "deg", "deg"), strict=True):
            low, high = run.touches.chain.link(axis).range
            scale = 1.0 if unit == "mm" else np.pi / 180.0
            assert low - NM <= touch[f"{axis}_{unit}"] * scale <= high + NM
        point = [touch[f"p{c}_mm"] for c in "xyz"]
        assert np.min(np.linalg.norm(known - point, axis=1)) < 2.0 * NM
        normal = [touch[f"n{c}"] for c in "xyz"]
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-8)
    times = [touch["time_s"] for touch in plan["touches"]]
    assert times == sorted(times)


# model.toml


@pytest.fixture(scope="module")
def saved(fitted, tmp_path_factory):
    fit = fitted(1, "hmc1995")
    path = tmp_path_factory.mktemp("model") / "model.toml"
    path.write_text(model_text(fit, "run.csv"), encoding="utf-8")
    return fit, path


def test_the_files_are_what_they_were(saved, table, unchanged) -> None:
    model = re.sub(r"(?m)^  \[.*\n", "", saved[1].read_text(encoding="utf-8"))  # no covariances
    unchanged("\n".join([model, table_text(table)]))


def test_a_model_read_back_predicts_the_same(saved, case) -> None:
    fit, path = saved
    again = read_model(path)
    assert again.source.touches == len(fit.run)
    assert [e.name for e in again.model.effects] == [e.name for e in fit.model.effects]
    P = len(fit.model.parameters)
    touches = case(22, "hmc1995").run.touches  # another run altogether
    before = fit.model.columns(touches)
    after = again.model.columns(touches)
    np.testing.assert_allclose(after @ again.estimates.mean, before @ fit.theta[:P], atol=0.01 * NM)
    u_before = np.sqrt(np.einsum("np,pq,nq->n", before, fit.covariance[:P, :P], before))
    u_after = np.linalg.norm(after @ again.estimates.root, axis=1)
    np.testing.assert_allclose(u_after, u_before, rtol=1e-4)


# matstd compare


def test_compare_writes_what_the_model_leaves(folder, tmp_path, capsys) -> None:
    out = tmp_path / "out"
    assert main(["compare", str(folder / "run.csv"), "-o", str(out), "--no-report"]) == 0
    assert "The residual is not noise" in " ".join(capsys.readouterr().out.split())
    stated = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert stated["format"] == "comparison/1"
    assert stated["rms_um"] < stated["measured_rms_um"]
    assert stated["chi2_ratio"] > 1.1
    assert sorted(p.name for p in out.iterdir()) == ["comparison.json", "residuals.csv"]
    rows = (out / "residuals.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == stated["touches"] + 1
    names = rows[0].split(",")
    numbers = [dict(zip(names, row.split(","), strict=True)) for row in rows[1:]]
    residual = np.array([float(r["residual_um"]) for r in numbers])
    for r, left in zip(numbers, residual, strict=True):
        # each of the three is rounded to 0.0001 um
        assert float(r["measured_um"]) - float(r["predicted_um"]) == pytest.approx(left, abs=2e-4)
    kept = np.array([r["gross_error"] == "0" for r in numbers])
    assert np.sqrt(np.mean(residual[kept] ** 2)) == pytest.approx(stated["rms_um"], abs=2e-4)


def test_compare_with_a_model_of_the_same_machine(folder, tmp_path) -> None:
    """Learnt from one half of the poses, it predicts the other to noise and uncertainty."""
    lines = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    columns, *rows = lines[len(head) :]
    place = columns.split(",").index("pose")
    for name, part in (("a", 0), ("b", 1)):
        kept = [r for r in rows if int(r.split(",")[place]) % 2 == part]
        (tmp_path / f"{name}.csv").write_text("\n".join([*head, columns, *kept]) + "\n")
    (tmp_path / "machine.toml").write_text((folder / "machine.toml").read_text())
    a, b, m, c = (str(tmp_path / n) for n in ("a.csv", "b.csv", "m", "c"))
    add = ["--add", "backlash(Y)", "--only", "backlash"]
    assert main(["diagnose", a, *add, "-o", m, *QUICK]) == 0
    assert main(["compare", b, "--model", f"{m}/model.toml", "-o", c, "--no-report"]) == 0
    stated = json.loads((tmp_path / "c" / "comparison.json").read_text(encoding="utf-8"))
    # 1 within 4 deviations of 390 squares, which share the errors of the model: twice that
    assert stated["chi2_ratio"] == pytest.approx(1.0, abs=8.0 * np.sqrt(2.0 / 390))


# matstd diagnose


@pytest.mark.slow
def test_auto_finds_puts_in_and_goes_on_from_its_own_model(folder, tmp_path, capsys) -> None:
    """What was found goes into model.toml; begun with that, nothing is missing any more."""
    run, out, again = str(folder / "run.csv"), tmp_path / "out", tmp_path / "again"
    narrow = ["--only", "backlash", "thermal-lag", *QUICK]
    assert main(["diagnose", run, "--auto", "-o", str(out), *narrow]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "The model lacks one effect: reversal of Y (amplitude " in printed
    stated = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert [s["effect"] for s in stated["steps"]] == [None, "backlash(Y)"]
    model = out / "model.toml"
    assert 'name = "backlash(Y)"' in model.read_text(encoding="utf-8")
    assert main(["diagnose", run, "--model", str(model), "-o", str(again), *narrow]) == 0
    stated = json.loads((again / "diagnosis.json").read_text(encoding="utf-8"))
    assert stated["verdict"] == "no missing effect"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["again", "out"]  # nothing half-written


def test_plans_stand_beside_the_diagnosis(warmed, table) -> None:
    """Where effects are confused, a table of touches that has the columns of a run file."""
    out = warmed / "out"
    lines = (out / "next_measurement_1.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("# to distinguish thermal-lag(")
    wanted = (warmed / "run.csv").read_text(encoding="utf-8").splitlines()
    header = next(line for line in wanted if not line.startswith("#")).split(",")
    assert set(lines[1].split(",")) <= set(header)
    assert len(lines) - 2 == len(table["next_measurement"][0]["touches"])
    # without --auto and --add the model is the one to begin with
    assert "thermal-lag" not in (out / "model.toml").read_text(encoding="utf-8")


def test_named_effects_and_effects_of_ones_own(folder, tmp_path, capsys) -> None:
    (tmp_path / "mine.py").write_text(HOSE, encoding="utf-8")
    out = tmp_path / "out"
    own = ["--effects", str(tmp_path / "mine.py"), "--add", "tested-hose", "backlash(Y)"]
    command = ["diagnose", str(folder / "run.csv"), *own, "-o", str(out), *QUICK]
    assert main(command) == 0
    stated = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert [s["effect"] for s in stated["steps"]] == [None, "tested-hose", "backlash(Y)"]
    assert stated["verdict"] == "no missing effect"
    hose = stated["steps"][1]
    assert abs(hose["parameters"]["lift_um"]) < 4.0 * hose["uncertainty"]["lift_um"]
    assert stated["steps"][2]["p_value"] < 1e-6
    said = " ".join(capsys.readouterr().out.split())
    assert "tested-hose was added by name, but its size is not significant: lift" in said
    assert "backlash(Y) was added by name, but" not in said
    assert 'name = "tested-hose"' in (out / "model.toml").read_text(encoding="utf-8")


# bad input


def one_line(capsys, command):
    error = capsys.readouterr().err
    assert error.startswith(f"matstd {command}: ")
    assert error.count("\n") == 1, error
    return error


def test_force_replaces_results_and_nothing_else(changed, tmp_path) -> None:
    path, out = changed(lambda rows: rows[:200]), tmp_path / "out"
    out.mkdir()
    (out / "mine.txt").write_text("mine")
    (out / "comparison.json").write_text("old")
    assert main(["compare", path, "-o", str(out), "--no-report", "--force"]) == 0
    assert (out / "mine.txt").read_text() == "mine"
    assert json.loads((out / "comparison.json").read_text())["format"] == "comparison/1"


def test_bad_rows_are_one_clear_line(changed, tmp_path, capsys) -> None:
    """What else may be wrong with rows: `twin/test_run_file`."""
    path = changed(lambda rows: rows[:5])
    assert main(["diagnose", path, "-o", str(tmp_path / "out"), "--no-report"]) == 2
    assert "5 touches, expected at least 8" in one_line(capsys, "diagnose")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["machine.toml", "run.csv"]


@pytest.mark.parametrize(
    ("arguments", "phrase"),
    [(["--model", "nowhere.toml"], "nowhere.toml"), (["--effects", "nowhere.py"], "nowhere.py")],
)
def test_bad_arguments_are_one_clear_line(changed, tmp_path, capsys, arguments, phrase) -> None:
    path = changed(lambda rows: rows[:100])
    assert main(["diagnose", path, *arguments, "-o", str(tmp_path / "out")]) == 2
    assert phrase in one_line(capsys, "diagnose")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["machine.toml", "run.csv"]


def test_no_such_run(tmp_path, capsys) -> None:
    assert main(["compare", str(tmp_path / "no.csv"), "-o", str(tmp_path / "out")]) == 2
    assert "no.csv" in one_line(capsys, "compare")


# odd input: used, and reported


def backwards(rows):
    rows[10]["time_s"] = "0.0"
    return [rows[0], *rows]


@pytest.mark.parametrize(
    ("change", "phrases"),
    [
        (lambda rows: backwards(rows[::3]), ["1 row stands twice; copies", "time_s goes back"]),
        (lambda rows: rows[:13], ["only 1 pose"]),
        (lambda rows: rows[:60], ["60 touches for"]),
    ],
    ids=["copy and clock", "one pose", "few touches"],
)
def test_odd_runs_are_used_and_the_oddity_reported(changed, tmp_path, change, phrases) -> None:
    words = ["compare", changed(change), "-o", str(tmp_path / "out"), "--no-report"]
    assert main(words) == 0
    stated = json.loads((tmp_path / "out" / "comparison.json").read_text(encoding="utf-8"))
    for phrase in phrases:
        assert any(phrase in line for line in stated["remarks"]), stated["remarks"]


UNITS = {
    "deviations in mm": (1e-3, 1.0, "the deviations look like mm in a column of µm"),
    "both in mm": (1e-3, 1e-3, "deviations and uncertainties look like mm"),
    "deviations in nm": (1e3, 1.0, "the deviations look like nm in a column of µm"),
    "both in nm": (1e3, 1e3, "deviations and uncertainties look like nm"),
    "uncertainties in mm": (1.0, 1e-3, "u_um looks like mm"),
    "uncertainties in nm": (1.0, 1e3, "u_um looks like nm"),
}


@pytest.mark.parametrize("what", UNITS)
def test_units_mixed_up_are_named(case, what) -> None:
    """The first remark says which column, and in which direction."""
    deviation, u, phrase = UNITS[what]
    run = case(2, "hsm600u").run
    run = replace(run, deviation=run.deviation * deviation, u=run.u * u)
    remark = remarks(fit_run(run, ordinary_model(run.touches.chain)))
    assert phrase in remark_sentence(remark[0])


@pytest.mark.parametrize("factor", [0.1, 1.0, 10.0])
def test_good_and_bad_machines_are_not_mixed_units(case, factor) -> None:
    """Ten times better or worse than usual, the noise being what it is."""
    run = case(2, "hsm600u").run
    fit = fit_run(run, ordinary_model(run.touches.chain))
    deviation = run.deviation * factor + fit.residual * (1.0 - factor)
    stated = unit_mistake(
        fit_run(replace(run, deviation=deviation), ordinary_model(run.touches.chain))
    )
    assert stated is None


def test_a_run_pasted_many_times_counts_once(case) -> None:
    """With its own times every copy looks like more evidence; the numbers do not."""
    run = case(2, "hsm600u").run
    n = len(run)
    pasted = run[np.tile(np.arange(n), 3)]
    time = pasted.touches.time + np.repeat(np.arange(3), n) * (np.ptp(run.touches.time) + 15.0)
    pasted = replace(pasted, touches=replace(pasted.touches, time=time))
    once = without_copies(pasted)
    assert len(once) == n
    assert any(f"{2 * n} rows repeat the readings" in line for line in once.remarks)
    assert without_copies(once) is once
    again = without_copies(run[np.r_[0, np.arange(n)]])
    assert len(again) == n
    assert "1 row stands twice" in again.remarks[0]
