"""The search among sets of effects, refinement of inner parameters, classes of look-alikes."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import arm_poses
from scipy.stats import f

from matstd.diagnosis.answer.ambiguity import Rival, _ordered, confusion_class, plausibility
from matstd.diagnosis.evidence import (
    EffectSet,
    Grid,
    RawColumns,
    ResidualSpace,
    ScaledEffect,
    addition,
    signatures,
    tuned_variants,
)
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search import MOST_SETS, Library, Search, clearly_best, is_series, refined
from matstd.diagnosis.search.further_parts import further_periods, tables
from matstd.diagnosis.search.screening import joined_shortlists
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import columns
from matstd.twin.units import MINUTE, UM

KEY = (2, "hsm600u")
NAMES = (
    "backlash(X)",
    "backlash(Y)",
    "thermal-lag(EZZ)",
    "thermal-lag(EXX)",
    "periodic(EXX)",
    "probe-radius",
    "drift",
)


@pytest.fixture
def planted(case):
    """A function: {name: (inner parameters, size in standard deviations)} -> space of a run."""

    def made(hidden, seed=0):
        run = case(*KEY).run
        t = run.touches
        rng = np.random.default_rng(seed)
        deviation = rng.normal(0.0, 0.6 * UM, len(run))
        for name, (inner, size) in hidden.items():
            effect = parse_effect(name, t.chain)
            effect = effect.tuned(*inner) if inner else effect
            theta = np.array([size * p.sd for p in effect.parameters])
            deviation = deviation + columns([effect], t) @ theta
        return ResidualSpace.of(fit_run(replace(run, deviation=deviation), ordinary_model(t.chain)))

    return made


def library(space, names=NAMES):
    return [parse_effect(name, space.touches.chain) for name in names]


def search_in(space, names=NAMES):
    effects = library(space, names)
    variants = [tuple(tuned_variants(effect, space.touches)) for effect in effects]
    grids = [Grid(e, v, len(v)) for e, v in zip(effects, variants, strict=True)]
    return Search(signatures(space, grids, len(grids)))


def names_of(subset):
    return {m.effect.name for m in subset.members}


def test_raw_columns_belong_to_their_owner(planted, case) -> None:
    """Projections that share them get the same columns; those of another run are no part of it."""
    space = planted({})
    (effect,) = library(space, ("thermal-lag(EZZ)",))
    grid = Grid(effect, tuple(tuned_variants(effect, space.touches)), 1)
    raw = RawColumns(space.touches)
    assert raw.of(grid) is raw.of(grid)
    np.testing.assert_array_equal(raw.of(grid), columns(grid.variants, space.touches))
    assert not RawColumns(space.touches).kept
    with pytest.raises(AssertionError):
        ResidualSpace.of(fit_run(case(*KEY).run[::2], ordinary_model(space.touches.chain)), raw)


def test_two_effects_are_found_and_no_third(planted) -> None:
    search = search_in(planted({"backlash(X)": ((), 1.0), "thermal-lag(EZZ)": ((1500.0,), 1.0)}))
    assert names_of(search.run()) == {"backlash(X)", "thermal-lag(EZZ)"}


@pytest.mark.parametrize("seed", range(4))
def test_nothing_is_found_in_noise(planted, seed) -> None:
    assert search_in(planted({}, seed)).run().members == ()


def test_only_an_evaluation_is_charged(planted) -> None:
    """Whoever asks for scores or a ranking again pays nothing."""
    search = search_in(planted({"backlash(X)": ((), 1.0)}))
    nothing = search.evaluate(())
    left = search.budget.left
    assert 0.0 < MOST_SETS - left <= 1.0
    best = search.ranking(nothing)[0]
    member = search.member(nothing, best)
    assert member.effect.name == "backlash(X)"
    assert search.budget.left == left
    search.evaluate((member,))
    assert search.budget.left < left


def test_the_evidence_of_a_set_is_that_of_its_columns(planted) -> None:
    """Scores of additions, by inner products, against the sets themselves."""
    search = search_in(planted({"backlash(X)": ((), 1.0), "thermal-lag(EZZ)": ((1500.0,), 1.0)}))
    nothing = search.evaluate(())
    one = search.evaluate((search.member(nothing, search.ranking(nothing)[0]),))
    scores = search.scores(one)
    for variant in search.ranking(one):
        whole = search.evaluate((*one.members, search.member(one, variant)))
        assert scores.evidence[variant] == pytest.approx(whole.effects.evidence, abs=1e-6)
    seen = scores.freedom > 0
    drop, k = scores.free_drop[seen], scores.freedom[seen]
    dof = one.effects.dof - k
    ratio = (drop / k) / ((one.effects.objective - drop) / dof)
    np.testing.assert_allclose(scores.p[seen], f.sf(ratio, k, dof), rtol=1e-6)


def test_refinement_leaves_the_grid_for_the_true_time_constant(planted) -> None:
    """Between two points of the grid, and at least as likely as the truth itself."""
    space = planted({"thermal-lag(EZZ)": ((1234.0,), 2.0)})
    (start,) = library(space, ("thermal-lag(EZZ)",))
    grid = np.asarray(start.inner(space.touches)[0].grid)
    nearest = start.tuned(float(grid[np.argmin(np.abs(grid - 1234.0))]))
    empty = EffectSet(space, np.zeros((len(space.residual), 0)))

    def evidence(tau):
        return addition(empty, start.tuned(tau))[0]

    found, top = refined(empty, nearest)
    (tau,) = found.effect.tuning.values()
    assert top >= max(evidence(1234.0), *(evidence(float(g)) for g in grid)) - 1e-3
    # a parabola through the evidence has the standard uncertainty in its curvature
    step = 30.0
    curvature = (evidence(tau + step) - 2.0 * evidence(tau) + evidence(tau - step)) / step**2
    assert abs(tau - 1234.0) < 4.0 / np.sqrt(-curvature)


def test_a_member_between_the_points_of_its_grid_pays_for_the_grid(planted) -> None:
    space = planted({})
    search = search_in(space, ("thermal-lag(EZZ)", "backlash(X)"))
    effect = search.pool.variants[0].tuned(777.0)
    member = search.placed(ScaledEffect(effect, 2.0))
    raw = space.columns([effect])
    np.testing.assert_allclose(member.signature.C, space.project(raw))
    assert member.signature.size[0] == pytest.approx(np.linalg.norm(raw[:, 0]))
    assert (member.effect, member.scale) == (effect, 2.0)
    assert member.signature.tries[0] == search.pool.tries[0] > 1
    assert search.corrected(member, 1e-9) == pytest.approx(1e-9 * search.pool.tries[0] * 2)


def test_what_a_coarse_grid_leaves_is_no_second_effect(planted) -> None:
    """A lag ten times its usual size between two points of the grid."""
    (effect,) = library(planted({}), ("thermal-lag(EZZ)",))
    grid = np.sort(np.asarray(effect.inner(planted({}).touches)[0].grid))
    tau = float(np.sqrt(grid[len(grid) // 2] * grid[len(grid) // 2 + 1]))
    space = planted({"thermal-lag(EZZ)": ((tau,), 10.0)})
    search = search_in(space)
    found = search.run()
    assert names_of(found) == {"thermal-lag(EZZ)"}
    (member,) = found.members
    assert all(abs(member.effect.tuning["tau"] / g - 1.0) > 1e-6 for g in grid)
    assert next(iter(member.effect.tuning.values())) == pytest.approx(tau, abs=MINUTE)


def test_a_lag_at_a_wrong_time_constant_gets_no_second_one(planted) -> None:
    """What it leaves a second lag of the same component would take up; it is moved first."""
    space = planted({"thermal-lag(EZZ)": ((1500.0,), 5.0)})
    search = search_in(space, ("thermal-lag(EZZ)", "thermal-lag(EZX)", "backlash(X)"))
    lag, other = library(space, ("thermal-lag(EZZ)", "thermal-lag(EZX)"))
    wrong, mop = ScaledEffect(lag.tuned(1100.0), 4.0), ScaledEffect(other.tuned(4000.0), 1.0)
    both = search.evaluate([search.placed(wrong), search.placed(mop)])
    alone = search.evaluate([search.placed(wrong)])
    assert both.evidence > alone.evidence + POLICY.log_evidence_gain
    found = search.run(alone.members)
    assert names_of(found) == {"thermal-lag(EZZ)"}
    assert found.members[0].effect.tuning["tau"] == pytest.approx(1500.0, rel=0.01)


def test_a_later_way_must_predict_clearly_better() -> None:
    share = POLICY.error_share
    assert clearly_best([1.0, share + 1e-6], float) == 1.0
    assert clearly_best([1.0, share - 1e-6], float) == share - 1e-6
    assert clearly_best([1.0, 0.9, 0.89, 0.8], float) == 0.8


def test_further_periods_are_asked_for_one_by_one_up_to_four(planted) -> None:
    space = planted({})
    (wave,) = library(space, ("periodic(EXX)",))
    found, offered, names = [ScaledEffect(wave.tuned(10.0))], [wave], []
    while wider := next(further_periods(space, found, offered), None):
        names += wider.new
        offered = list(wider.candidates)
    assert names == [f"periodic(EXX)#{k}" for k in (2, 3, 4)]
    assert not list(further_periods(space, [ScaledEffect(e) for e in library(space)], offered))


def test_tables_that_only_a_remainder_asks_for_stand_alone(planted) -> None:
    touches = planted({}).touches
    stated = [parse_effect("position-table(EXX)", touches.chain)]
    first, second = tables(touches, ["X_mm", "time_s"], stated, [])
    assert (first.new, first.is_alone) == ({"position-table(EXX)"}, False)
    assert "position-table(EYX)" in second.new
    assert not first.new & second.new
    assert second.is_alone
    assert first.share == second.share == POLICY.error_share
    assert not list(tables(touches, ["time_s"], [], []))


def test_a_shortlist_of_a_long_run_is_a_value(planted, monkeypatch) -> None:
    """Asked twice it says the same, and the pool has exactly its points."""
    monkeypatch.setattr("matstd.diagnosis.search.screening.WHOLE_BELOW", 300)
    space = planted({"thermal-lag(EZZ)": ((1500.0,), 2.0)})
    made = Library.of(space, library(space))
    empty = EffectSet(space, np.zeros((len(space.residual), 0)))
    first = made.shortlist((), empty)
    assert made.shortlist((), empty) == first
    assert made.sample.names[next(iter(first))] == "thermal-lag(EZZ)"
    pool = made.pool(first)
    assert len(pool.variants) == sum(len(points) for points in first.values())
    assert pool.tried == len(NAMES)
    joined = joined_shortlists({0: frozenset({1}), 2: frozenset({5})}, {0: frozenset({3})})
    assert joined == {0: frozenset({1, 3}), 2: frozenset({5})}


def test_look_alikes_are_a_class(planted) -> None:
    """A growth along Z is the same in the body of Z as in that of X; along X it is another."""
    space = planted({"thermal-lag(EZZ)": ((1500.0,), 0.5)})
    names = ("thermal-lag(EZZ)", "thermal-lag(EZX)", "thermal-lag(EXX)", "backlash(X)")
    pool = search_in(space, names).pool
    empty = EffectSet(space, np.zeros((len(space.residual), 0)))
    found, _ = refined(empty, library(space, names[:1])[0].tuned(1500.0))
    made = confusion_class(pool, found, empty, ())
    everything = {made.effect.name, *(r.effect.name for r in made.rivals)}
    assert {"thermal-lag(EZZ)", "thermal-lag(EZX)"} <= everything
    assert all(r.log_odds < POLICY.log_odds_alike for r in made.rivals)
    assert all(r.log_odds >= POLICY.log_odds_alike for r in made.distinguished)
    assert "thermal-lag(EXX)" not in everything
    assert "backlash(X)" not in everything


def test_of_effects_alike_that_of_the_usual_size_is_named(case) -> None:
    """By hand: log 16 = 2.8 against sixteen times the usual size, more than 0.5 for it."""
    chain = case(8, "hmc1995", ("thermal-expansion(Y,scaleY)",)).run.touches.chain
    room, spindle = (parse_effect(f"thermal-lag(EZZ,{s})", chain) for s in ("ambient", "spindle"))
    for odds, head in ((0.5, spindle), (2.9, room)):
        found = [
            Rival(ScaledEffect(room, 16.0), 0.0, 1.0),
            Rival(ScaledEffect(spindle, 1.0), odds, 1.0),
        ]
        assert _ordered(found, {room.name: 0.0, spindle.name: 0.0}).effect is head


def test_a_sensor_is_believed_of_its_own_axis(case) -> None:
    t = case(8, "hmc1995", ("thermal-expansion(Y,scaleY)",)).run.touches
    effects = [parse_effect(f"thermal-expansion(Y,{s})", t.chain) for s in ("scaleX", "scaleY")]
    odds = plausibility(effects, t)
    own, other = odds["thermal-expansion(Y,scaleY)"], odds["thermal-expansion(Y,scaleX)"]
    assert own > other


@pytest.mark.parametrize("name", ["coupling(EBB,B1)", "periodic(EBB)"])
def test_weight_comes_before_harmonics_that_can_imitate_it(name) -> None:
    """A series over a turn goes on with another payload as if nothing had changed."""
    touches = arm_poses()
    both = [parse_effect(one, touches.chain) for one in (name, "joint-sag(B)")]
    assert [is_series(effect, touches.chain) for effect in both] == [True, False]
    odds = plausibility(both, touches)
    assert odds["joint-sag(B)"] - odds[name] == pytest.approx(POLICY.log_odds_series)
