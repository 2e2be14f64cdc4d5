"""The next visit distinguishes explanations that a run cannot, or says why none would."""

import csv
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from simulator_case import read_back
from simulator_experiment import MACHINES
from simulator_laws import law_case

from matstd.api.saved import write_learnt
from matstd.diagnosis.files import visit_text
from matstd.diagnosis.files.plan_file import visit_table
from matstd.diagnosis.laws import POLICY, learn_laws
from matstd.diagnosis.laws.beginning import Beginning
from matstd.diagnosis.next_visit import (
    NoPlan,
    Schedule,
    greedy,
    plan_visit,
    planned_visit,
    separation,
)
from matstd.diagnosis.next_visit.course import TIME_CONSTANTS, Course
from matstd.diagnosis.next_visit.discrimination import log_odds_drawn
from matstd.diagnosis.next_visit.hypotheses import Hypothesis, hypotheses, unseen
from matstd.diagnosis.next_visit.offers import visiting_touches
from matstd.diagnosis.next_visit.planned_visit import (
    LEAST_SEPARATION,
    SIZES,
    RivalPower,
    VisitPlan,
)
from matstd.diagnosis.next_visit.planned_visit import _planned as planned
from matstd.report.laws import visit_sentences
from matstd.twin.library import parse_effect
from matstd.twin.record import without_copies
from matstd.twin.units import UM


def known(*mean):
    return np.array(mean, dtype=float), np.zeros((len(mean), 1))


def test_separation_counts_what_the_other_explanation_cannot_make_up_for() -> None:
    assert separation(known(3.0, 4.0), known(0.0, 0.0)) == pytest.approx(5.0)
    loose = np.zeros(2), np.array([[np.sqrt(3.0)], [0.0]])  # variance 1 + 3 at the first touch
    assert separation(known(3.0, 4.0), loose) == pytest.approx(np.sqrt(9.0 / 4.0 + 16.0))


def test_touches_are_chosen_for_the_rival_that_is_separated_least() -> None:
    own, others = known(0, 0, 0, 0), [known(5, 0, 1, 4.9), known(0, 2, 1, 0)]
    assert sorted(greedy(own, others, 2)) == [0, 1]
    # a rival that knows the common part of both touches learns it from the first
    common = np.zeros(2), np.full((2, 1), 1e3)
    assert separation(known(7.0, 7.0), common) < 0.01
    assert separation(known(7.0, -7.0), common) == pytest.approx(7.0 * np.sqrt(2.0), rel=1e-4)


def test_expected_log_odds_are_half_the_squared_separation() -> None:
    drawn = log_odds_drawn([known(3.0, 4.0), known(0.0, 0.0)], 0, 4000, np.random.default_rng(1))
    assert np.all(drawn[:, 0] == 0.0)
    assert drawn[:, 1].mean() == pytest.approx(12.5, abs=0.3)
    assert drawn[:, 1].std() == pytest.approx(5.0, rel=0.06)


def test_a_sensor_is_forecast_through_warm_up_and_standstill() -> None:
    tau = 10000.0 * TIME_CONSTANTS[12]
    time = np.linspace(0.0, 10000.0, 300)
    course = Course.of(time, 21.0 - 5.0 * np.expm1(-time / tau))
    assert (course.start, course.rise, course.tau) == pytest.approx((21.0, 5.0, tau))
    zero, never = np.zeros(1), np.inf
    assert course.at(zero, Schedule(), never) == pytest.approx(21.0)
    warm = 21.0 + 5.0 * (1.0 - np.exp(-2.0))
    assert course.at(zero, Schedule(warm_up=2.0 * tau), never) == pytest.approx(warm)
    # stands still for tau after tau: (1 - 1/e) / e of the rise is left
    rest = Schedule(pause=tau)
    left = 21.0 + 5.0 * (1.0 - np.exp(-1.0)) * np.exp(-1.0)
    assert course.at(np.array([2.0 * tau + 1e-9]), rest, tau) == pytest.approx(left, abs=1e-3)


