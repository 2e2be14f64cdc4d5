"""One set: tested, reported and saved; every figure can be had again from the saved model."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from run_text import every
from simulator_case import simulate_case

from matstd.cli import main
from matstd.diagnosis.answer import ConfusionClass
from matstd.diagnosis.answer import reported_set as reporting
from matstd.diagnosis.answer.ambiguity import Rival
from matstd.diagnosis.answer.reported_set import reported_set
from matstd.diagnosis.answer.steps import left_by
from matstd.diagnosis.choice import Choice, choice_remarks
from matstd.diagnosis.choice.prediction import ChoiceRule
from matstd.diagnosis.files import model_text, read_model
from matstd.diagnosis.files.diagnosis_file import choice_table
from matstd.diagnosis.fit import Learnt, Prior, fit_run
from matstd.diagnosis.regression import Memory
from matstd.diagnosis.search import DiagnosisTask, search_loop
from matstd.report.words import figures
from matstd.report.words.diagnosis_words import number_words
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.record import without_copies
from matstd.twin.units import UM

LAG = (5, "hsm600u", ("thermal-lag(EXC)",), False, (12.0, 40.0), 5)
COLLINEAR = ("thermal-static(EXX,ambient)", "thermal-static(EXB,ambient)")
TWO = (12, "hmc1995", ("backlash(Y)", "stylus-bending"))


def searched(case, key, names):
    """Result of a search among some effects of a simulated run."""
    run = case(*key).run
    start = ordinary_model(run.touches.chain)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    library = [parse_effect(name, run.touches.chain) for name in names]
    return task, search_loop.searched(task, library)


# --- the set that is reported is the set that was tested ------------------------------------------


def test_refined_effects_are_tested_as_they_are_reported(case) -> None:
    _, final = searched(case, LAG, ["thermal-lag(EXC)", "backlash(X)"])
    tested = reported_set(final)
    (stated,) = tested.state.effects
    (member,) = tested.state.chosen.members
    assert member.effect is stated.effect
    grid = [p for inner in stated.effect.inner(case(*LAG).run.touches) for p in inner.grid]
    assert all(abs(stated.effect.tuning["tau"] / g - 1.0) > 1e-6 for g in grid)  # off the grid
    test = tested.tests["thermal-lag(EXC)"]
    assert test.stands
    without = tested.state.search.evaluate(())
    gained = tested.state.chosen.effects.evidence - without.effects.evidence
    assert test.evidence == pytest.approx(gained)


def test_a_name_that_does_not_stand_is_not_reported(case, monkeypatch) -> None:
    """The class offers a head that explains nothing: the tested member keeps its name."""
    _, final = searched(case, LAG, ["thermal-lag(EXC)", "backlash(X)"])
    other = replace(final.effects[0], effect=parse_effect("backlash(X)", final.base.model.chain))

    def headed(pool, found, base, others):
        return ConfusionClass(other, (), ())

    monkeypatch.setattr(reporting, "confusion_class", headed)
    tested = reported_set(final)
    assert [s.effect.name for s in tested.state.effects] == ["thermal-lag(EXC)"]
    assert [c.effect.name for c in tested.classes] == ["thermal-lag(EXC)"]
    assert [r.effect.name for r in tested.classes[0].rivals] == ["backlash(X)"]
    assert tested.tests["thermal-lag(EXC)"].stands


def test_no_effect_stands_twice_when_two_classes_want_one_head(case, monkeypatch) -> None:
    names = ["backlash(Y)", "stylus-bending", "probe-radius"]
    _, final = searched(case, TWO, names)
    assert len(final.effects) == 2
    wanted = final.effects[0]

    def headed(pool, found, base, others):
        assert found.effect.name not in others
        return ConfusionClass(found, (Rival(wanted, 0.0, 1.0),), ())

    monkeypatch.setattr(reporting, "confusion_class", headed)
    tested = reported_set(final)
    stated = [s.effect.name for s in tested.state.effects]
    assert sorted(stated) == sorted(set(stated)) == ["backlash(Y)", "stylus-bending"]
    rivals = {r.effect.name for c in tested.classes for r in c.rivals}
    assert not rivals & set(stated)


# --- figures made again from what is kept -----------------------------------------------------


MADE_AGAIN = {
    "white": (None, False),
    "remembers": (Memory(0.4), True),
    "counts for less": (Memory(0.6, is_filtered=False), False),
}
"""Memory of the noise, and whether rows are held out; `make proof` has every memory with both."""

OTHERS = [
    pytest.param(memory, not held_out, id=f"{name}, other rows", marks=pytest.mark.slow)
    for name, (memory, held_out) in MADE_AGAIN.items()
]


@pytest.mark.parametrize(
    ("memory", "held_out"),
    [*(pytest.param(*one, id=name) for name, one in MADE_AGAIN.items()), *OTHERS],
)
def test_a_fit_is_made_again(case, memory, held_out) -> None:
    run = without_copies(case(*LAG).run)
    if held_out:
        split = np.where(np.arange(len(run)) % 5 == 0, "test", "train")
        run = replace(run, split=split)
    effect = parse_effect("thermal-lag(EXC)", run.touches.chain)
    start = ordinary_model(run.touches.chain)
    model = Model(start.chain, (*start.effects, effect.tuned(1800.0)))
    fit = fit_run(run, model, memory=memory)
    again = Learnt.of(fit).again(run, model)
    assert again.residual == pytest.approx(fit.residual, abs=1e-9)
    assert again.solution.leverage == pytest.approx(fit.solution.leverage, abs=1e-6)
    assert again.rms == pytest.approx(fit.rms, rel=1e-7)
    assert again.test_rms == pytest.approx(fit.test_rms, rel=1e-7)
    assert again.noise.chi2_ratio == pytest.approx(fit.noise.chi2_ratio, rel=1e-7)
    apart = np.abs(again.covariance - fit.covariance)
    assert (apart <= np.maximum(1e-4 * np.abs(fit.covariance), 1e-14)).all()


def test_uncertain_inner_parameters_widen_what_is_saved(case, tmp_path) -> None:
    run = without_copies(case(*LAG).run)
    effect = parse_effect("thermal-lag(EXC)", run.touches.chain)
    start = ordinary_model(run.touches.chain)
    model = Model(start.chain, (*start.effects, effect.tuned(1800.0)))
    fit = fit_run(run, model)
    root = Learnt.of(fit).from_inner
    count = len(model.parameters)
    assert root.shape == (count, 1)
    (tmp_path / "model.toml").write_text(model_text(fit, "run.csv"), encoding="utf-8")
    saved = read_model(tmp_path / "model.toml")
    whole = saved.estimates.root @ saved.estimates.root.T
    held = fit.covariance[:count, :count]
    assert np.diag(whole - held).min() > -1e-12
    assert np.diag(whole)[-1] > np.diag(held)[-1]
    learnt = saved.learnt(run)
    assert learnt is not None
    assert figures(learnt.again(run, saved.model)) == figures(fit)
    assert saved.learnt(replace(run, deviation=run.deviation + 1e-3)) is None


# --- the console and the page, and the model file -----------------------------------------------


def flat(text):
    return " ".join(text.split())


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run with a hidden warming of the column, and its machine."""
    place = tmp_path_factory.mktemp("run")
    run, machine, _ = simulate_case(np.random.default_rng(5), *LAG[1:5], with_alike=False, poses=6)
    (place / "run.csv").write_text(every(2, run), encoding="utf-8")
    (place / "machine.toml").write_text(machine, encoding="utf-8")
    return place


