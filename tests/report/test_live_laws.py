"""Laws on the live page: their figures against the fits, their curves against the touches."""

import json
from dataclasses import fields, replace

import numpy as np
import pytest
from browser import faults, opened, page_data, requests, run

from matstd.api.diagnosing import Diagnosis as SavedDiagnosis
from matstd.api.learning import LearntLaws
from matstd.diagnosis.answer import compare, diagnose
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.laws import Refusal, amplitudes, learn_remainder
from matstd.diagnosis.reduced import compared_board, learnt_board
from matstd.report.laws import law_curve, law_sentence, no_law_sentence
from matstd.report.layout import Page, write_page
from matstd.report.run_view import comparison_view, diagnosis_view, learnt_view
from matstd.twin.model import Model
from matstd.twin.units import UM

LAW = "law(bias,step time)"


@pytest.fixture(scope="module")
def learning(stylus):
    """A stylus that is changed: the probe reads elsewhere from then on."""
    return stylus[2]


def test_the_board_switches_the_law(learning):
    board = learnt_board(learning)
    assert board.found == {LAW}
    on = board.errors({LAW})
    known = [learning.after.rms, learning.after.test_rms]
    assert [on.fitted, on.held_out] == pytest.approx(known, rel=1e-7)
    off = board.errors(())
    assert off.fitted > 1.2 * on.fitted
    assert board.known[frozenset()] == (learning.before.rms, learning.before.test_rms)


def test_without_a_law_a_notebook_says_why(learning):
    own = {field.name: getattr(learning, field.name) for field in fields(learning)}
    none = LearntLaws(**own | {"laws": (), "refusal": Refusal.CHANCE})
    pages = none.live().page, LearntLaws(**own).live().page
    why, what = no_law_sentence(none)[:50], law_sentence(learning, learning.laws[0])[:30]
    assert [why in page for page in pages] == [True, False]
    assert [what in page for page in pages] == [False, True]


def test_effects_found_before_are_switches_beside_the_law(learning):
    named = learning.after.model.effects[0]
    board = learnt_board(learning, [named])
    assert board.found == {named.name, LAW}
    both = board.errors(board.found)
    known = [learning.after.rms, learning.after.test_rms]
    assert [both.fitted, both.held_out] == pytest.approx(known, rel=1e-7)
    assert board.known[board.found] == (learning.after.rms, learning.after.test_rms)
    assert board.errors({LAW}).fitted > 1.001 * both.fitted


def test_a_step_of_the_probe_stands_at_the_touches_themselves(learning):
    """The lever on the reading of the probe is 1: dots are residuals plus the step by hand."""
    (one,) = learning.laws
    curve = law_curve(learning, one.law, one.law.drivers[0])
    (size,) = amplitudes(learning, one.law)
    (instant,) = one.law.places
    t = learning.after.run.touches.time
    step = np.where(t > instant, size.value, 0.0)
    assert curve.lever == pytest.approx(1.0)
    residual = learning.after.residual
    assert curve.put_back == pytest.approx((residual + step) / UM, abs=1e-6)
    assert curve.value[[0, -1]] == pytest.approx([0.0, size.value / UM], abs=1e-9)
    assert curve.u[-1] == pytest.approx(size.u / UM, rel=0.01)
    assert curve.label == "time in h"


@pytest.mark.slow
def test_a_diagnosis_shows_what_it_found_and_the_law_of_what_remains(learning):
    found = diagnose(learning.after.run)
    found = replace(found, laws=learn_remainder(found.start, found.fit))
    assert found.laws.laws
    page = page_data(diagnosis_view(found, "run.csv").script)
    names = {s["name"] for s in page["switches"] if s["isFound"]}
    kept = {e.name for e in found.laws.after.model.effects}
    laws = {one.law.name for one in found.laws.laws}
    assert names == laws | ({e.name for e in found.found} & kept)
    assert {c["law"] for c in page["curves"]} == laws
    last = next(k for k in page["known"] if set(k["on"]) == names)
    assert last["fitted"] == pytest.approx(found.laws.after.rms / UM)
    # the model has the law; of the geometry it states what console and page do
    saved = SavedDiagnosis(**{f.name: getattr(found, f.name) for f in fields(found)}, auto=True)
    assert saved.learnt is found.laws.saved
    stated = {one.symbol: one.estimate.value for one in saved.model.determined}
    rows = {row.symbol: row.estimate.value for row in found.geometry.rows if row.is_determined}
    assert stated == pytest.approx(rows, rel=1e-5)


