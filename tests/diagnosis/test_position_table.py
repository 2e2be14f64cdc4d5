"""Positioning tests as laser makers write them, diagnosed: a table where no law does, else the law.

The axes are made up here by their own formulas; what is held out is a cycle outside the fit.
"""

from dataclasses import replace

import numpy as np
import pytest
from marks import slow
from unchanged import answer_text

from matstd.diagnosis.answer import acts_as_instrument, diagnose
from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.fit import Prior
from matstd.diagnosis.search import DiagnosisTask, searched
from matstd.importers import one_axis_machine, positioning_run
from matstd.importers.instruments import PositioningTest
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.record import Instrument, Run
from matstd.twin.units import UM

L = 500.0
NOISE = 0.3 * UM
TARGETS = 21


def bump(x):
    return 6.0 * np.exp(-(((x - 180.0) / 40.0) ** 2))


def pitch(x):
    return 2.0 * np.sin(2.0 * np.pi * x / 9.7)


def quartic(x):
    u = 2.0 * x / L - 1.0
    return 5.0 * (8.0 * u**4 - 8.0 * u**2 + 1.0)


def uneven_reversal(x):
    return 2.0 + 4.0 * np.exp(-(((x - 300.0) / 60.0) ** 2))


def errors_of_plates(x):
    """A scale glued from pieces: every 50 mm another slope."""
    knots = np.arange(0.0, L + 1.0, 50.0)
    return np.interp(x, knots, np.cumsum(np.random.default_rng(99).normal(0.0, 1.5, len(knots))))


AXES = {
    "nothing": (lambda x: 0.0 * x, lambda x: 0.0 * x, []),
    "too long": (lambda x: 0.02 * x, lambda x: 0.0 * x, []),
    "reversal": (lambda x: 0.01 * x, lambda x: 4.0 + 0.0 * x, ["backlash(X)"]),
    "pitch": (pitch, lambda x: 0.0 * x, ["periodic(EXX)"]),
    "quartic": (quartic, lambda x: 0.0 * x, ["geometric(EXX,3-4)"]),
    "worn place": (bump, lambda x: 0.0 * x, ["position-table(EXX)"]),
    "glued scale": (errors_of_plates, lambda x: 2.0, ["backlash(X)", "position-table(EXX)"]),
    "uneven reversal": (lambda x: 0.0 * x, uneven_reversal, ["position-table(EXX,directions)"]),
    "worn place and pitch": (
        lambda x: bump(x) + pitch(x),
        lambda x: 2.0,
        ["backlash(X)", "periodic(EXX)", "position-table(EXX)"],
    ),
}


def positioning(name: str, cycles: int = 6, seed: int = 1) -> Run:
    """A test of one axis, up and down, as the importer makes a run of it."""
    curve, reversal, _ = AXES[name]
    rng = np.random.default_rng(seed)
    count = 2 * TARGETS if "pitch" in name else TARGETS
    at = np.linspace(0.0, L, count)
    at[1:-1] += rng.uniform(-0.2, 0.2, count - 2) * L / count  # targets off the pitch, ISO 230-2
    target = np.tile(np.concatenate([at, at[::-1]]), cycles)
    sign = np.tile(np.repeat([1, -1], count), cycles)
    found = curve(target) + 0.5 * sign * reversal(target) + rng.normal(0.0, 0.3, len(target))
    cycle = np.repeat(np.arange(1, cycles + 1), 2 * count)
    table = PositioningTest("X", target, found * UM, cycle, sign, np.arange(len(target)))
    return positioning_run(table, one_axis_machine("X", target), NOISE)


@pytest.mark.parametrize("name", AXES)
def test_a_table_is_named_where_no_law_does_the_same(name, unchanged) -> None:
    """With a law, and then with fewer numbers, the law has the name; and either predicts."""
    run = positioning(name)
    held = run.repeat == 6
    run = replace(run, split=np.where(held, "test", "train").astype("U5"))
    result = diagnose(run)
    assert sorted(e.name for e in result.found) == AXES[name][2]
    assert result.fit.test_rms < 1.2 * NOISE
    sizes = [r for s in result.steps[1:] for r in s.reported if r.name == "rms_um"]
    assert all(r.u < 0.1 * r.value for r in sizes)
    for step in result.steps[1:]:
        check_sizes(name, {r.quantity: r for r in step.reported})
    unchanged(answer_text(result))


