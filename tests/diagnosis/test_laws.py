"""Laws without a cause: found in exactly simulated runs, and none where there is none."""

import json
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from simulator import probe, run_text
from simulator_case import Ordinary, read_back, visible_size
from simulator_case import named as hidden_effect
from simulator_effects import SMALL, Hidden, slip
from simulator_experiment import MACHINES, STATED_NOISE, random_experiment
from simulator_laws import drawn, law_case
from written import folder_text

from matstd.api.diagnosing import compare, diagnose
from matstd.cli import main
from matstd.diagnosis import answer
from matstd.diagnosis.accuracy import Promise
from matstd.diagnosis.answer import Verdict
from matstd.diagnosis.files import (
    diagnosis_table,
    model_of,
    model_text,
    parsed_model,
    read_model,
)
from matstd.diagnosis.files.unknown_elsewhere import judged_laws, unknown_elsewhere
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.laws import (
    POLICY,
    Learning,
    LearntLaw,
    Refusal,
    Rival,
    amplitudes,
    error_left,
    fit_beside,
    learn_laws,
    learn_remainder,
    places,
    second_run,
    surface_of,
)
from matstd.diagnosis.laws.acceptance import (
    holds_where_largest,
    pose_groups,
    prediction_odds,
    time_groups,
)
from matstd.diagnosis.laws.beginning import Beginning
from matstd.diagnosis.laws.formulas import columns_of, scan, spread
from matstd.diagnosis.laws.learn import _by_rival as weighed
from matstd.diagnosis.laws.learn import _of_its_run
from matstd.diagnosis.laws.library import LibraryEffect
from matstd.diagnosis.laws.remainder import _determined, _of_library
from matstd.diagnosis.laws.screening import _quick_frequencies, by_evidence, modulations
from matstd.diagnosis.laws.search import Ground
from matstd.diagnosis.laws.smooth import curve_laws
from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.diagnosis.residual import apart_elsewhere
from matstd.report.laws import limits_sentences, no_law_sentence, second_run_sentence
from matstd.report.laws.run_words import run_sentence
from matstd.report.run_view import diagnosis_step
from matstd.report.verdict import part_lines
from matstd.report.words import remark_sentence, verdict_sentence
from matstd.twin.laws import carrier_of
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.units import UM


def test_a_law_is_found_with_its_carrier_variable_and_shape(stylus) -> None:
    (*_, truth), _, found = stylus
    (one,) = found.laws
    assert one.law.name == "law(bias,step time)"
    assert one.library.score < one.score
    (size,), (instant,) = amplitudes(found, one.law), places(found, one.law)
    hidden = truth["hidden"][0]["amplitude"] * UM
    assert abs(size.value - hidden) < 3.0 * size.u < 0.2 * hidden
    assert abs(instant.value - 6200.0) < 2.0 * instant.u
    assert all(h.after < h.before for h in found.held_out[:2])


def test_a_law_of_the_clock_of_one_run_is_not_expected_in_another(stylus) -> None:
    """The stylus is changed in the second run, too, a quarter of an hour to an hour earlier."""
    _, (run, second, free), found = stylus
    assert not found.laws[0].travels
    assert np.any(found.predicted(run))
    assert not np.any(found.predicted(second))
    moved = second_run(found, second)
    assert moved.learnt == moved.without
    assert not moved.is_clock_kept
    assert "kept its times: it did not." in second_run_sentence(moved)
    true = error_left(fit_beside(0.0, free, ordinary_model(free.touches.chain)))
    texts = law_case(
        np.random.default_rng(5), "hmc1995", "stylus", (30.0, 31.0), 4, is_clock_kept=True
    )
    repeating = read_back(texts[1], MACHINES["hmc1995"])
    kept = second_run(found, repeating)
    assert kept.clocked < 1.1 * true
    assert kept.without > 1.3 * true
    assert kept.is_clock_kept
    assert "kept its times: it did. What drives it" in second_run_sentence(kept)
    text = model_text(found.saved, "run")
    applied, none = (parsed_model(text, "model.toml", runs=[r]) for r in (repeating, second))
    assert [one.effect.name for one in applied.repeated] == [found.laws[0].law.name]
    assert applied.left_out == () == none.repeated
    assert "this run shows it, too" in remark_sentence(applied.repeated[0])
    assert compare(repeating, applied).rms < 1.1 * true


@pytest.mark.slow
def test_a_law_that_begins_with_the_set_up_predicts_a_second_run() -> None:
    texts = law_case(np.random.default_rng(6), "hmc1995", "relaxing", (30.0, 31.0), poses=5)
    run, second, free = (read_back(text, MACHINES["hmc1995"]) for text in texts[:3])
    found = learn_laws(run)
    assert [one.law.drivers[0].name for one in found.laws] == ["since-setup"]
    said = second_run(found, second)
    assert said.clocked is None
    true = error_left(fit_beside(0.0, free, ordinary_model(free.touches.chain)))
    assert said.learnt < 1.1 * true
    assert said.without > 1.3 * true


def test_a_function_of_two_readings_is_not_taken_for_one_of_a_single_reading() -> None:
    rng = np.random.default_rng([2026, 13])  # a ring about a point
    run, second = (
        read_back(text, MACHINES["hmc1995"]) for text in law_case(rng, "hmc1995", "radius")[:2]
    )
    found = learn_laws(run)
    assert (found.laws, found.refusal) == ((), Refusal.PREDICTION)
    beginning, law = found.beginning, found.refused.law
    assert law.is_curve_alone
    fit = beginning.fitted([law])
    own = columns([law], second.touches) @ fit.theta[fit.of_effect(law.name)]
    model = beginning.fit.model
    assert error_left(fit_beside(own, second, model)) > error_left(fit_beside(0.0, second, model))


