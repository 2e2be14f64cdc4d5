"""Several runs of one machine: what changed between them comes back, and nothing else is named."""

import json
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from figures import render_alone
from formats import undescribed
from simulator_case import named
from simulator_experiment import MACHINES
from simulator_machine import read_machine
from simulator_runs import read_runs, simulated_runs
from unchanged import answer_text, page_text, table_text
from written import tree_lines

import matstd
from matstd.cli import main
from matstd.diagnosis import answer
from matstd.diagnosis.answer import Diagnosis, Verdict, diagnose
from matstd.diagnosis.answer.trend import single_change
from matstd.diagnosis.files import diagnosis_table
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.geometry import Rung, changed_runs, changing
from matstd.report.geometry import change_sentences
from matstd.twin.library import ordinary_model, parse_effect, proposals
from matstd.twin.model import Model
from matstd.twin.record import joined
from matstd.twin.units import UM, URAD

MACHINE, POSES = "hsm600u", 5
NOISE = 0.6 * UM
CHANGE = 38.0 * URAD
"""By how much Y was knocked out of square to X."""

COVERED = 3.0
"""Standard uncertainties within which what was planted is found."""


def made(seed, changes, hidden=(), names="abcdef"):
    texts = simulated_runs(np.random.default_rng(seed), MACHINE, changes, hidden, POSES)
    return dict(zip(names, read_runs(texts, MACHINE), strict=False))


@pytest.fixture(scope="module")
def knocked():
    """Before and after: squareness changed, nothing else."""
    return made(3, [{}, {"EC0Y": CHANGE}])


RIVALS = ("backlash", "location", "thermal-static")
"""Of a change of a constant; the slow tests have the whole library."""


def few(run):
    return proposals(run.touches, RIVALS)


class Commanded(NamedTuple):
    """What the command makes of the two runs."""

    out: Path
    printed: str
    figures: dict[str, str]
    found: Diagnosis


@pytest.fixture(scope="module")
def commanded(folder, tmp_path_factory):
    out, printed, found = tmp_path_factory.mktemp("command") / "out", StringIO(), []
    files = [str(folder / f"{n}.csv") for n in ("spring", "autumn")]
    words = ["diagnose", *files, "--only", *RIVALS, "--no-learn", "-o", str(out)]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed):
        figures = render_alone(patch)
        patch.setattr(answer, "diagnose", lambda *of: found.append(diagnose(*of)) or found[0])
        assert main(words) == 0
    return Commanded(out, printed.getvalue(), figures, *found)


@pytest.fixture(scope="module")
def diagnosed(commanded):
    return commanded.found


def row(rows, symbol):
    return next(r for r in rows if r.symbol == symbol)


def test_what_changed_is_reported_with_its_size_and_nothing_else(diagnosed) -> None:
    assert diagnosed.verdict is Verdict.NONE
    assert diagnosed.trend.changed == (1,)
    changed = {r.symbol: r for r in diagnosed.geometry.rows if r.has_changed}
    assert set(changed) == {"EC0Y"}
    change = changed["EC0Y"].change
    assert abs(change.value - CHANGE) < COVERED * change.u
    assert change.u < 0.25 * CHANGE
    (sentence,) = change_sentences(diagnosed.trend)
    assert matstd.diagnose  # the door registers how results are shown
    assert sentence in repr(diagnosed)  # a session shows it as the command does
    assert sentence.startswith("from spring to autumn squareness of Y to X (EC0Y) changed from ")


def test_keys_of_several_runs_are_described(diagnosed) -> None:
    table = diagnosis_table(diagnosed)
    assert table["trend"]["quantities"]
    assert undescribed(table, "diagnosis.json") == []


def test_the_ladder_shows_what_one_geometry_for_all_runs_would_be_worth(diagnosed) -> None:
    rungs = {step.rung: step.test_rms for step in diagnosed.geometry.ladder}
    assert list(rungs) == [Rung.SETUP, Rung.COMMON, Rung.GEOMETRY]
    assert rungs[Rung.SETUP] > 3.0 * rungs[Rung.COMMON]
    assert rungs[Rung.COMMON] > 1.1 * rungs[Rung.GEOMETRY]
    for run in diagnosed.trend.runs:
        assert run.left_out > 2.0 * NOISE  # the machine of the other run is another one


@pytest.mark.slow
def test_where_nothing_changed_it_says_so_and_knows_more() -> None:
    runs = made(4, [{}, {}])
    both = diagnose(joined(runs))
    assert both.verdict is Verdict.NONE
    assert both.trend.changed == ()
    (sentence,) = change_sentences(both.trend)
    assert sentence.startswith(
        "from a to b no change of the geometry was detected; detection limits of"
    )
    # 3.5 standard uncertainties are no change, and yet not kept back
    square = row(both.trend.rows, "EC0Y")
    near = replace(square, steps=(replace(square.steps[0], value=3.5 * square.steps[0].u),))
    rows = tuple(near if r is square else r for r in both.trend.rows)
    (sentence,) = change_sentences(replace(both.trend, rows=rows))
    assert "detected; squareness of Y to X (EC0Y) may have changed by " in sentence
    for run in both.trend.runs:
        assert run.left_out < 3.0 * NOISE
    alone = fit_run(runs["a"], ordinary_model(runs["a"].touches.chain))
    u = {n: np.sqrt(f.covariance[i, i]) for f in (alone,) for i, n in enumerate(f.names)}
    mine = {n: np.sqrt(both.fit.covariance[i, i]) for i, n in enumerate(both.fit.names)}
    better = [mine[n] < u[n] * 1.001 for n in u if n in mine and n.startswith("location")]
    assert np.mean(better) > 0.9


