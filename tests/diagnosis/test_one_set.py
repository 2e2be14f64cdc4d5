"""One set: tested, told and saved; every figure can be had again from the saved model."""

import json
from dataclasses import replace

import numpy as np
import pytest
from simulator_case import simulate_case

from diagnosis.answer import one_set
from diagnosis.answer.one_set import placed, tested_set
from diagnosis.fit.identification import fit_run
from diagnosis.fit.memory import Memory
from diagnosis.fit.remade import Learnt, inner_root, remade
from diagnosis.files.model_file import read_model
from diagnosis.files.model_writer import write_model
from diagnosis.fit.prior import Prior
from diagnosis.search.search_loop import DiagnosisTask, search_until_stable
from matstd.cli import main
from report.words.diagnosis_words import figures, number_words
from twin.library.catalogue import parse_effect
from twin.library.ordinary import ordinary_model
from twin.model.model import Model
from twin.record.copies import without_copies

LAG = (5, "hsm600u", ("thermal-lag(EXC)",))
TWO = (12, "hmc1995", ("backlash(Y)", "stylus-bending"))


def searched(case, key, names):
    """Result of a search among some effects of a simulated run."""
    run = case(*key).run
    start = ordinary_model(run.touches.chain)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    library = [parse_effect(name, run.touches.chain) for name in names]
    return task, search_until_stable(task, (), library)


# --- the set that is told is the set that was tested ------------------------------------------


def test_refined_effects_are_tested_as_they_are_told(case) -> None:
    _, final = searched(case, LAG, ["thermal-lag(EXC)", "backlash(X)"])
    tested = tested_set(final)
    (told,) = tested.state.effects
    (member,) = tested.state.chosen.members
    assert member.effect is told.effect
    grid = [p for inner in told.effect.inner(case(*LAG).run.touches) for p in inner.grid]
    assert all(abs(told.effect.tuning["tau"] / g - 1.0) > 1e-6 for g in grid)  # off the grid
    test = tested.tests["thermal-lag(EXC)"]
    assert test.stands
    without = tested.state.search.evaluate(())
    gained = tested.state.chosen.effects.evidence - without.effects.evidence
    assert test.evidence == pytest.approx(gained)


def test_a_name_that_does_not_stand_is_not_told(case, monkeypatch) -> None:
    """The class offers a head that explains nothing: the tested member keeps its name."""
    _, final = searched(case, LAG, ["thermal-lag(EXC)", "backlash(X)"])
    other = replace(final.effects[0], effect=parse_effect("backlash(X)", final.base.model.chain))

    def headed(pool, found, others, fixed=None):
        rival = one_set.ConfusionClass(other, (), ())
        return rival

    monkeypatch.setattr(one_set, "confusion_class", headed)
    tested = tested_set(final)
    assert [s.effect.name for s in tested.state.effects] == ["thermal-lag(EXC)"]
    assert [c.effect.name for c in tested.classes] == ["thermal-lag(EXC)"]
    assert [r.effect.name for r in tested.classes[0].rivals] == ["backlash(X)"]
    assert tested.tests["thermal-lag(EXC)"].stands


def test_no_effect_stands_twice_when_two_classes_want_one_head(case, monkeypatch) -> None:
    names = ["backlash(Y)", "stylus-bending", "probe-radius"]
    _, final = searched(case, TWO, names)
    assert len(final.effects) == 2
    wanted = final.effects[0]

    def headed(pool, found, others, fixed=None):
        assert found.effect.name not in {o.effect.name for o in others}
        rival = one_set.ConfusionClass(found, (), ())
        if wanted.effect.name in {o.effect.name for o in others}:
            return replace(rival, rivals=(one_set.Rival(wanted, 0.0, 1.0),))
        return rival

    monkeypatch.setattr(one_set, "confusion_class", headed)
    tested = tested_set(final)
    told = [s.effect.name for s in tested.state.effects]
    assert sorted(told) == sorted(set(told)) == ["backlash(Y)", "stylus-bending"]
    rivals = {r.effect.name for c in tested.classes for r in c.rivals}
    assert not rivals & set(told)


def test_a_set_put_back_is_what_it_was(case) -> None:
    _, final = searched(case, LAG, ["thermal-lag(EXC)", "backlash(X)"])
    before = final.search.pool.C.copy()
    grid = tuple(replace(s, effect=m.effect) for s, m in zip(final.effects, final.chosen.members))
    moved = placed(final, final.effects)
    assert np.abs(moved.search.pool.C - before).max() > 0.0
    again = placed(moved, grid)
    assert again.search.pool.C == pytest.approx(before)


# --- figures made again from what is kept -----------------------------------------------------


def kept(fit, root=None):
    """What a model file keeps of a fit, without the file."""
    count = len(fit.model.parameters)
    covariance = fit.covariance[:count, :count]
    gross = fit.gross.rows | fit.gross_test_rows
    estimates = Prior.of_estimates(fit.theta[:count], covariance)
    return Learnt(estimates, fit.noise.factor, gross, fit.memory)


@pytest.mark.parametrize(
    "memory",
    [None, Memory(0.4), Memory(0.6, is_filtered=False)],
    ids=["white", "remembers", "counts for less"],
)
@pytest.mark.parametrize("held_out", [False, True], ids=["all rows", "some held out"])
def test_a_fit_is_made_again(case, memory, held_out) -> None:
    run = without_copies(case(*LAG).run)
    if held_out:
        split = np.where(np.arange(len(run)) % 5 == 0, "test", "train")
        run = replace(run, split=split)
    effect = parse_effect("thermal-lag(EXC)", run.touches.chain)
    start = ordinary_model(run.touches.chain)
    model = Model(start.chain, (*start.effects, effect.tuned(1800.0)))
    fit = fit_run(run, model, memory=memory)
    again = remade(run, model, kept(fit))
    assert again.residual == pytest.approx(fit.residual, abs=1e-9)
    assert again.solution.leverage == pytest.approx(fit.solution.leverage, abs=1e-6)
    assert again.rms == pytest.approx(fit.rms, rel=1e-7)
    assert again.test_rms == pytest.approx(fit.test_rms, rel=1e-7)
    assert again.noise.chi2_ratio == pytest.approx(fit.noise.chi2_ratio, rel=1e-7)
    assert again.covariance == pytest.approx(fit.covariance, rel=1e-4, abs=1e-14)


def test_uncertain_inner_parameters_widen_what_is_saved(case, tmp_path) -> None:
    run = without_copies(case(*LAG).run)
    effect = parse_effect("thermal-lag(EXC)", run.touches.chain)
    start = ordinary_model(run.touches.chain)
    model = Model(start.chain, (*start.effects, effect.tuned(1800.0)))
    fit = fit_run(run, model)
    root = inner_root(fit)
    count = len(model.parameters)
    assert root.shape == (count, 1)
    free = fit_run(run, model, theta=None, free_inner=fit.theta[:count]) if False else None
    assert free is None
    write_model(tmp_path / "model.toml", fit, "run.csv")
    saved = read_model(tmp_path / "model.toml")
    whole = saved.estimates.root @ saved.estimates.root.T
    held = fit.covariance[:count, :count]
    assert np.diag(whole - held).min() > -1e-12
    assert np.diag(whole)[-1] > np.diag(held)[-1]
    learnt = saved.learnt(run)
    assert learnt is not None
    assert figures(remade(run, saved.model, learnt)) == figures(fit)
    assert saved.learnt(replace(run, deviation=run.deviation + 1e-3)) is None