def test_a_ring_about_a_point_is_a_smooth_surface() -> None:
    """No product of two shapes is one: its centre is as low as all around it."""
    texts = law_case(np.random.default_rng(1), "hmc1995", "radius", (40.0, 60.0), poses=4)
    run, second = (read_back(text, MACHINES["hmc1995"]) for text in texts[:2])
    found = learn_laws(run)
    (one,) = found.laws
    law = one.law
    assert law.name == "law(EYX,surface X,surface Y)"
    said = second_run(found, second)
    assert said.learnt**2 < 0.4 * said.without**2
    touches = found.after.run.touches
    at = np.array([driver.values(touches) for driver in law.drivers])
    value, u = surface_of(found, law, *at)
    theta = found.after.theta[found.after.of_effect(law.name)]
    assert value == pytest.approx(np.stack(law.amounts(touches), axis=1) @ theta)
    far = surface_of(found, law, at[0], at[1] + 10.0 * np.ptp(at[1]))
    assert np.abs(far[0]).max() < 1e-6 * np.abs(value).max()
    assert far[1].min() > 2.0 * np.median(u)


def test_odds_of_a_prediction_are_those_of_normal_densities(stylus) -> None:
    """Each pose by a fit to all the others, both models on the same rows."""
    found = stylus[2]
    fits = found.after, found.beginning.fitted([], gross=found.after.gross)

    def log_density(fit, groups):
        X, y = fit.X[fit.used], fit.y[fit.used]  # over the noise
        log = square = 0.0
        row = np.cumsum(fit.used) - 1
        for rows in (row[g[fit.used[g]]] for g in groups):
            others = np.delete(np.arange(len(y)), rows)
            C = np.linalg.inv(np.eye(X.shape[1]) + X[others].T @ X[others])
            error = y[rows] - X[rows] @ (C @ X[others].T @ y[others])
            V = np.eye(len(rows)) + X[rows] @ C @ X[rows].T
            square += error @ np.linalg.solve(V, error)
            log -= 0.5 * np.linalg.slogdet(V)[1]
        return log - 0.5 * len(y) * np.log(square * fit.noise.factor**2 / len(y))

    by_hand = min(
        log_density(fits[0], groups) - log_density(fits[1], groups)
        for groups in (pose_groups(fits[1]), time_groups(fits[1]))
    )
    assert prediction_odds(*fits) == pytest.approx(by_hand, rel=1e-6)
    assert by_hand > 10.0


@pytest.mark.slow
def test_a_pulse_over_time_is_no_law_over_a_temperature_that_follows_the_time() -> None:
    rng = np.random.default_rng([8802, 4])
    texts = law_case(rng, "fork", "lubrication")
    found = learn_laws(read_back(texts[0], MACHINES["fork"]))
    (pulse,) = [one.law for one in found.laws]
    assert [factor.name for factor in pulse.factors] == ["pulse time"]
    assert pulse.places == pytest.approx((2500.0, 900.0), rel=0.02)
    assert not found.laws[0].travels


@pytest.mark.slow
def test_a_set_up_that_cells_left_out_extrapolate_refuses_no_law() -> None:
    texts = law_case(np.random.default_rng([60611, 9]), "hmc1995", "temperature_position")
    run, second, free = (read_back(text, MACHINES["hmc1995"]) for text in texts[:3])
    found = learn_laws(run)
    (law,) = [one.law for one in found.laws]
    assert [factor.name for factor in law.factors] == ["quad Y", "lin T-spindle"]
    true = error_left(fit_beside(0.0, free, ordinary_model(free.touches.chain)))
    assert second_run(found, second).learnt < 1.1 * true < 0.9 * second_run(found, second).without


@pytest.mark.slow
def test_a_factor_that_hardly_changes_is_left_out_of_a_product() -> None:
    text, *_ = law_case(np.random.default_rng([60611, 11]), "fork", "chiller")
    (saw,) = [one.law for one in learn_laws(read_back(text, MACHINES["fork"])).laws]
    assert [factor.name for factor in saw.factors] == ["saw time"]
    assert saw.tuning["period"] == pytest.approx(1300.0, rel=0.01)


def test_touches_that_contradict_a_law_of_another_run_are_no_gross_errors() -> None:
    """Without those that a saw-tooth at another phase moved most, the error fell by 5 %."""
    _, text, _, _ = law_case(np.random.default_rng([71102, 11]), "fork", "chiller")
    run = read_back(text, MACHINES["fork"])
    chain = run.touches.chain
    saw = parse_effect("law(EXX,saw time)", chain).tuned(1300.0, 0.0)
    model = Model(chain, (*ordinary_model(chain).effects, saw))
    theta = np.zeros(len(model.parameters))
    theta[-1] = 7.4e-3
    other = EffectOfOtherRun(effect=saw, owner="run", inner={}, run="first.csv", share=0.0)
    assert judged_laws(model, theta, [other], run, "first.csv") == ((), ())


def test_another_run_is_predicted_less_surely_by_the_size_of_the_law(stylus) -> None:
    _, (run, second, _), found = stylus
    text = model_text(found.saved, "run")
    own, other = (parsed_model(text, "model.toml", runs=[r]) for r in (run, second))
    law = found.laws[0].law
    (size,) = found.saved.theta[found.saved.of_effect(law.name)]
    assert own.left_out == ()
    assert [one.effect.name for one in other.left_out] == [law.name]
    (margin,) = [e for e in other.model.effects if e.name == "law(bias,course time)"]
    C = columns([margin], second.touches)
    # by hand: the reading of the probe moves by the size of the step, either way, at any time
    u2 = np.mean((C**2).sum(axis=1))
    assert u2 == pytest.approx(size**2, rel=0.1)
    theta, sd = other.estimates.mean[-C.shape[1] :], other.estimates.sd[-C.shape[1] :]
    np.testing.assert_allclose(theta, 0.0)
    np.testing.assert_allclose(sd, 1.0)
    assert compare(second, other).u.mean() > 1.5 * compare(run, own).u.mean()