@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize(
    "option",
    [
        pytest.param(["--auto"], id="auto"),
        pytest.param(["--add", "backlash(X)"], id="added", marks=pytest.mark.slow),
    ],
)
def test_every_figure_can_be_had_again_from_the_model(folder, tmp_path, capsys, option) -> None:
    run = str(folder / "run.csv")
    narrow = ["--only", "thermal-lag(EXC)", "backlash"]
    arguments = [run, *option, *narrow, "--no-report", "--no-learn", "-o", str(tmp_path / "d")]
    assert main(["diagnose", *arguments]) == 0
    capsys.readouterr()
    model = str(tmp_path / "d" / "model.toml")
    assert main(["compare", run, "--model", model, "-o", str(tmp_path / "c")]) == 0
    shown = flat(capsys.readouterr().out)
    diagnosis = json.loads((tmp_path / "d" / "diagnosis.json").read_text())
    comparison = json.loads((tmp_path / "c" / "comparison.json").read_text())
    step = diagnosis["steps"][-1 if option == ["--auto"] else 1]
    assert step["effect"] == (option[1] if option[1:] else "thermal-lag(EXC)")
    keys = ("rms_um", "test_rms_um", "chi2_ratio")
    assert comparison["learnt"] == {key: step[key] for key in keys}
    page = flat((tmp_path / "c" / "report.html").read_text())
    for text in (shown, page.replace("\u00a0", " ").replace("&nbsp;", " ")):
        assert f"fitted {step['rms_um']:.3f} µm, held out {step['test_rms_um']:.3f} µm" in text
    saved = read_model(model)
    numbers = saved.reported[step["effect"]]
    assert {n.name: n.value for n in numbers} == pytest.approx(step["parameters"], rel=1e-5)
    for words in number_words(numbers, step["effect"]):
        assert " ".join(words) in shown


