"""Control charts of one machine: steps, drifts, limits, what is refused, files."""

import csv
import io
import json
import shutil
from dataclasses import replace
from datetime import datetime
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from simulator_experiment import MACHINES
from simulator_runs import read_runs, simulated_runs
from unchanged import table_text

from matstd import trend
from matstd.cli import main
from matstd.diagnosis.accuracy import probed_volume
from matstd.diagnosis.charts import Charted, LimitSource, Occasion, Overall, history
from matstd.diagnosis.charts.chart import chart_of
from matstd.diagnosis.charts.course import course_of, critical
from matstd.diagnosis.charts.occasion import volumetric_error
from matstd.diagnosis.files import model_text
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry import Estimate, geometry_rows
from matstd.twin.errors import BadFile, DesignError, NotEnoughData
from matstd.twin.library import ordinary_model
from matstd.twin.units import UM, URAD

KEY = Charted(Overall.EFFECT, "size")
WEEKS = 7.0 * np.arange(6)


def occasion(value, number, **more):
    known = {
        "name": f"run {number}",
        "date": None,
        "chain": None,
        "standard": "",
        "prints": (str(number),),
        "touches": 100,
        "values": {KEY: Estimate(float(value), 1.0)},
    }
    return Occasion(**(known | more))


def test_a_step_has_its_size_date_and_uncertainties():
    """Means of four and two values of unit uncertainty; any moment of the week between them."""
    (step,) = course_of(WEEKS, np.array([0.0, 0, 0, 0, 9, 9]), np.ones(6), 1).steps
    assert step.after == 4
    assert step.size.value == pytest.approx(9.0)
    assert step.size.u == pytest.approx(np.sqrt(1.0 / 4.0 + 1.0 / 2.0))
    assert step.date == pytest.approx(24.5, abs=1e-3)
    assert step.u_date == pytest.approx(7.0 / np.sqrt(12.0), abs=1e-2)
    # twice the tail of a normal distribution beyond 10.39, for five places
    assert step.p_value == pytest.approx(5.0 * 2.7e-25, rel=0.05)


def test_a_drift_has_the_slope_of_least_squares():
    x = np.array([0.0, 3.1, 5.8, 9.3, 11.9, 15.2])
    found = course_of(WEEKS, x, np.full(6, 0.5), 20)
    assert found.steps == ()
    slope, covariance = np.polyfit(WEEKS, x, 1, w=np.full(6, 2.0), cov="unscaled")
    assert found.drift.rate.value == pytest.approx(slope[0])
    assert found.drift.rate.u == pytest.approx(np.sqrt(covariance[0, 0]))