def check_sizes(name, expected) -> None:
    """The reported curve is what was put in: over the targets, line and other laws off."""
    curve, reversal, laws = AXES[name]
    x = np.linspace(0.0, L, 2001)
    if "peak_to_valley" in expected and "periodic(EXX)" not in laws:
        turned = reversal(x) if "reversal_at_most" in expected else 0.0 * x
        mean = curve(x) - np.polyval(np.polyfit(x, curve(x), 1), x)
        both = np.concatenate([mean + 0.5 * turned, mean - 0.5 * turned])
        assert expected["peak_to_valley"].value == pytest.approx(np.ptp(both), rel=0.1, abs=0.4)
    if "reversal_at_most" in expected:
        mean, most = expected["reversal_on_average"], expected["reversal_at_most"]
        assert mean.value == pytest.approx(reversal(x).mean(), abs=4.0 * mean.u)
        assert most.value == pytest.approx(reversal(x).max(), abs=4.0 * most.u)


@pytest.mark.parametrize("name", ["pitch", "reversal", "quartic"])
def test_a_named_effect_predicts_at_least_as_well_as_the_table(name) -> None:
    """What a law says needs fewer numbers: on a held-out cycle it is no worse."""
    run = positioning(name, cycles=3)
    run = replace(run, split=np.where(run.repeat == 3, "test", "train").astype("U5"))
    named = diagnose(run).fit
    table = "position-table(EXX,directions)" if name == "reversal" else "position-table(EXX)"
    start = ordinary_model(run.touches.chain)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    effect = parse_effect(table, run.touches.chain)
    assert named.test_rms <= 1.01 * task.fit((ScaledEffect(effect),)).test_rms


def test_a_test_of_three_cycles_is_held_out_by_targets() -> None:
    assert len(np.unique(positioning("nothing", cycles=3).touches.pose)) == TARGETS
    assert len(np.unique(positioning("nothing", cycles=4).touches.pose)) == 4


def in_cycles(added, cycles: int = 5) -> Run:
    """A test of eleven targets with a reversal and something of its own at every reading."""
    at = np.linspace(0.0, L, 11) + 4.0 * np.sin(np.arange(11) ** 2)
    target = np.tile(np.concatenate([at, at[::-1]]), cycles)
    sign, number = np.tile(np.repeat([1, -1], 11), cycles), np.arange(len(target))
    found = 0.01 * target + 0.7 * sign + added(number / 22.0)
    table = PositioningTest("X", target, found * UM, 1 + number // 22, sign, number)
    return positioning_run(table, one_axis_machine("X", target), NOISE)


@pytest.mark.parametrize(("instant", "size"), [(3.0, 5.0), *slow((1.3, -3.0), (2.5, 1.5))])
def test_a_slip_in_a_table_without_times_is_no_growth(instant, size, unchanged) -> None:
    """The reflector slips once; warming and a growth from cycle to cycle are its rivals."""
    noise = np.random.default_rng(4).normal(0.0, 0.3, 110)
    found = diagnose(in_cycles(lambda done: size * (done > instant - 1e-9) + noise))
    steps = {s.effect.name: s for s in found.steps if s.effect is not None}
    assert set(steps) == {"jump(EXX,V_cycles_done_1)", "backlash(X)"}
    numbers = {r.quantity: r for r in steps["jump(EXX,V_cycles_done_1)"].reported}
    assert numbers["amplitude"].value == pytest.approx(size, abs=4.0 * numbers["amplitude"].u)
    assert numbers["cycles_done"].value == pytest.approx(instant, abs=2.0 / 22.0)
    # uniform between the two readings, as nothing in the run distinguishes more
    assert numbers["cycles_done"].u == pytest.approx(1.0 / 22.0 / np.sqrt(12.0), rel=0.05)
    assert found.fit.test_rms < 1.2 * NOISE
    touches = found.run.touches
    assert [acts_as_instrument(e, touches) for e in found.found] == [
        e.kind == "jump" for e in found.found
    ]
    probed = replace(touches, instrument=Instrument.TOUCH_PROBE)
    assert not any(acts_as_instrument(e, probed) for e in found.found)
    unchanged(answer_text(found))


def test_noise_that_wanders_is_no_slip() -> None:
    """Of the same size, each reading with 0.95 of the error of the one before."""
    rng, z = np.random.default_rng(1), np.zeros(110)
    for i in range(1, 110):
        z[i] = 0.95 * z[i - 1] + np.sqrt(1.0 - 0.95**2) * rng.normal()
    run = in_cycles(lambda _: 0.9 * z)
    jump = parse_effect("jump(EXX,V_cycles_done_1)", run.touches.chain)
    candidates = [jump, parse_effect("backlash(X)", run.touches.chain)]
    start = ordinary_model(run.touches.chain)
    task = DiagnosisTask(run, start, Prior.of_effects(start.effects))
    assert jump.name in {s.effect.name for s in searched(task, candidates).effects}
    assert [e.name for e in diagnose(run, candidates=candidates).found] == ["backlash(X)"]