@pytest.mark.slow
def test_an_effect_of_all_runs_is_found_and_known_better_than_from_either() -> None:
    lag = named(np.random.default_rng(1), read_machine(MACHINES[MACHINE]), "thermal-lag(EZZ)")
    lag.amplitude = 8.0
    runs = made(5, [{}, {"EC0Y": CHANGE}], [lag])
    alone = [diagnose(run) for run in runs.values()]
    both = diagnose(joined(runs))
    sizes = []
    for result in (*alone, both):
        (step,) = [s for s in result.steps if s.effect is not None]
        assert step.effect.kind in ("thermal-lag", "thermal-static")
        sizes.append(next(r for r in step.reported if r.quantity == "amplitude"))
    assert abs(sizes[-1].value - lag.amplitude) < COVERED * sizes[-1].u
    assert sizes[-1].u < min(s.u for s in sizes[:-1])
    assert "EC0Y" in {r.symbol for r in both.geometry.rows if r.has_changed}


def test_an_effect_of_all_runs_is_known_better_than_from_one(knocked) -> None:
    """Fitted, not searched: the same lag in one run and in both."""
    runs, u = joined(knocked), []
    lag = parse_effect("thermal-lag(EZZ)", runs.touches.chain)
    for run in (knocked["a"], runs):
        model = ordinary_model(run.touches.chain)
        fit = fit_run(run, Model(model.chain, (*model.effects, lag)))
        place = fit.of_effect(lag.name)
        u.append(float(np.sqrt(fit.covariance[place, place].item())))
    assert u[1] < 0.9 * u[0]


@pytest.mark.slow
def test_a_slow_change_is_seen_though_no_step_of_it_would_be() -> None:
    """Each run 12 µrad after the last: less than four uncertainties, but all of them are not."""
    runs = joined(made(6, [{"EC0Y": 12.0 * URAD * i} for i in range(5)]))
    model = changing(ordinary_model(runs.touches.chain), runs.touches, range(1, 5))
    fit = fit_run(runs, model)
    found = changed_runs(fit)
    assert found
    assert len(found) < 4
    same = joined(made(6, [{}] * 5))
    assert changed_runs(fit_run(same, changing(model, same.touches, range(1, 5)))) == ()


@pytest.mark.parametrize("seed", [4, pytest.param(6, marks=pytest.mark.slow)])
def test_one_change_alone_is_seen_where_a_hundred_at_once_would_hide_it(seed) -> None:
    """Four times finer than a geometry of which anything may change; nothing where nothing did."""
    found = []
    for size in (0.0, CHANGE):
        run = joined(made(seed, [{}, {"EC0Y": size}]))
        found.append(single_change(fit_run(run, ordinary_model(run.touches.chain)), 1))
    nothing, squareness = found
    assert nothing is None
    assert squareness.effect.name == "location(EC0Y)"
    assert abs(squareness.size.value - CHANGE) < COVERED * squareness.size.u
    assert squareness.size.u < 3.0 * URAD


# since a saved model


@pytest.fixture(scope="module")
def spring(knocked):
    """Model and estimates of the first run."""
    run = knocked["a"]
    model = ordinary_model(run.touches.chain)
    fit = fit_run(run, model)
    count = len(model.parameters)
    C = fit.covariance[:count, :count]
    return model, Prior.of_estimates(fit.theta[:count], C)


def test_a_changed_machine_is_no_missing_effect(knocked, spring) -> None:
    """Begun with the model of the spring: what changed is reported, without an invented effect."""
    found = diagnose(knocked["b"], *spring, candidates=few(knocked["b"]))
    assert found.verdict is Verdict.NONE
    change = row(found.geometry.rows, "EC0Y").change
    assert abs(change.value - CHANGE) < COVERED * change.u
    assert [r.symbol for r in found.geometry.rows if r.has_changed] == ["EC0Y"]
    assert found.geometry.ladder[1].rung is Rung.MODEL


@pytest.mark.slow
def test_the_same_machine_keeps_what_was_known(spring) -> None:
    again = made(3, [{}, {}])["b"]
    found = diagnose(again, *spring, candidates=few(again))
    assert found.verdict is Verdict.NONE
    assert not [r.symbol for r in found.geometry.rows if r.has_changed]
    alone = fit_run(again, ordinary_model(again.touches.chain))
    assert found.fit.test_rms < alone.test_rms


# rows outside the fit