def test_a_schedule_stops_amid_the_poses() -> None:
    time = Schedule(pause=100.0, slowness=2.0).times(np.array([0, 0, 1, 1]), 5.0)
    assert time.tolist() == [0.0, 10.0, 120.0, 130.0]


@pytest.fixture(scope="module")
def warm():
    """A run on which the reading of the probe follows the spindle's temperature."""
    text, *_ = law_case(np.random.default_rng(8), "hmc1995", None, poses=3)
    run = without_copies(read_back(text, MACHINES["hmc1995"]))
    rise = run.touches.temperature["spindle"] - 20.0
    return run, replace(run, deviation=run.deviation + 1.0 * UM * rise)


def explanations(run, *names, places=None):
    start = Beginning.of_run(run)
    laws = [parse_effect(name, run.touches.chain) for name in names]
    if places:
        laws = [replace(law, places=places, is_sought=False) for law in laws]
    return [Hypothesis(law, 0.0, start.fitted([law])) for law in laws]


def test_a_visit_distinguishes_a_temperature_from_time(warm) -> None:
    """A warm-up before the first touch leaves time as it is and takes the rise away."""
    run = warm[1]
    found = explanations(run, "law(bias,lin T-spindle)", "law(bias,settling time)")
    plan = planned(found, run, np.random.default_rng(0))
    assert plan.refusal is None
    (rival,) = plan.rivals
    assert rival.separation > LEAST_SEPARATION
    assert plan.power > 0.9
    assert rival.power > 0.9
    assert plan.schedule.warm_up > 0.0 or plan.schedule.pause > 0.0
    t = plan.touches
    assert np.all(np.diff(t.time) > 0.0)
    if plan.schedule.warm_up:
        assert t.temperature["spindle"].min() > 28.0
    rows = list(csv.DictReader(visit_text(plan).splitlines()[1:]))
    assert [float(row["time_s"]) for row in rows] == pytest.approx(t.time, abs=0.06)
    assert {"feature", "setup", "pose", "px_mm", "nx", "X_mm"} <= set(rows[0])
    said = visit_sentences(plan)
    assert f"{len(t)} touches" in said[0]
    assert "σ" in said[1]


def test_the_time_constant_of_a_rival_stays_uncertain(warm) -> None:
    """As uncertain as its run leaves it, in what the rival predicts of the next visit."""
    start = Beginning.of_run(warm[1])
    names = "law(bias,lin T-spindle)", "law(bias,settling time)"
    law, other = (parse_effect(name, warm[1].touches.chain) for name in names)
    rivals = [SimpleNamespace(law=other, log_odds=1.0)]
    one = SimpleNamespace(law=law, alike=(), library=None, rivals=rivals)
    fit = start.fitted([law], True)
    learning = SimpleNamespace(laws=[one], tangent=fit, beginning=start, after=fit)
    own, rival = hypotheses(learning)
    assert (own.fit, rival.law, rival.log_odds) == (fit, other, 1.0)
    assert [e.name for e in rival.fit.tangents] == ["law(bias,settling time) w"]


def test_carriers_that_do_the_same_are_a_class_and_no_rivals(warm) -> None:
    run = warm[1]
    found = explanations(run, "law(EZX,lin T-spindle)", "law(EZZ,lin T-spindle)")
    plan = planned(found, run, np.random.default_rng(0))
    assert plan.refusal is NoPlan.SAME
    assert (plan.touches, plan.power, plan.rivals) == (None, None, ())
    assert [law.name for law in plan.alike] == ["law(EZZ,lin T-spindle)"]
    refusal, alike = visit_sentences(plan)
    assert "the explanations that the run leaves open do the same" in refusal
    assert alike.endswith("EZZ.")