def test_a_law_over_a_temperature_that_belongs_to_its_run_may_take_any_course_in_another(stylus):
    """Its driver was not recorded: at all times it is as unsure as it was large."""
    _, (run, second, _), _ = stylus
    chain, touches = run.touches.chain, run.touches
    law = replace(parse_effect("law(EZX,step T-spindle)", chain), is_of_run=True)
    law = law.tuned(float(np.median(touches.temperature["spindle"])))
    theta = np.array([7.0 * UM])
    model = Model(chain, (law, *law.beyond(theta, touches)))
    other = EffectOfOtherRun(law, "run", {}, "run", 0.0)
    (course,) = unknown_elsewhere(model, np.append(theta, [0.0, 0.0]), [other])
    amount = np.stack(course.amounts(second.touches), axis=1)
    # by hand: either way by the height of the step, whatever the time
    assert np.mean((amount**2).sum(axis=1)) == pytest.approx((7.0 * UM) ** 2, rel=0.1)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("law(EXX,exp time)", "had not come to rest"),
        ("law(EXX,step time,two-exp time)", "was not recorded and switches"),
        ("law(EXX,curve time)", "A driver that was not recorded belongs to this run"),
        ("law(EXX,step T-spindle)", "a driver that was not recorded (odds 20 : 1 against that)"),
    ],
)
def test_why_a_law_belongs_to_its_run_is_said(name, said, stylus) -> None:
    law = parse_effect(name, stylus[1][0].touches.chain)
    one = LearntLaw(law, (), score=np.log(20.0), charge=0.0, curve=0.0, drift=0.0, rivals=())
    assert said in run_sentence(one)
    if "T-" in name:  # beyond the odds below which a law may stand for another driver
        assert "only rose or fell in this run" in run_sentence(replace(one, score=11.0))


def test_few_touches_leave_no_law_and_that_is_said() -> None:
    text, *_ = law_case(np.random.default_rng(5), "hmc1995", "stylus", (30.0, 31.0), poses=2)
    run = read_back(text, MACHINES["hmc1995"])
    few = learn_laws(run[:28])
    assert (few.laws, few.refusal) == ((), Refusal.FEW)
    assert no_law_sentence(few).startswith("No law was looked for: 28 touches")
    warm = {"spindle": np.where(np.arange(len(run)) < 25, 20.0, 21.0)}
    two = learn_laws(replace(run[:50], touches=replace(run.touches, temperature=warm)[:50]))
    said = " ".join(limits_sentences(two))
    assert "From 50 touches only a law far above the noise" in said
    assert "Of temperature spindle, which has two values, only a step can be learnt." in said


def test_a_run_of_one_pose_says_what_it_cannot_show() -> None:
    text, *_ = law_case(np.random.default_rng(5), "hsm600u", None, poses=1)
    run = read_back(text, MACHINES["hsm600u"])
    first = np.flatnonzero(run.touches.setup == 0)
    assert "All touches are in one pose" in " ".join(limits_sentences(learn_laws(run[first])))


def test_laws_are_learnt_in_the_place_of_imitators_alone(slipped) -> None:
    searched, _ = slipped
    # nothing remains, and no effect was found that could imitate a law
    assert learn_remainder(searched.start, searched.start, is_left=False) is None
    named = _determined(searched.fit, searched.found[0])
    assert 1.0 < named <= len(searched.found[0].parameters)


@pytest.mark.slow
def test_a_formula_that_grows_into_a_corner_is_not_taken_for_a_wave_along_a_diagonal() -> None:
    """It predicted a second run, which went farther into it, with 1.63 um instead of 1.04."""
    texts = law_case(np.random.default_rng([71102, 14]), "fork", "diagonal")
    run, second = (read_back(text, MACHINES["fork"]) for text in texts[:2])
    found = second_run(learn_laws(run), second)
    assert found.learnt < 1.02 * found.without


def test_a_formula_is_not_largest_at_a_gross_error(stylus) -> None:
    """A bump at one touch alone explains whatever stands there."""
    found = stylus[2]
    touches = found.before.run.touches
    x = touches.reading("X")
    row = int(np.argmax(x))
    law = parse_effect("law(EXX,exp X)", touches.chain).tuned(float(x[row]), -0.5)
    apart = replace(found.before.gross, rows=np.arange(len(x)) == row)
    assert np.abs(law.amounts(touches)[0])[row] == 1.0
    for gross, is_kept in ((found.before.gross, True), (apart, False)):
        fits = (found.beginning.fitted([], gross=gross), found.beginning.fitted([law], gross=gross))
        assert holds_where_largest(*fits, law, POLICY) == is_kept


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("law(EXX,bump T-spindle)", "run"),
        ("law(EXX,lin T-spindle)", "machine"),  # a body that expands in proportion
        ("law(EXX,bump T-room)", "machine"),
        ("law(EXX,log time)", "machine"),  # a creep from the start of every run, which came to rest
    ],
)
def test_a_temperature_that_only_rises_is_a_clock_of_its_run(name, owner, stylus) -> None:
    touches = stylus[1][0].touches
    since = touches.since_start / touches.since_start[-1]
    readings = {"spindle": 20.0 + since**2, "room": 20.0 + np.sin(12.0 * since)}
    touches = replace(touches, temperature=readings)
    law = parse_effect(name, touches.chain)
    places = {"bump": (20.5, 1.0), "log": (0.0, 60.0)}
    law = law.tuned(*places.get(law.factors[0].shape.word, ()))
    one = LearntLaw(law, (), score=100.0, charge=0.0, curve=0.0, drift=0.0, rivals=())
    assert _of_its_run(one, touches, POLICY).law.belongs_to == owner


def test_a_law_is_charged_its_parameters_and_the_choice_among_many(stylus) -> None:
    """An amplitude and an instant, half a log of the observations each; a shape of one variable."""
    found = stylus[2]
    observations = Space.of(found.before).freedom
    assert found.laws[0].charge == pytest.approx(np.log(observations) + POLICY.tried_singles)


def test_a_slip_that_turns_nothing_is_not_withdrawn_for_a_step() -> None:
    """With fewer parameters the step has the better evidence; it is the slip nevertheless."""
    rng = np.random.default_rng(1)
    experiment = random_experiment(rng, "hmc1995", 4)
    moved = slip(0.55, np.array([0.6, 0.0, 0.8]))
    moved.amplitude = 15.0
    noise = rng.normal(0.0, STATED_NOISE, len(experiment.time))
    text = run_text(experiment, probe(experiment, [moved], noise), False)
    found = diagnose(read_back(text, MACHINES["hmc1995"]), only=["artefact-slip"])
    assert [effect.name for effect in found.found] == ["artefact-slip"]
    assert found.withdrawn == ()


