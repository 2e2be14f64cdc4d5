"""The verdict in three parts, repeatability, and errors to expect; sums worked by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from unchanged import answer_text

from matstd.diagnosis.accuracy import (
    Repeatability,
    Scatter,
    machine_variance,
    other_places,
    promise,
    repeatability,
)
from matstd.diagnosis.answer import Doubt, Step, Verdict, diagnose
from matstd.diagnosis.answer.parts import Remainder, verdict_parts
from matstd.diagnosis.fit import Reported, Role, fit_run
from matstd.diagnosis.geometry import LearntGeometry
from matstd.diagnosis.residual import Shape, Structure
from matstd.report.numbers import odds_words
from matstd.report.run_view import diagnosis_step
from matstd.report.verdict import part_lines
from matstd.report.verdict.part_words import _odds, _remains
from matstd.report.words import verdict_sentence
from matstd.twin.frames import apply
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.machine import tip
from matstd.twin.model import Model

UM = 1e-3
NO_GEOMETRY = LearntGeometry((), (), ())


def weighed(chain, name, scatter, p=1e-9, is_significant=True):
    size = Reported("amplitude", "um", 10.0, 1.0 if is_significant else 6.0, UM, Role.SIZE)
    effect = parse_effect(name, chain)
    fit = left_by_model(scatter)
    return Step(effect=effect, fit=fit, p_value=p, reported=(size,), confusion=None)


def left_by_model(scatter, dof=100.0):
    """A fit that leaves a scatter in units of a stated noise of 1 um."""
    return SimpleNamespace(noise=SimpleNamespace(factor=scatter, dof=dof))


def parts(start, steps, left=(), repeats=None, dof=100.0):
    known = repeats or Repeatability(1.0 * UM, None, None, None)
    fit = left_by_model(start, dof)
    first = Step(effect=None, fit=fit, p_value=1.0, reported=(), confusion=None)
    return verdict_parts([first, *steps], left, NO_GEOMETRY, (), known, {})


def pattern(share):
    return Structure(Shape.SMOOTH, ("X_mm",), "Z", 1e-9, share, 30.0, None)


@pytest.fixture(scope="module")
def hidden(case):
    return case(33, "hmc1995").run


def test_shares_of_names_and_remainder_add_up(hidden):
    """5 um fall to 4, then to 3; repeats show 1: of 24 um^2, 9 and 7 are named and 8 remain."""
    chain = hidden.touches.chain
    repeats = Repeatability(1.0 * UM, Scatter(1.0 * UM, 50), None, None)
    steps = [weighed(chain, "backlash(X)", 4.0), weighed(chain, "backlash(Y)", 3.0)]
    found = parts(5.0, steps, repeats=repeats)
    assert [n.share for n in found.named] == pytest.approx([9 / 24, 7 / 24])
    assert found.remains.share == pytest.approx(8 / 24)
    assert found.remains.size == pytest.approx(np.sqrt(8.0) * UM)
    assert found.remains.is_real
    assert not found.is_unexplained  # 16 um^2 are named, 8 remain


def test_more_left_than_named_is_unexplained(hidden):
    steps = [weighed(hidden.touches.chain, "backlash(X)", 4.0)]
    assert parts(5.0, steps, [pattern(0.9)]).is_unexplained  # 9 um^2 named, 14.4 in a pattern
    assert not parts(5.0, steps, [pattern(0.3)]).is_unexplained  # 4.8
    assert not parts(5.0, steps).is_unexplained
    assert parts(5.0, [], [pattern(0.01)]).is_unexplained  # nothing is named


@pytest.mark.parametrize(
    ("scatter", "p", "is_significant", "doubt"),
    [
        (4.0, 1e-4, True, None),
        (4.0, 2e-3, True, Doubt.CHANCE),  # of more than one in a thousand
        (4.0, 1e-9, False, Doubt.UNCERTAIN),  # within twice its uncertainty
        (4.9996, 1e-9, True, Doubt.SMALL),  # 0.063 um beside a stated noise of 1
    ],
)
def test_what_may_stand_in_a_headline(hidden, scatter, p, is_significant, doubt):
    step = weighed(hidden.touches.chain, "backlash(X)", scatter, p, is_significant)
    (found,) = parts(5.0, [step]).named
    assert found.doubt is doubt
    assert found.is_headline is (doubt is None)


def test_lack_of_fit_is_judged_by_repeats():
    """A chi-square of 33 beside repeats as good as stated is no noise."""
    repeats = Repeatability(1.0 * UM, Scatter(1.0 * UM, 20), None, None)
    found = parts(5.74, [], repeats=repeats)
    assert found.is_unexplained
    assert found.remains.lack_of_fit < 1e-3
    few = Repeatability(1.0 * UM, Scatter(1.0 * UM, 4), None, None)
    assert not parts(5.74, [], repeats=few).is_unexplained


def test_repeatability_of_known_noise(hidden):
    """Replicates, re-visits and neighbours show the noise that was put in, not the stated one."""
    rng = np.random.default_rng(1)
    rows = np.repeat(np.arange(len(hidden)), 2)
    run = hidden[rows]
    fit = fit_run(run, ordinary_model(run.touches.chain))
    noise = rng.normal(0.0, 2.0 * UM, len(run))
    known = replace(run, deviation=run.deviation - fit.residual + noise)
    found = repeatability(fit_run(known, ordinary_model(run.touches.chain)))
    assert found.known is not None
    assert found.known.dof >= len(hidden)
    assert found.known.size == pytest.approx(2.0 * UM, rel=0.1)
    assert found.stated == pytest.approx(np.sqrt(np.mean(run.u**2)))


def test_other_places_are_consistent_touches(case):
    """The nominal ball stands at its radius from the point wherever the axes have moved."""
    t = case(33, "hmc1995").run.touches
    there = other_places(t, np.random.default_rng(0))
    ball = tip(there.chain, there.q, there.target)
    gap = ball - apply(there.T_table_artefact, there.point)
    moved = gap - there.radius[:, None] * there.normal_table
    # a set-up moves as a whole: the ball is off its old point by one vector for each set-up
    for number in np.unique(there.setup):
        spread = np.ptp(moved[there.setup == number], axis=0)
        assert spread == pytest.approx(np.zeros(3), abs=0.2)
    assert np.ptp(there.q, axis=0).max() > 0.0


def test_a_turn_of_the_one_set_up_is_no_error_elsewhere(case):
    """An alignment takes up a turn of the workpiece, 100 urad, at any place of it and any pose."""
    run = case(1, "hsm600u").run
    one = run[run.touches.setup == 0].touches
    there = other_places(one, np.random.default_rng(0))
    box = one.point_table.min(axis=0) - 1e-9, one.point_table.max(axis=0) + 1e-9
    assert np.all((there.point_table >= box[0]) & (there.point_table <= box[1]))
    assert np.abs(there.q - one.q).max() > 10.0
    turn = Model(one.chain, (parse_effect("location(EA0w)", one.chain),))
    alone = turn.columns(there)[:, 0] * 1e-4
    left = machine_variance(there, turn, np.array([[1e-4]]), np.full(len(one), UM))
    assert np.std(alone) > 3.0 * UM
    assert np.sqrt(left.max()) < 0.1 * UM


def test_a_promise_elsewhere_is_at_least_the_one_here(hidden):
    fit = fit_run(hidden, ordinary_model(hidden.touches.chain))
    found = promise(fit)
    assert found.elsewhere >= found.same == fit.test_rms
    assert promise(fit).elsewhere == found.elsewhere  # drawn alike each time
    assert {"X_mm", "time_s", "setup"} <= {d.name for d in found.domains}


def test_lines_of_the_parts_are_read_in_their_order(hidden, unchanged):
    chain = hidden.touches.chain
    found = diagnose(hidden, candidates=[parse_effect("backlash(X)", chain)])
    lines = part_lines(found)
    assert [name for name, _ in lines] == [
        "geometry",
        "named effects",
        "what remains",
        "repeatability",
        "error to expect",
    ]
    assert (
        f"{found.promise.elsewhere / UM:.2f} µm at other places" in dict(lines)["error to expect"]
    )
    assert "backlash(X)" in dict(lines)["named effects"]
    unchanged(answer_text(found))


def test_odds_in_words():
    assert [odds_words(v) for v in (np.log(3.0), np.log(1e6), 900.0)] == [
        "3.0 : 1".replace(".0", ""),
        "1e6 : 1",
        "> 1e12 : 1",
    ]


@pytest.mark.parametrize(
    ("odds", "words"),
    [
        (np.log(1e-7), "odds 1 : 1e7 (it explains the run better)"),
        (np.log(0.1), "odds 1 : 10 (not distinguished)"),
        (np.log(1e6), "odds 1e6 : 1"),
    ],
)
def test_a_rival_that_explains_the_run_better_is_distinguished(odds, words):
    assert _odds(odds) == words


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (Shape.SMOOTH, "it varies with X, along z (also time)"),
        (Shape.DRIVER, "it drifts slowly as a lag would after a temperature that was not recorded"),
        (Shape.NEIGHBOURS, "touches that are neighbours in X agree (also time)"),
    ],
)
def test_what_remains_is_a_clause_on_its_first_pattern(shape, words):
    first, other = (
        Structure(one, (variable,), "z", 1e-6, 0.2, 9.0, None, law="a lag")
        for one, variable in ((shape, "X_mm"), (Shape.SMOOTH, "time_s"))
    )
    left = Remainder(3.0 * UM, 2.0 * UM, 0.25, 1e-9, (first, other), is_real=True)
    said = _remains(left, SimpleNamespace(known=None))
    assert said.startswith(f"2.00 µm rms in its strongest pattern, 25 % of the excess; {words}")


def test_a_law_of_a_sensor_is_weighed_against_an_unrecorded_drift(hidden, unchanged):
    """A backlash follows no sensor; a growth with a temperature does."""
    run = hidden[::3]
    t = run.touches
    warm = 20.0 + 8.0 * (t.time / t.time.max()) ** 2
    t = replace(t, temperature={**t.temperature, "ram": warm})
    grown = 3.0 * UM * (warm - 20.0) * t.normal[:, 2]
    found = diagnose(
        replace(run, touches=t, deviation=run.deviation + grown),
        candidates=[parse_effect("thermal-static(EZZ,ram)", t.chain)],
    )
    (named,) = found.parts.named
    assert named.against_drift is not None
    assert found.parts.headline == (named,)
    assert "without a recorded cause, odds" in dict(part_lines(found))["named effects"]
    unchanged(answer_text(found))


def test_an_expansion_beyond_all_materials_is_not_found(hidden, monkeypatch):
    """-41 um/(m K) fits, but no scale of the shop does that; 11 um/(m K) is steel."""
    # what is nearest to the remainder takes most of the time
    monkeypatch.setattr("matstd.diagnosis.answer.run_diagnosis.nearest", lambda *_: ())
    few = hidden[::5]
    t = few.touches
    warm = 20.0 + 8.0 * np.sin(t.time / t.time.max() * 5.0)
    t = replace(t, temperature={**t.temperature, "scale": warm})
    effect = parse_effect("thermal-expansion(X,scale)", t.chain)
    found = []
    for alpha in (11e-6, -41e-6):
        column = Model(t.chain, (effect,)).columns(t)[:, 0]
        run = replace(few, touches=t, deviation=few.deviation + alpha * column)
        found.append([e.name for e in diagnose(run, candidates=[effect]).found])
    assert found == [[effect.name], []]


def test_the_headline_names_only_what_is_certain(hidden):
    """Two laws are found; the one that is no more than a tenth of the noise is only counted."""
    t = hidden.touches
    effects = [parse_effect(f"backlash({axis})", t.chain) for axis in "XY"]
    column = Model(t.chain, effects).columns(t) @ np.array([8.0 * UM, 6.0 * UM])
    found = diagnose(replace(hidden, deviation=hidden.deviation + column), candidates=effects)
    both = [f"backlash({axis})" for axis in "XY"]
    assert sorted(e.name for e in found.found) == both
    assert all(name in verdict_sentence(found) for name in both)
    small = tuple(
        replace(n, doubt=None if n.effect.name == both[0] else Doubt.SMALL)
        for n in found.parts.named
    )
    one = replace(found, parts=replace(found.parts, named=small))
    assert both[1] not in verdict_sentence(one)
    assert "one effect: " in verdict_sentence(one)
    assert "(one effect not certain or too small to name)" in verdict_sentence(one)


def test_a_small_effect_is_called_small(hidden):
    """Certain, three times its uncertainty, and yet hardly any of the noise: no open question."""
    t = hidden.touches
    effect = parse_effect("backlash(X)", t.chain)
    moved = Model(t.chain, [effect]).columns(t) @ np.array([8.0 * UM])
    found = diagnose(replace(hidden, deviation=hidden.deviation + moved), candidates=[effect])
    named = tuple(replace(one, doubt=Doubt.SMALL) for one in found.parts.named)
    small = replace(found, parts=replace(found.parts, named=named), verdict=Verdict.UNDECIDED)
    assert "but it is less than 10 % of the stated noise" in verdict_sentence(small)
    assert ", less than 10 % of the stated noise" in dict(part_lines(small))["named effects"]
    assert diagnosis_step(small, "run.csv").startswith("Go on with the starting model")