def test_a_visit_below_three_sigmas_is_refused_with_the_best_one(warm) -> None:
    run = warm[0]  # nothing is hidden: both explanations predict next to nothing
    found = explanations(run, "law(EZX,quad X)", "law(EZX,lin T-spindle)")
    plan = planned(found, run, np.random.default_rng(0))
    assert plan.refusal is NoPlan.ALIKE
    assert (plan.touches, plan.power) == (None, None)
    (rival,) = plan.rivals
    assert 0.0 < rival.separation < LEAST_SEPARATION
    assert rival.power is None
    refusal, indistinct = visit_sentences(plan)
    assert refusal.endswith("no visit that was tried separates the rivals by three standard "
                            "deviations.")  # fmt: skip
    assert f"({rival.separation:.2g} σ)" in indistinct
    assert f"{rival.difference / UM:.2g} µm rms" in indistinct
    assert visit_text(plan) == ""
    assert plan.indistinct == (rival,)
    # touches of noise u average to u over the root of their number, three times that at most
    noise = float(np.median(found[0].fit.u))
    assert 0.0 < rival.difference < LEAST_SEPARATION * noise / np.sqrt(SIZES[0])


def test_a_longer_visit_is_planned_where_a_short_one_decides_nothing(warm) -> None:
    """A large wave and a faint one, along the normal or along X."""
    run, counts = warm[0], []
    x = run.touches.reading("X")
    period = 0.3 * np.ptp(x)
    for size in (3.0, 0.25):
        seen = replace(run, deviation=run.deviation + size * UM * np.cos(2.0 * np.pi * x / period))
        found = explanations(seen, "law(bias,sine X)", "law(EZX,sine X)", places=(period,))
        plan = planned(found, seen, np.random.default_rng(0))
        counts.append(len(plan.touches) if plan.touches is not None else np.inf)
    assert counts[0] <= SIZES[0]
    assert counts[1] > SIZES[0]


@pytest.mark.parametrize(
    ("visits", "taken"),
    [
        # (power, rivals that are not distinguished) of 128, 256 and 512 touches
        ([(0.85, 0)], 0),
        ([(0.5, 0), (0.7, 0), (0.9, 0)], 2),
        ([(0.5, 1), (0.85, 1), (0.9, 1)], 1),  # the open one stays open: 256 decide the others
        ([(0.85, 2), (0.85, 1), (0.9, 1)], 1),
        ([(0.6, 1), (0.4, 1), (0.6, 1)], 0),  # as often decided as by the longest
        ([(0.9, 1), (0.9, 1), (None, 2)], 2),
    ],
)
def test_the_shortest_visit_is_planned_that_decides_as_much_as_any(
    warm, visits, taken, monkeypatch
) -> None:
    law = parse_effect("law(bias,sine X)", warm[0].touches.chain).tuned(60.0)
    open_ = RivalPower(law, 0.0, 0.9 * LEAST_SEPARATION, 0.0, 0.0, None, False)
    plans = [VisitPlan(law, power=power, rivals=(open_,) * n) for power, n in visits]
    left = iter(plans)
    monkeypatch.setattr(planned_visit, "_of_size", lambda *_: next(left))
    found = explanations(warm[0], "law(bias,sine X)", "law(EZX,sine X)", places=(60.0,))
    assert planned(found, warm[0], np.random.default_rng(0)) is plans[taken]
    assert next(left, None) is None


def test_poses_between_those_of_the_run_are_offered_from_known_sides() -> None:
    text, *_ = law_case(np.random.default_rng(3), "fork", None, poses=3)
    run = without_copies(read_back(text, MACHINES["fork"]))
    offers = visiting_touches(run, 24, 16, np.random.default_rng(0))
    for axis in "BC":
        recorded, offered = (np.round(np.degrees(t.reading(axis)), 4)
                             for t in (run.touches, offers))  # fmt: skip
        assert recorded.min() <= offered.min() < offered.max() <= recorded.max()
        assert not set(offered) <= set(recorded)
    for number in np.unique(offers.pose):
        rows = offers.pose == number
        assert np.ptp(offers.reading("B")[rows]) == np.ptp(offers.reading("C")[rows]) == 0.0
    before, now = (_tool_seen_by_the_standard(t) for t in (run.touches, offers))
    for feature in np.unique(offers.feature):
        own = before[run.touches.feature == feature]
        nearest = (now[offers.feature == feature] @ own.T).max(axis=1)
        assert np.degrees(np.arccos(np.minimum(nearest, 1.0))).max() < 15.01