def test_steps_are_those_of_all_ways_to_cut():
    """The least penalised squares over every set of places, tried one by one."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        x = rng.normal(0.0, 1.0, 7) + 8.0 * rng.integers(0, 2, 7)
        penalty = critical(6) ** 2
        ways = {
            places: sum(((part - part.mean()) ** 2).sum() for part in np.split(x, places))
            + penalty * len(places)
            for count in range(7)
            for places in combinations(range(1, 7), count)
        }
        found = course_of(np.arange(7.0), x, np.ones(7), 1)
        if found.drift is None:
            assert tuple(step.after for step in found.steps) == min(ways, key=ways.get)


def test_chance_changes_nothing():
    """Forty unchanged histories of twenty quantities: at most two with a change."""
    rng = np.random.default_rng(4)
    changed = 0
    for _ in range(40):
        series = rng.normal(0.0, 1.0, (20, 8))
        courses = [course_of(np.arange(8.0), x, np.ones(8), 20) for x in series]
        changed += any(c.steps or c.drift for c in courses)
    assert changed <= 2


def test_limits_come_from_what_is_stated_or_from_the_scatter():
    rng = np.random.default_rng(5)
    values = rng.normal(0.0, 3.0, 150)
    wide = chart_of(KEY, [occasion(v, i) for i, v in enumerate(values)], np.arange(150.0), 1)
    assert wide.source is LimitSource.SCATTER
    assert wide.sigma == pytest.approx(3.0, rel=0.2)
    low, high = wide.limits(wide.segments[0])
    assert high - low == pytest.approx(6.0 * wide.sigma)
    calm = chart_of(KEY, [occasion(v / 9, i) for i, v in enumerate(values)], np.arange(150.0), 1)
    assert calm.source is LimitSource.STATED
    assert calm.sigma == pytest.approx(1.0)


def test_a_value_beyond_the_limits_is_marked():
    values = [0.1, -0.2, 4.2, 0.2, 0.0, -0.1]
    chart = chart_of(KEY, [occasion(v, i) for i, v in enumerate(values)], WEEKS, 20)
    assert chart.source is LimitSource.STATED
    assert chart.course.steps == ()
    assert chart.beyond == (2,)


def test_volumetric_error_is_free_of_where_the_standard_stands():
    """Against a loop over poses, least squares of a rigid motion, and finite differences."""
    (run,) = read_runs(simulated_runs(np.random.default_rng(6), "hsm600u", [{}], (), 2), "hsm600u")
    fit = fit_run(run, ordinary_model(run.touches.chain))
    poses = probed_volume(run, 40, np.random.default_rng(0))
    count = len(fit.model.parameters)

    def volume(theta):
        field = fit.model.relative_deviation(poses, theta)
        rows = []
        for p in poses.point:
            cross = np.array([[0, p[2], -p[1]], [-p[2], 0, p[0]], [p[1], -p[0], 0]])
            rows.append(np.hstack([np.eye(3), cross]))
        A = np.vstack(rows)
        left = field.ravel() - A @ np.linalg.lstsq(A, field.ravel(), rcond=None)[0]
        return np.sqrt(np.mean(np.sum(left.reshape(-1, 3) ** 2, axis=1)))

    theta = fit.theta[:count]
    found = volumetric_error(fit, poses)
    assert found.value == pytest.approx(volume(theta), rel=1e-4)  # exact against first order
    steps = [(volume(theta + d) - volume(theta - d)) / 2e-6 for d in 1e-6 * np.eye(count)]
    expected = np.sqrt(steps @ fit.covariance[:count, :count] @ steps)
    assert found.u == pytest.approx(expected, rel=1e-3)


# --- runs -------------------------------------------------------------------------------------

HEAD = "# format = "


def written(folder, changes, seed=11, days=None):
    """Runs of one machine whose errors change, with a date each."""
    texts = simulated_runs(
        np.random.default_rng(seed), "hsm600u", changes, (), 3, same_standard=True
    )
    (folder / "machine.toml").write_text(MACHINES["hsm600u"], encoding="utf-8")
    for i, text in enumerate(texts):
        day = days[i] if days else f"2031-05-{i + 1:02d}"
        (folder / f"{day}.csv").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def jumped(tmp_path_factory):
    """Six runs; the line of C jumps by 25 µm between the third and the fourth."""
    folder = tmp_path_factory.mktemp("jumped")
    return written(folder, [{"EX0C": 25.0 * UM} if i > 2 else {} for i in range(6)])


def of(found, symbol):
    return next(chart for chart in found["charts"] if chart["symbol"] == symbol)


@pytest.mark.usefixtures("unrendered")
def test_a_jump_is_found_where_it_was_planted(jumped, tmp_path, capsys, unchanged):
    out = tmp_path / "out"
    assert main(["trend", str(jumped), "-o", str(out)]) == 0
    found = json.loads((out / "trend.json").read_text("utf-8"))
    (step,) = of(found, "EX0C")["steps"]
    assert step["into"] == "2031-05-04"
    assert step["date"].startswith("2031-05-03T12")
    assert abs(step["change_um"] - 25.0) < 3.0 * step["change_uncertainty_um"]
    assert step["change_uncertainty_um"] < 5.0
    changed = {c["symbol"] or c["quantity"] for c in found["charts"] if c["steps"] or c["drift"]}
    assert changed <= {"EX0C", "error with the machine of the first run", "volumetric error"}
    rows = list(csv.DictReader(io.StringIO((out / "trend.csv").read_text("utf-8"))))
    assert len(rows) == sum(len(c["occasions"]) for c in found["charts"])
    shown = capsys.readouterr().out
    assert "line of C in X (EX0C) changed by +2" in shown
    assert "next: matstd diagnose" in shown
    assert "2031-05-03.csv" in shown.splitlines()[-1]
    page = (out / "report.html").read_text("utf-8")
    assert "What it means" in page
    assert "no longer in the state of the first run" in page
    unchanged(table_text(found))


def test_nothing_is_found_where_nothing_changed(tmp_path, capsys):
    folder = written(tmp_path, [{}] * 4, seed=12)
    assert main(["trend", str(folder), "--no-report", "-o", str(tmp_path / "out")]) == 0
    assert "none of " in capsys.readouterr().out
    found = json.loads((tmp_path / "out" / "trend.json").read_text("utf-8"))
    assert {"EX0C", "EC0Y", "EXX", "backlash(B)"} <= {c["symbol"] for c in found["charts"]}


def test_runs_of_folders_and_files_are_one_course(jumped, tmp_path):
    """Two runs in a folder, one in another, and one by its path."""
    for i, place in enumerate(["spring", "spring", "autumn", "."], start=2):
        (tmp_path / place).mkdir(exist_ok=True)
        for name in ("machine.toml", f"2031-05-0{i}.csv"):
            shutil.copy(jumped / name, tmp_path / place / name)
    places = [tmp_path / name for name in ("autumn", "spring", "2031-05-05.csv")]
    found = trend(places)
    assert [one.name for one in found.occasions] == [f"2031-05-0{i}" for i in (2, 3, 4, 5)]
    assert [Path(p).parent.name for p in found.paths[:3]] == ["spring", "spring", "autumn"]


def test_a_slow_drift_of_squareness_is_a_drift(tmp_path):
    """Every fourth day of a month, 5 µrad more each time: 1.25 µrad a day."""
    days = [f"2031-05-{1 + 4 * i:02d}" for i in range(8)]
    folder = written(tmp_path, [{"EC0Y": 6.0 * i * URAD} for i in range(8)], 13, days)
    assert main(["trend", str(folder), "--no-report", "-o", str(tmp_path / "out")]) == 0
    found = json.loads((tmp_path / "out" / "trend.json").read_text("utf-8"))
    drift = of(found, "EC0Y")["drift"]
    assert abs(drift["per_day_urad"] - 1.5) < 3.0 * drift["per_day_uncertainty_urad"]
    assert drift["p_value"] < 0.01


def refused(capsys, *arguments):
    assert main(["trend", *map(str, arguments)]) == 2
    return capsys.readouterr().err


def test_what_is_not_one_machine_on_one_standard_is_refused(jumped, tmp_path, capsys):
    copies = [tmp_path / name for name in ("a.csv", "b.csv", "c.csv")]
    texts = [(jumped / f"2031-05-0{i}.csv").read_text("utf-8") for i in (1, 2, 3)]

    def again():
        (tmp_path / "machine.toml").write_text(MACHINES["hsm600u"], encoding="utf-8")
        for path, text in zip(copies, texts, strict=True):
            path.write_text(text, encoding="utf-8")

    again()
    other = MACHINES["hsm600u"].replace("-420.0", "-421.0")
    (tmp_path / "other.toml").write_text(other, encoding="utf-8")
    copies[1].write_text(texts[1].replace("machine.toml", "other.toml"), encoding="utf-8")
    out = tmp_path / "out"
    assert "b: of another machine than a" in refused(capsys, tmp_path, "-o", out)
    again()
    for path, stamp in zip(copies, ("S 1 aa", "S 1 aa", "S 2 bb"), strict=True):
        text = path.read_text("utf-8").replace("\n", f'\n# stamp = "{stamp}"\n', 1)
        path.write_text(text, encoding="utf-8")
    assert "c: measured on S 2 bb, expected S 1 aa" in refused(capsys, tmp_path, "-o", out)
    again()
    copies[2].write_text(texts[0], encoding="utf-8")
    assert "the same measurements as" in refused(capsys, tmp_path, "-o", out)
    copies[2].unlink()
    assert "expected at least 3" in refused(capsys, tmp_path, "-o", out)
    named = refused(capsys, tmp_path, copies[0].with_suffix(".toml"), "-o", out)
    assert "a.toml: expected runs alone, or models alone" in named
    assert not out.exists()


def test_features_at_other_places_are_of_another_standard():
    low, high = np.zeros(3), np.full(3, 10.0)
    chain = type("", (), {"difference": lambda *_: None, "fingerprint": ""})()
    here = [occasion(0, i, chain=chain, places={"ball": np.stack([low, high])}) for i in range(2)]
    there = occasion(0, 2, chain=chain, places={"ball": np.stack([low, high]) + 25.0})
    with pytest.raises(DesignError, match=r"run 2: ball was touched about \[30.0, 30.0, 30.0\]"):
        history([*here, there])
    near = occasion(0, 2, chain=chain, places={"ball": np.stack([low, high]) + 15.0})
    assert len(history([*here, near]).occasions) == 3
    with pytest.raises(NotEnoughData, match="2 occasions"):
        history(here)


def test_dates_come_from_heads_and_names():
    from matstd.api.trending import date_of

    assert date_of("mill_20310506T0708") == datetime(2031, 5, 6, 7, 8)
    assert date_of("2031-13-06") is None
    assert date_of("2031-05-06_to_2031-05-07") is None


def test_saved_models_are_charted_and_keep_their_machine(jumped, tmp_path):
    """What models state as determined is what their runs determine; an edited machine is seen."""
    import matstd

    folder = tmp_path / "models"
    for i in (1, 2, 3):
        run = matstd.read_run(jumped / f"2031-05-0{i}.csv")
        fit = fit_run(run, ordinary_model(run.touches.chain))
        rows = [row for row in geometry_rows(fit) if row.is_determined]
        (folder / f"2031-05-0{i}").mkdir(parents=True)
        path = folder / f"2031-05-0{i}" / "model.toml"
        path.write_text(model_text(fit, "run.csv", determined=rows), encoding="utf-8")
    of_models = matstd.trend(folder)
    of_runs = matstd.trend([jumped / f"2031-05-0{i}.csv" for i in (1, 2, 3)])
    assert [one.name for one in of_models.occasions] == ["2031-05-01", "2031-05-02", "2031-05-03"]
    for symbol, tolerance in (("EX0C", 6.0 * UM), ("EC0Y", 15.0 * URAD)):
        ours, theirs = (
            next(c for c in found.charts if c.of.symbol == symbol) for found in (of_models, of_runs)
        )
        # runs are fitted with backlash beside the geometry
        assert ours.values[0].value == pytest.approx(theirs.values[0].value, abs=tolerance)
    text = path.read_text("utf-8")
    path.write_text(text.replace("-420.0", "-419.0"), encoding="utf-8")
    with pytest.raises(BadFile, match="changed after the model was learnt"):
        matstd.read_model(path)
    path.write_text(
        text.replace('"model/2"', '"model/1"').replace("machine_hash", "# machine_hash"),
        encoding="utf-8",
    )
    assert matstd.read_model(path).source.machine_hash == ""


def test_dates_of_names_count_where_heads_state_the_same():
    """Simulated runs all begin when the clock of the twin does."""
    from matstd.api.trending import dated

    days = [datetime(2031, 5, day) for day in (1, 2)]
    twin = [occasion(0.0, 0, name=f"{d:%Y-%m-%d}", date=datetime(2000, 1, 1, 8)) for d in days]
    assert [one.date for one in dated(twin)] == days
    logs = [replace(one, date=d.replace(hour=7)) for one, d in zip(twin, days, strict=True)]
    assert [one.date for one in dated(logs)] == [d.replace(hour=7) for d in days]