def test_no_law_is_a_product_of_two_temperatures(stylus) -> None:
    """A drift that both follow was learnt as one, and predicted another run worse than none."""
    space, field = Space.of(stylus[2].before), Ground.of(stylus[2].before.run).field
    level = next(driver for driver in field.drivers if driver.nature == "level")
    C = spread(field.bearers[0].C, level.values(space.touches)[:, None])
    others = {driver for driver, _ in modulations(space, field, C, level)} - {level}
    assert others
    assert {driver.nature for driver in others} <= {"linear", "rotary", "sign"}


def test_the_command_writes_an_effect_that_the_other_commands_take(
    stylus, tmp_path, capsys, rendered_alone, monkeypatch, unchanged
) -> None:
    figures, (texts, _, found) = rendered_alone(), stylus

    def learnt(run, model):
        """What the session has learnt of this run beside this model."""
        np.testing.assert_array_equal(run.deviation, found.before.run.deviation)
        assert model.names == found.before.model.names
        return found

    for name, text in (("run.csv", texts[0]), ("two.csv", texts[1])):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "machine.toml").write_text(MACHINES["hmc1995"], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr("matstd.api.learning.learn_laws", learnt)
    out = tmp_path / "out"
    assert main(["learn", "run.csv", "--second-run", "two.csv", "-o", "out"]) == 0
    # of curves and rivals the search ends elsewhere on another processor
    unsteady = r".*(?:of_curve|rivals.*parameters|residuals\.change|~ ).*\n"
    written = re.sub(unsteady, "", folder_text(out, figures))
    unchanged(f"{capsys.readouterr().out}\n{written}\n")
    effect = out / "effect.py"
    ruff = [sys.executable, "-m", "ruff", "check", "-q", "--select", "E9,F", str(effect)]
    subprocess.run(ruff, check=True)
    # what the run determines stands in the model, as in that of a diagnosis
    determined = read_model(out / "model.toml").determined
    assert determined
    assert all(row.estimate.u > 0.0 for row in determined)
    model = ["--model", str(out / "model.toml"), "--no-report", "-o", str(tmp_path / "compared")]
    assert main(["compare", str(tmp_path / "two.csv"), *model]) == 0
    own = ["--effects", str(effect), "--no-report", "-o", str(tmp_path / "own")]
    assert main(["compare", str(tmp_path / "two.csv"), *own]) == 0
    assert parse_effect("learnt-law", stylus[1][0].touches.chain).name == "learnt-law"


def test_rivals_of_other_kinds_are_weighed_by_the_same_evidence(stylus) -> None:
    _, (run, *_), found = stylus
    (one,) = found.laws
    assert found.refusal is Refusal.CHANCE  # of a second law
    assert one.memory < one.score  # a step is seen as a memory, too, but less well
    assert one.drift < one.score
    effect = parse_effect("backlash(X)", run.touches.chain)
    near, better = (
        replace(one, rivals=(), library=LibraryEffect(effect, one.score + more))
        for more in (2.0, POLICY.class_odds + 1.0)
    )
    assert weighed(one, False, POLICY) is None
    assert weighed(near, False, POLICY) is None  # both predict, by their odds
    assert near.members(POLICY) == [(one.law, 1.0)]  # it belongs to its run, and predicts no other
    lasting = replace(near, law=parse_effect("law(bias,step Z)", run.touches.chain))
    shares = [share for _, share in lasting.members(POLICY)]
    assert shares == pytest.approx([0.119, 0.881], abs=1e-3)
    assert weighed(better, False, POLICY) is Refusal.LIBRARY
    assert weighed(better, True, POLICY) is None  # a diagnosis has looked for it already
    assert weighed(replace(one, memory=one.score + 1.0), True, POLICY) is Refusal.MEMORY
    none = replace(found, laws=(), refused=better, refusal=Refusal.LIBRARY)
    assert 'matstd diagnose --add "backlash(X)"' in no_law_sentence(none)


@pytest.mark.slow
def test_a_law_that_few_touches_show_is_no_row_of_gross_errors(stylus) -> None:
    """Six touches beyond an edge stand out like chips; six chips of the same size have no law."""
    run = stylus[1][2]
    law = parse_effect("law(EZZ,step Z)", run.touches.chain)
    z = np.sort(run.touches.reading("Z"))
    moved = columns([law.tuned(0.5 * (z[-7] + z[-6]))], run.touches) @ [14.0 * UM]
    assert np.count_nonzero(moved) == 6
    hidden = replace(run, deviation=run.deviation + moved)
    assert fit_run(hidden, ordinary_model(run.touches.chain)).gross.rows[moved != 0.0].sum() >= 4
    found = learn_laws(hidden)
    assert [d.name for one in found.laws for d in one.law.drivers] == ["Z"]
    assert found.after.used[moved != 0.0].all()
    rng = np.random.default_rng(3)
    chips = np.zeros(len(run))
    chips[rng.choice(len(run), 6, replace=False)] = rng.uniform(10.0, 15.0, 6) * UM
    nothing = learn_laws(replace(run, deviation=run.deviation + chips))
    assert nothing.laws == ()
    assert nothing.after is nothing.before


@pytest.mark.usefixtures("unrendered")
def test_a_diagnosis_learns_the_law_of_what_remains(stylus, tmp_path) -> None:
    _, (run, second, _), learnt = stylus
    found = diagnose(run, only=["backlash"])
    assert found.verdict is Verdict.UNEXPLAINED
    (one,) = found.laws.laws
    assert one.law.name == learnt.laws[0].law.name
    assert "; learnt law: the reading of the probe" in dict(part_lines(found))["what remains"]
    found.write(tmp_path)
    table = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert table["learnt"]["laws"][0]["law"] == one.law.name
    assert table["learnt"]["with_um"] < table["learnt"]["without_um"]
    assert {"effect.py", "law.json", "model.toml"} <= {p.name for p in tmp_path.iterdir()}
    # console and model file state one error, which another run at other places meets
    promised = found.model.source.promise
    assert promised.same == pytest.approx(found.promise.same, rel=1e-5)
    assert promised.elsewhere == pytest.approx(found.promise.elsewhere, rel=1e-5)
    assert 0.8 < compare(second, found.model).rms / promised.elsewhere < 1.25
    # before and after are of one kind, also where a choice stated its own blocks before
    blocks = Promise(99.0 * UM, 99.0 * UM, ())
    again = replace(found, laws=None, promise_before=blocks).with_laws(found.laws)
    assert again.promise_before.same == pytest.approx(found.start.test_rms)
    # the geometry beside the law predicts, that of the start had taken a part of it
    assert compare(second, found.model).rms < 0.9 * compare(second, model_of(found.start)).rms


def test_waves_over_even_readings_end_at_twice_their_distance(stylus) -> None:
    """On targets every 15.625 mm a wave of 0.582 mm gives the same readings as one of 97 mm."""
    even = np.linspace(0.0, 500.0, 33)
    same = [np.exp(2j * np.pi * even * f) for f in (1.0 / 97.0, 27.0 / 15.625 - 1.0 / 97.0)]
    assert np.abs(same[0] - same[1].conj()).max() < 1e-9
    linear = next(d for d in Ground.of(stylus[2].before.run).field.drivers if d.nature == "linear")
    assert 0.5 / _quick_frequencies(linear, np.tile(even, 6)).max() > 15.625
    assert len(_quick_frequencies(linear, np.linspace(0.0, 400.0, 9))) == 0
    uneven = even + np.random.default_rng(3).uniform(-6.0, 6.0, len(even))
    assert 0.5 / _quick_frequencies(linear, uneven).max() < 0.5


def test_a_scan_ranks_points_as_least_squares_do(stylus) -> None:
    _, _, found = stylus
    fit, ground = found.before, Ground.of(found.before.run)
    space, factor = Space.of(fit), fit.noise.factor
    X = np.vstack([fit.X[fit.used] * factor, np.eye(fit.X.shape[1])])
    y = np.r_[fit.y[fit.used] * factor, np.zeros(X.shape[1])]

    def beside_model(columns_there) -> np.ndarray:
        return columns_there - X @ np.linalg.lstsq(X, columns_there)[0]

    bearers = {b.carrier.name: b for b in ground.field.bearers}
    variables = {d.name: d for d in ground.field.drivers}
    compared = 0
    for carrier, variable in (("bias", "time"), ("shift", "X"), ("EXX", "T-spindle")):
        C = bearers[carrier].C
        for part, explained, _ in scan(space, ground.grids, C, variables[variable]):
            law = spread(C, columns_of(ground.field, space, [part]))[fit.used]
            law = np.vstack(
                [law / np.linalg.norm(law, axis=0), np.zeros((X.shape[1], law.shape[1]))]
            )
            own, size, _ = np.linalg.svd(beside_model(law), full_matrices=False)
            if size[-1] ** 2 > 1e-3:  # else the model imitates a part of it
                along = own.T @ beside_model(y)
                assert explained == pytest.approx(along @ along, rel=1e-3, abs=1e-3)
                compared += 1
    assert compared > 30


def test_no_curve_is_offered_over_a_direction(stylus) -> None:
    """A temperature rises, falls or stays: three values, but no curve through them."""
    run = stylus[2].before.run
    cycles = np.clip(np.sin(np.linspace(0.0, 9.0, len(run))), -0.5, 0.5)
    touches = replace(run.touches, temperature={"room": 20.0 + cycles})
    space, ground = Space.of(stylus[2].before), Ground.of(replace(run, touches=touches))
    every = by_evidence(space, ground.curves)
    signs = [f for f in every if f.drivers[0].nature == "sign"]
    assert any(len(np.unique(ground.field.x[f.drivers[0].name])) == 3 for f in signs)
    assert curve_laws(space, ground.field, signs, [], POLICY) == []


@pytest.fixture(scope="module")
def slipped(stylus):
    """The stylus change, of which a search finds a slip of the set-up, and its law."""
    run, learnt = stylus[1][0], stylus[2]
    slip = [parse_effect("artefact-slip", run.touches.chain)]
    searched = answer.diagnose(run, candidates=slip, rng=np.random.default_rng(0))
    return searched, replace(learnt, instead_of=searched.found, instead_odds=np.log(1000.0))


def test_the_headline_leads_with_the_law_and_withdraws_the_names(slipped) -> None:
    searched, learnt = slipped
    assert [effect.name for effect in searched.found] == ["artefact-slip"]
    assert "slip of the set-up" in verdict_sentence(searched).partition(".")[0]
    found = searched.with_laws(learnt)
    said = verdict_sentence(found)
    assert said.startswith("The model lacks a law that the library does not have: the reading of")
    assert "a step over time" in said.partition(" Withdrawn: ")[0]
    withdrawn = said.partition(" Withdrawn: ")[2]
    assert withdrawn.startswith("artefact-slip, which imitates a part of it")
    assert "odds 1000 : 1" in withdrawn
    assert "slip" not in said.partition(" Withdrawn: ")[0]
    assert dict(part_lines(found))["named effects"].startswith("withdrawn: slip of the set-up")
    assert diagnosis_step(found, "run.csv").startswith("Look for the cause of the learnt law")
    table = diagnosis_table(found)
    law = learnt.laws[0].law.name
    assert table["headline"] == {"effects": [], "laws": [law], "withdrawn": ["artefact-slip"]}
    # what the search found stays where programs look for it
    before = diagnosis_table(searched)
    assert (table["verdict"], table["steps"]) == (before["verdict"], before["steps"])
    assert [one["in_headline"] for one in table["parts"]["named"]] == [False]
    # the error to expect is that of the law, which leaves the noise alone
    assert found.promise.same < searched.promise.same
    assert found.plans == ()


def test_a_law_that_is_of_the_library_withdraws_no_name_of_its_class(slipped) -> None:
    """Whether the library's effect is of the class of the name, the search has weighed."""
    searched, learnt = slipped
    drift = parse_effect("drift", searched.run.touches.chain)
    laws = tuple(replace(law, library=LibraryEffect(drift, law.score)) for law in learnt.laws)
    learnt = replace(learnt, laws=laws)
    parts = replace(searched.parts, remains=replace(searched.parts.remains, is_real=False))
    (slip,) = [one for one in searched.candidates if one.effect == "artefact-slip"]
    for odds, withdrawn in ((2.0, ()), (-2.0, ()), (20.0, searched.found)):
        other = replace(slip, effect="drift", log_odds=slip.log_odds + odds)
        found = replace(searched, parts=parts, candidates=(slip, other)).with_laws(learnt)
        assert found.withdrawn == withdrawn
        assert (" Withdrawn: " in verdict_sentence(found)) == bool(withdrawn)


def test_a_name_beside_which_a_law_stands_is_not_withdrawn(slipped) -> None:
    searched, learnt = slipped
    found = searched.with_laws(replace(learnt, instead_of=(), instead_odds=0.0))
    assert found.withdrawn == ()
    assert found.standing is learnt.after
    assert "Withdrawn" not in verdict_sentence(found)
    # what predicts has both, so the error falls with both
    fall = f"{found.promise_before.elsewhere / UM:.2f} µm to {found.promise.elsewhere / UM:.2f} µm"
    assert f"With it and the law the error to expect at other places falls from {fall}" in (
        verdict_sentence(found)
    )
    headline = diagnosis_table(found)["headline"]
    assert (headline["effects"], headline["withdrawn"]) == (["artefact-slip"], [])
    assert headline["laws"] == [learnt.laws[0].law.name]


@pytest.mark.slow
def test_a_diagnosis_withdraws_an_imitation_and_keeps_an_effect_of_the_library(stylus) -> None:
    """The slip imitates the stylus; growth of a scale that the simulator has beside it is none."""
    found = diagnose(stylus[1][0], only=["artefact-slip"])
    assert [effect.name for effect in found.withdrawn] == ["artefact-slip"]
    assert found.parts.headline == ()
    rng = np.random.default_rng(5)
    experiment = random_experiment(rng, "hmc1995", 6)
    still = np.zeros(len(experiment.time))
    plain = run_text(experiment, probe(experiment, [], still), False)
    ordinary = Ordinary(read_back(plain, MACHINES["hmc1995"]).touches)
    law, _ = drawn(rng, experiment, "stylus", (30.0, 31.0), ordinary, "hmc1995")
    grown = hidden_effect(rng, experiment.machine, "thermal-expansion(Y,scaleY)")
    grown.amplitude = 30.0 / visible_size(experiment, grown, ordinary, STATED_NOISE)[0]
    noise = rng.normal(0.0, STATED_NOISE, len(still))
    text = run_text(experiment, probe(experiment, [grown, law], noise), False)
    found = diagnose(read_back(text, MACHINES["hmc1995"]), only=["thermal-expansion"])
    assert [effect.name for effect in found.found] == [grown.name]
    assert found.laws.laws[0].law.name == "law(bias,step time)"
    assert found.withdrawn == ()
    assert [one.effect.name for one in found.parts.headline] == [grown.name]
    size = found.steps[1].size
    assert abs(abs(size.value) - grown.amplitude) < 4.0 * size.u


def test_a_name_of_whose_kind_the_library_explains_a_law_better_stays(stylus) -> None:
    run = stylus[1][0]
    lag, table, other = (
        parse_effect(name, run.touches.chain)
        for name in ("thermal-lag(EZZ)", "position-table(EYX)", "thermal-lag(EXX)")
    )
    explains = [LibraryEffect(other, 9.0), LibraryEffect(other, 5.0)]
    laws = [LearntLaw(lag, (), 7.0, 7.0, 0.0, 0.0, (), library=one) for one in explains]
    learning = SimpleNamespace(laws=laws)
    assert [one.is_of_library for one in laws] == [True, False]
    assert _of_library(learning, (table, lag)) == [lag]
    assert _of_library(SimpleNamespace(laws=laws[1:]), (table, lag)) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", [22, 23])
def test_a_growth_stays_beside_a_law_that_another_name_imitates(seed) -> None:
    """A growth with the spindle, and a cover that pushes X aside beyond 30 mm, by the simulator."""
    rng = np.random.default_rng(seed)
    experiment = random_experiment(rng, "hsm600u", 10)
    still = np.zeros(len(experiment.time))
    plain = run_text(experiment, probe(experiment, [], still), False)
    ordinary = Ordinary(read_back(plain, MACHINES["hsm600u"]).touches)

    def pushed(s, a):
        return {"EYX": a * SMALL * -np.expm1(-np.maximum(0.0, s.q["X"] - 30.0) / 45.0)}

    cover = Hidden("?cover", "unknown", pushed)
    grown = hidden_effect(rng, experiment.machine, "thermal-lag(EZZ,spindle)")
    for one, visible in ((cover, 25.0), (grown, 60.0)):
        one.amplitude = visible / visible_size(experiment, one, ordinary, STATED_NOISE)[0]
    noise = rng.normal(0.0, STATED_NOISE, len(still))
    text = run_text(experiment, probe(experiment, [grown, cover], noise), False)
    found = diagnose(read_back(text, MACHINES["hsm600u"]), auto=True)
    assert [effect.name for effect in found.withdrawn] == ["position-table(EYX)"]
    (law,) = found.laws.laws
    assert (law.law.carrier.name, law.law.factors[0].driver.name) == ("EYX", "X")
    (lag,) = found.parts.headline
    assert "spindle" in lag.effect.name
    alike = {rival.effect.name for rival in found.steps[1].confusion.rivals}
    assert "thermal-lag(EZZ,spindle)" in {lag.effect.name, *alike}
    size = found.steps[1].size
    assert abs(abs(size.value) - abs(grown.amplitude)) < 4.0 * size.u


@pytest.mark.slow
def test_effects_that_explain_nothing_give_way_to_the_law(stylus) -> None:
    run = stylus[1][0]
    start = fit_run(run, ordinary_model(run.touches.chain))
    model = start.model
    wrong = [parse_effect(f"backlash({axis})", model.chain) for axis in "XYZ"]
    end = fit_run(start.run, Model(model.chain, (*model.effects, *wrong)))
    found = learn_remainder(start, end)
    assert list(found.instead_of) == wrong
    assert found.instead_odds > POLICY.shorter
    assert len(found.after.model.effects) == len(model.effects) + 1


def test_a_saved_law_is_less_sure_beyond_the_values_it_was_learnt_from(stylus) -> None:
    _, (run, *_), _ = stylus
    q = run.touches.reading("Y")
    near = run[q < np.quantile(q, 0.6)]
    law = parse_effect("law(EZY,bump Y)", run.touches.chain).tuned(float(q.min()), 40.0)
    hidden = 20.0 * UM * columns([law], near.touches)[:, 0]
    start = Beginning.of_run(replace(near, deviation=near.deviation + hidden))
    after = start.fitted([law])
    one = LearntLaw(law, (), 0.0, 0.0, 0.0, 0.0, ())
    found = Learning(start, after, after, (one,), None, None, (), POLICY)
    (beyond,) = found.saved.model.effects[-1:]
    count = len(after.model.parameters)
    np.testing.assert_allclose(found.saved.theta[:count], after.theta[:count], atol=1e-9)
    np.testing.assert_allclose(found.saved.theta[found.saved.of_effect(beyond.name)], 0, atol=1e-9)
    # by hand: far beyond the touches the variance that comes back is the square of the law's size
    edge = float(near.touches.reading("Y").max())
    (amplitude,) = after.theta[after.of_effect(law.name)]
    size = abs(amplitude) * np.exp(-(((near.touches.reading("Y") - q.min()) / 40.0) ** 2))
    far = 10.0 * (edge - q.min())
    (_, above) = beyond.factors[0].shape.values(np.array([edge, edge + far]), *beyond.places)
    assert above[0] == 0.0
    assert above[1] == pytest.approx(size.max(), rel=1e-6)
    u = [compare(run, model_of(fit)).u for fit in (found.saved, after)]
    wider = u[0] / u[1]
    assert np.median(wider[q > edge + 0.2 * (edge - q.min())]) > 1.2 * np.median(wider[q < edge])


def test_a_model_predicts_the_average_over_laws_that_its_run_does_not_distinguish(stylus) -> None:
    """By hand: means of either law weighed 3 : 1, variances with the squares of their distance."""
    _, (run, second, _), _ = stylus
    chain = run.touches.chain
    x, y = (float(np.median(run.touches.reading(axis))) for axis in "XY")
    law, other = (
        parse_effect(f"law(EZY,bump {axis})", chain).tuned(place, 60.0)
        for axis, place in (("Y", y), ("X", x))
    )
    hidden = 4.0 * UM * columns([law], run.touches)[:, 0]
    start = Beginning.of_run(replace(run, deviation=run.deviation + hidden))
    after = start.fitted([law])
    one = LearntLaw(law, (), 0.0, 0.0, 0.0, 0.0, (Rival(other, np.log(3.0)),))
    found = Learning(start, after, after, (one,), None, None, (), POLICY)
    text = model_text(found.saved, "run", shares=found.shares)
    entries = {e["name"]: e for e in tomllib.loads(text)["effect"]}
    assert [entries[e.name]["share"] for e in (law, other)] == pytest.approx([0.75, 0.25])
    assert all("share" not in e for name, e in entries.items() if not name.startswith("law("))
    saved = parsed_model(text, "model.toml")
    # what the geometry takes up is uncertain by millimetres, and alike in both
    Q = np.linalg.qr(start.fit.model.columns(second.touches))[0]

    def bare(columns_):
        return columns_ - Q @ (Q.T @ columns_)

    C = bare(saved.model.columns(second.touches))
    mean, u2 = C @ saved.estimates.mean, ((C @ saved.estimates.root) ** 2).sum(axis=1)
    means, variances = [], []
    for each in (law, other):
        alone, fit = (start.fitted([each], free, gross=after.gross) for free in (False, True))
        # beyond the values that were seen zero is as unsure as the law is large
        margins = each.beyond(alone.theta[alone.of_effect(each.name)], run.touches[after.used])
        A, B = bare(fit.model.columns(second.touches)), bare(columns(margins, second.touches))
        P = A.shape[1]
        means.append(A @ alone.theta[:P])
        known = np.einsum("np,pq,nq->n", A, fit.covariance[:P, :P], A)
        variances.append(known + (B**2).sum(axis=1))
    expected = 0.75 * means[0] + 0.25 * means[1]
    apart = 0.75 * (means[0] - expected) ** 2 + 0.25 * (means[1] - expected) ** 2
    np.testing.assert_allclose(mean, expected, atol=1e-6 * UM)
    wanted = 0.75 * variances[0] + 0.25 * variances[1] + apart
    np.testing.assert_allclose(u2, wanted, rtol=0.02)
    assert (apart > variances[0]).sum() > 20
    # what the laws add to another run is the average of what either adds
    added = [
        share * columns([each], second.touches) @ fit.theta[fit.of_effect(each.name)]
        for share, each in ((0.75, law), (0.25, other))
        for fit in [start.fitted([each], gross=after.gross)]
    ]
    np.testing.assert_allclose(found.predicted(second), sum(added), atol=1e-6 * UM)
    again = compare(found.before.run, parsed_model(text, "model.toml", runs=[found.before.run]))
    np.testing.assert_allclose(again.fit.residual, found.saved.residual, atol=1e-3 * UM)


def test_a_law_that_a_run_speaks_against_is_not_expected_there(stylus) -> None:
    _, (run, second, _), _ = stylus
    law = parse_effect("law(EZY,bump Y)", run.touches.chain)
    law = law.tuned(float(np.median(run.touches.reading("Y"))), 60.0)

    def moved(one):
        return replace(one, deviation=one.deviation + 4.0 * UM * columns([law], one.touches)[:, 0])

    start = Beginning.of_run(moved(run))
    after = start.fitted([law])
    one = LearntLaw(law, (), 0.0, 0.0, 0.0, 0.0, ())
    found = Learning(start, after, after, (one,), None, None, (), POLICY)
    text = model_text(found.saved, "monday.csv", shares=found.shares)
    assert "share =" not in text
    shown, absent, known = (
        parsed_model(text, "model.toml", runs=[r]) for r in (moved(second), second, start.run)
    )
    assert shown.refuted == () == known.refuted
    (said,) = absent.refuted
    assert said.effect.name == law.name
    assert "touches of this run speak against it" in remark_sentence(said)
    (own,) = np.flatnonzero([e.name == law.name for e, _ in absent.model.parameters])
    assert absent.estimates.mean[own] == 0.0
    amplitude = abs(after.theta[after.of_effect(law.name)][0])
    assert absent.estimates.sd[own] == pytest.approx(amplitude)
    # every other estimate stays
    others = np.arange(len(absent.estimates)) != own
    np.testing.assert_array_equal(absent.estimates.mean[others], shown.estimates.mean[others])


def test_a_run_of_one_pose_leaves_carriers_that_other_poses_distinguish() -> None:
    """B tilts the table C: only at B = 0 is "along Z" the same for C as for the axes beside it."""
    texts = law_case(np.random.default_rng(3), "hsm600u", "kink", (30.0, 31.0), poses=3)
    run = read_back(texts[0], MACHINES["hsm600u"])
    touches = run[run.touches.reading("B") == 0.0].touches
    law = parse_effect("law(EZY,lin Y)", touches.chain)
    alike = [carrier_of(name, touches.chain) for name in ("EZX", "EZB", "EZC", "EZZ")]
    columns_ = [one.columns(touches) for one in (law.carrier, *alike)]
    np.testing.assert_allclose(np.abs(columns_[1:]), np.abs(columns_[:1]).repeat(4, 0), atol=1e-9)
    assert [c.name for c in apart_elsewhere(law.carrier, alike, touches)] == ["EZC"]
    assert apart_elsewhere(law.carrier, alike[:2], touches) == []
    one = LearntLaw(law, tuple(alike), 9.0, 0.0, 0.0, 0.0, (), elsewhere=(alike[2],))
    members = {law.name: share for law, share in one.members(POLICY)}
    assert members == {"law(EZY,lin Y)": 0.5, "law(EZC,lin Y)": 0.5}


def test_a_curve_is_saved_and_is_uncertain_where_it_has_not_been(stylus, tmp_path) -> None:
    run = stylus[1][0]
    q = run.touches.reading("Y")
    near = run[q < np.quantile(q, 0.6)]
    chain = run.touches.chain
    low, high = (f(near.touches.reading("Y")) for f in (np.min, np.max))
    size = 20.0 * UM
    curve = parse_effect("law(EZY,curve Y)", chain).tuned(low, high, 0.2, size)
    model = ordinary_model(chain)
    fit = fit_run(near, Model(chain, (*model.effects, curve)))
    (tmp_path / "model.toml").write_text(model_text(fit, "near.csv"), encoding="utf-8")
    saved = read_model(tmp_path / "model.toml")
    text = (tmp_path / "model.toml").read_text(encoding="utf-8")
    assert text.startswith('format = "model/2"')
    (table,) = tomllib.loads(text)["curve"]
    assert (table["carrier"], table["variable"], table["unit"]) == ("EZY", "Y", "um")
    x, value, u = (np.array(table[key]) for key in ("x", "value", "u"))
    inside = (x > low) & (x < high)
    # by hand: Matern 3/2, its variance with the edge's share k^2 and what is new, 1 - k^2
    z = np.sqrt(3.0) * (x[-1] - high) / (0.2 * (high - low))
    k = (1.0 + z) * np.exp(-z)
    edge = np.interp(high, x, u)
    assert u[-1] == pytest.approx(np.hypot(k * edge, np.sqrt(1.0 - k**2) * size / UM), rel=0.02)
    assert u[inside].max() < u[-1]
    assert abs(value[-1]) < abs(np.interp(high, x, value)) + 1e-9
    # the whole run reaches further: what is predicted there is as uncertain as the curve
    plain = compare(run, model_of(fit_run(near, model))).u
    wider = compare(run, saved).u / plain
    far, known = (q > high + 0.2 * (high - low)), (q > low) & (q < high)
    assert np.median(wider[far]) > 1.2 * np.median(wider[known])
    u_again = np.linalg.norm(saved.model.columns(near.touches) @ saved.estimates.root, axis=1)
    P = len(fit.model.parameters)
    own = fit.model.columns(near.touches)
    before = np.sqrt(np.einsum("np,pq,nq->n", own, fit.covariance[:P, :P], own))
    np.testing.assert_allclose(u_again, before, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "label", "family"),
    [
        (1, "hsm600u", "gate"),
        (2, "hsm600u", "harmonic_by_direction"),
        (3, "fork", "worn_zone"),
        (4, "fork", "loop"),
        (5, "hsm600u", "cogging"),
    ],
)
def test_products_and_plateaus_are_found(seed, label, family) -> None:
    *texts, truth = law_case(np.random.default_rng(seed), label, family, (30.0, 40.0))
    run, second, free = (read_back(text, MACHINES[label]) for text in texts)
    found = learn_laws(run)
    assert found.laws
    names = {f.driver.name for f in found.laws[0].law.factors}
    assert names == set(truth["hidden"][0]["variables"])
    model = ordinary_model(run.touches.chain)
    true = np.median(free.u) * fit_run(free, model).noise.chi2_ratio ** 0.5
    assert second_run(found, second).learnt < 1.1 * true


@pytest.mark.slow
def test_a_product_that_gross_errors_hid_is_found_beside_another_law() -> None:
    """The 21 touches of the gate stand out as chips; its step makes a smooth surface fail."""
    rng = np.random.default_rng([1, 3])
    *texts, _ = law_case(rng, "fork", "relaxing+gate")
    run, second, free = (read_back(text, MACHINES["fork"]) for text in texts)
    found = learn_laws(run)
    variables = [{f.driver.name for f in one.law.factors} for one in found.laws]
    assert variables == [{"since-setup"}, {"X", "Y"}]
    true = error_left(fit_beside(0.0, free, ordinary_model(free.touches.chain)))
    assert second_run(found, second).learnt < 1.1 * true