def _tool_seen_by_the_standard(t) -> np.ndarray:
    """Chain `w C' X' f Y Z B t`: B turns the spindle about Y; C' turns the table against C."""
    clamped = [s.T_table_artefact for s in t.setups]
    turn = np.array([np.arctan2(T[1, 0], T[0, 0]) for T in clamped])[t.setup] - t.reading("C")
    along, up = np.sin(t.reading("B")), np.cos(t.reading("B"))
    return np.stack([np.cos(turn) * along, -np.sin(turn) * along, up], axis=1)


def test_a_law_may_act_only_where_it_was_seen(warm) -> None:
    """Its window over another axis is that of the touches at which it acts."""
    run = warm[0]
    x, y = run.touches.reading("X"), run.touches.reading("Y")
    acts = np.abs(x - np.median(x)) < 40.0
    law = parse_effect("law(bias,window X)", run.touches.chain)
    law = replace(law, places=(np.median(x) - 40.0, np.median(x) + 40.0), is_sought=False)
    run = replace(run, deviation=run.deviation + 5.0 * UM * acts)
    start = Beginning.of_run(run)
    fit = start.fitted([law], True)
    one = SimpleNamespace(law=law)
    learning = SimpleNamespace(
        laws=[one], tangent=fit, beginning=start, after=fit, before=start.fit, policy=POLICY
    )
    found = {h.law.name: h for h in unseen(learning)}
    window = found["law(bias,window X,window Y)"]
    assert window.is_unseen
    assert window.law.places[2:] == pytest.approx((y[acts].min(), y[acts].max()), abs=0.2)
    # the run speaks against neither: simplicity alone does
    assert window.log_odds > 0.0


def test_without_rivals_there_is_nothing_to_plan(warm, tmp_path) -> None:
    run = warm[0]
    assert planned([], run, np.random.default_rng(0)).refusal is NoPlan.NO_LAW
    one = explanations(run, "law(EZX,lin T-spindle)")
    assert planned(one, run, np.random.default_rng(0)).refusal is NoPlan.DECIDED
    empty = learn_laws(run)
    plan = plan_visit(empty, np.random.default_rng(0))
    assert plan.refusal is NoPlan.NO_LAW
    write_learnt(tmp_path, empty, "run.csv", plan)
    table = json.loads((tmp_path / "law.json").read_text(encoding="utf-8"))
    assert table["next_visit"]["refusal"] == "no law was learnt"
    assert table["next_visit"]["power"] is None
    assert not (tmp_path / "next_visit.csv").exists()


def test_a_rival_that_no_visit_distinguishes_asks_for_no_longer_one(warm) -> None:
    """A wave of nearly the same period stays open after any visit."""
    run = warm[0]
    x = run.touches.reading("X")
    seen = replace(run, deviation=run.deviation + 3.0 * UM * np.cos(2.0 * np.pi * x / 60.0))
    found = explanations(seen, "law(bias,sine X)", "law(EZX,sine X)", places=(60.0,))
    nearly = explanations(seen, "law(bias,sine X)", places=(60.1,))
    plan = planned([*found, *nearly], seen, np.random.default_rng(0))
    assert [one.is_distinguished for one in plan.rivals] == [True, False]
    assert len(plan.touches) <= SIZES[0]


def test_a_plan_without_touches_takes_no_time() -> None:
    table = visit_table(VisitPlan(refusal=NoPlan.DECIDED))
    assert list(table.values()) == [
        0,
        0,
        0.0,
        0.0,
        0.0,
        None,
        1.0,
        None,
        [],
        [],
        NoPlan.DECIDED.value,
    ]