@pytest.mark.browser
def test_the_page_shows_curve_and_touches_and_takes_the_law_away(browser, learning, tmp_path):
    path = tmp_path / "law.html"
    view = learnt_view(learning, "run.csv")
    write_page(path, Page(heading="h", lead="l", key=(), sections=(), live=view))
    opened(browser, path)
    state = """const { plot } = livePage.residuals, { now } = livePage.shown;
        return JSON.stringify({ y: [...plot.y], curve: plot.curve && [...plot.curve.y],
          half: plot.curve && [...plot.curve.half], label: plot.frame.yLabel,
          fitted: now.fitted, heldOut: now.heldOut });"""
    curve = law_curve(learning, learning.laws[0].law, learning.laws[0].law.drivers[0])
    shown = json.loads(run(browser, state))
    assert shown["label"] == "bias in µm"
    assert shown["curve"] == pytest.approx(curve.value.tolist(), abs=1e-3)
    assert shown["half"] == pytest.approx((2.0 * curve.u).tolist(), abs=1e-3)
    used = learning.after.used
    assert np.array(shown["y"])[used] == pytest.approx(curve.put_back[used], abs=5e-3)
    # one side of a law that goes one way has no room for its mirror image
    ends = json.loads(run(browser, "return JSON.stringify(livePage.residuals.lawEnds)"))
    low, high = np.quantile([*curve.put_back, *curve.value, 0.0], [0.0, 1.0])
    assert low - 0.2 * (high - low) < ends[0] < ends[1] < high + 0.2 * (high - low)
    assert ends[0] < curve.value.min() < curve.value.max() < ends[1]
    known = [learning.after.rms / UM, learning.after.test_rms / UM]
    assert [shown["fitted"], shown["heldOut"]] == pytest.approx(known, rel=1e-12)
    run(browser, f"""document.querySelector('input[data-effect="{LAW}"]').click()""")
    shown = json.loads(run(browser, state))
    assert shown["curve"] is None
    assert shown["fitted"] == pytest.approx(learning.before.rms / UM, rel=1e-12)
    run(browser, "livePage.board.reset(); livePage.board.pull(livePage.board.on[0], 0.5)")
    run(browser, "livePage.changed()")
    half = json.loads(run(browser, state))["curve"]
    assert half == pytest.approx((0.5 * curve.value).tolist(), abs=1e-3)
    assert faults(browser) == []
    assert requests(browser) == []


@pytest.fixture(scope="module")
def predicted(learning):
    """Every second touch of the run, predicted with the law as it was learnt."""
    known = learning.after
    count = sum(len(e.parameters) for e in known.model.effects)
    estimates = Prior.of_estimates(known.theta[:count], known.covariance[:count, :count])
    return compare(known.run[::2], known.model, estimates)


def without_the_law(predicted):
    """The prediction without the law, by a fit of the set-ups to the touches."""
    fit = predicted.fit
    effects = tuple(e for e in fit.model.effects if e.name != LAW)
    kept = [fit.of_effect(e.name) for e in effects]
    mean = np.concatenate([fit.prior.mean[place] for place in kept])
    prior = Prior(mean, np.zeros((len(mean), len(mean))))
    return fit_run(fit.run, Model(fit.model.chain, effects), prior, gross=fit.gross)


def test_a_law_of_the_model_is_taken_out_of_its_prediction(predicted):
    board = compared_board(predicted)
    assert board.found == {LAW}
    on, off = board.errors({LAW}), board.errors(())
    known = [predicted.fit.rms, predicted.fit.test_rms]
    assert [on.fitted, on.held_out] == pytest.approx(known, rel=1e-7)
    known = without_the_law(predicted)
    assert [off.fitted, off.held_out] == pytest.approx([known.rms, known.test_rms], rel=1e-7)
    assert off.fitted > 1.2 * on.fitted


@pytest.mark.browser
def test_the_page_of_a_prediction_switches_its_law(browser, predicted, tmp_path):
    path = tmp_path / "predicted.html"
    view = comparison_view(predicted, "run.csv")
    write_page(path, Page(heading="h", lead="l", key=(), sections=(), live=view))
    opened(browser, path)
    figures = "const { fitted, heldOut } = livePage.shown.now; return [fitted, heldOut];"
    fit = predicted.fit
    assert run(browser, figures) == pytest.approx([fit.rms / UM, fit.test_rms / UM], rel=1e-12)
    words = run(browser, "return document.querySelector('.amount').textContent")
    assert words.startswith("What the model predicts; moves the residuals by")
    click = f"""document.querySelector('input[data-effect="{LAW}"]').click();"""
    known = without_the_law(predicted)
    expected = pytest.approx([known.rms / UM, known.test_rms / UM], rel=1e-7)
    assert run(browser, click + figures) == expected
    shown = np.array(run(browser, "return [...livePage.shown.residual]"))
    assert shown == pytest.approx(known.residual / UM, abs=5e-3)
    run(browser, click)
    pull = "livePage.board.pull(livePage.board.on[0], 0); livePage.changed();"
    assert run(browser, pull + figures) == expected
    run(browser, "document.getElementById('again').click()")
    assert run(browser, figures)[0] == pytest.approx(fit.rms / UM, rel=1e-12)
    assert faults(browser) == []