# --- additions that these touches cannot distinguish ---------------------------------------------


def test_additions_that_are_one_to_these_touches_are_refused_by_name(
    folder, tmp_path, capsys
) -> None:
    """A shift of either axis with the air: nothing here moves between them."""
    run = str(folder / "run.csv")
    asked = ["--add", *COLLINEAR, "--no-report", "-o", str(tmp_path / "d")]
    assert main(["diagnose", run, *asked]) == 2
    said = flat(capsys.readouterr().err)
    assert all(name in said for name in COLLINEAR)
    assert "only a sum of their sizes is known" in said
    assert not (tmp_path / "d").exists()


def test_left_by_is_the_share_that_others_cannot_imitate() -> None:
    x, y = np.array([[1.0], [0.0], [0.0]]), np.array([[3.0], [4.0], [0.0]])
    assert left_by(x, y) == pytest.approx(16.0 / 25.0)
    assert left_by(y, np.hstack([x, np.array([[0.0], [1.0], [0.0]])])) == pytest.approx(0.0)
    assert left_by(x, np.zeros((3, 0))) == 1.0


# --- a choice by prediction ---------------------------------------------------------------------


def test_ways_of_a_choice_are_reported_with_their_errors() -> None:
    nothing = ChoiceRule("nothing", (), np.array([3.0, 4.0]) * UM, np.array([10, 30]))
    way = ChoiceRule("thermal field", (), np.array([1.0, 1.0]) * UM, np.array([10, 30]))
    choice = Choice((nothing, way), way, 2, None)
    (remark,) = choice_remarks(choice, SimpleNamespace(model=SimpleNamespace(effects=())))
    plain = np.sqrt((10 * 3.0**2 + 30 * 4.0**2) / 40)
    assert [error / UM for _, error in remark.tried] == pytest.approx([plain, 1.0])
    table = choice_table(choice)
    assert (table["chosen"], table["blocks"]) == ("thermal field", 2)
    assert [w["held_out_um"] for w in table["ways"]] == pytest.approx([plain, 1.0], rel=1e-5)


def test_rivals_of_a_large_effect_are_reported(case) -> None:
    """Hundreds of times the noise, off the grid: one growth is like two others."""
    run = case(*LAG).run
    start = ordinary_model(run.touches.chain)
    lag = parse_effect("thermal-lag(EZZ)", start.chain).tuned(1900.0)
    large = columns([lag], run.touches)[:, 0] * 300 * UM
    run = replace(run, deviation=run.deviation + large)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    alike = [f"thermal-lag(EZ{axis})" for axis in "XYZ"]
    library = [parse_effect(n, start.chain) for n in [*alike, "thermal-lag(EXC)", "backlash(X)"]]
    tested = reported_set(search_loop.searched(task, library))
    growth = next(c for c in tested.classes if c.effect.name in alike)
    assert {growth.effect.name, *(r.effect.name for r in growth.rivals)} == set(alike)