def test_a_run_held_out_is_predicted_with_its_setups_fitted(unchanged) -> None:
    runs = made(4, [{}, {}])
    runs["b"] = replace(runs["b"], split=np.full(len(runs["b"]), "test"))
    found = diagnose(joined(runs), candidates=[])
    last = found.trend.runs[-1]
    assert last.is_held_out
    assert last.left_out == pytest.approx(found.fit.test_rms)
    assert NOISE * 0.9 < last.left_out < 2.0 * NOISE
    assert not found.fit.used[found.run.touches.run == 1].any()
    assert not found.trend.changed
    unchanged(answer_text(found))


def test_a_setup_of_one_pose_is_never_left_out_whole(knocked) -> None:
    """Without any touch of it the error would be where the standard stands: a millimetre."""
    run = knocked["a"]
    first = run.touches.pose == run.touches.pose[0]
    few = run[first | (run.touches.setup > 0)]
    fit = fit_run(few, ordinary_model(run.touches.chain))
    own = few.touches.setup[fit.used] == 0
    assert np.abs(fit.held_out_errors[own]).max() < 20.0 * UM
    for rows in fit.groups:
        left = few.touches.setup[fit.used][np.setdiff1d(np.arange(int(fit.used.sum())), rows)]
        assert set(left) == {0, 1, 2}


# commands


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("runs")
    texts = simulated_runs(np.random.default_rng(3), MACHINE, [{}, {"EC0Y": CHANGE}], (), POSES)
    for name, text in zip(("spring", "autumn"), texts, strict=True):
        (place / f"{name}.csv").write_text(text, encoding="utf-8")
    (place / "machine.toml").write_text(MACHINES[MACHINE], encoding="utf-8")
    return place


def test_the_command_reports_what_changed_and_saves_the_machine_as_it_is_now(
    commanded, folder, tmp_path, capsys, unchanged
) -> None:
    out, printed, figures, _ = commanded
    printed = printed.replace(str(folder), "").replace(str(out.parent), "")
    table = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert [r["run"] for r in table["trend"]["runs"]] == ["spring", "autumn"]
    (changed,) = [q for q in table["trend"]["quantities"] if q["has_changed_into"]]
    assert changed["symbol"] == "EC0Y"
    assert abs(changed["change_urad"][1] - 38.0) < COVERED * changed["change_uncertainty_urad"][1]
    page = page_text((out / "report.html").read_text(encoding="utf-8"))
    section = page.partition("Changes between the runs</h2>")[2].partition("<h2")[0]
    trend = tree_lines(table.pop("trend"))
    unchanged("\n".join([printed, table_text(table), *trend, figures["trend"], section]))
    # the saved machine is that of the autumn
    model = str(out / "model.toml")
    errors = {}
    for path in sorted(folder.glob("*.csv")):
        to = tmp_path / path.stem
        assert main(["compare", str(path), "--model", model, "-o", str(to), "--no-report"]) == 0
        assert "was learnt from this very run" in " ".join(capsys.readouterr().out.split())
        errors[to.name] = json.loads((to / "comparison.json").read_text())["rms_um"]
    assert errors["autumn"] < 1.2 * NOISE / UM < errors["spring"]


def test_a_run_is_held_out_by_its_name(folder, tmp_path, capsys) -> None:
    files = [str(folder / f"{n}.csv") for n in ("spring", "autumn")]
    out = tmp_path / "out"
    command = ["diagnose", *files, "--hold-out", "autumn", "--only", "backlash", "--no-learn"]
    assert main([*command, "-o", str(out), "--no-report"]) == 0
    capsys.readouterr()
    table = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    spring, autumn = table["trend"]["runs"]
    assert (spring["is_held_out"], autumn["is_held_out"]) == (False, True)
    assert autumn["rms_um"] is None
    assert autumn["left_out_rms_um"] > 2.0 * NOISE / UM  # it was knocked


def refused(arguments, capsys) -> str:
    assert main(["diagnose", *map(str, arguments), "--no-report"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


def test_runs_that_do_not_go_together_are_refused_in_one_line(folder, tmp_path, capsys) -> None:
    spring, out = folder / "spring.csv", tmp_path / "out"
    (text,) = simulated_runs(np.random.default_rng(3), "fork", [{}], (), POSES)
    (tmp_path / "fork.csv").write_text(text, encoding="utf-8")
    (tmp_path / "machine.toml").write_text(MACHINES["fork"], encoding="utf-8")
    line = refused([spring, tmp_path / "fork.csv", "-o", out], capsys)
    assert "fork: of another machine than spring" in line
    assert "given twice" in refused([spring, spring, "-o", out], capsys)
    (tmp_path / "copy.csv").write_text(spring.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "machine.toml").write_text(MACHINES[MACHINE], encoding="utf-8")
    line = refused([spring, tmp_path / "copy.csv", "-o", out], capsys)
    assert "same measurements" in line
    line = refused([spring, "-o", out, "--hold-out", "winter"], capsys)
    assert "--hold-out winter: expected one of spring" in line
    assert "no run is left" in refused([spring, "-o", out, "--hold-out", "spring"], capsys)
    assert not out.exists()
