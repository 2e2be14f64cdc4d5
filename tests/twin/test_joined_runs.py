"""Several runs as one: what is joined, what stays each run's own, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.twin.errors import DesignError
from matstd.twin.library import parse_effect
from matstd.twin.model import columns
from matstd.twin.record import Instrument, joined
from matstd.twin.units import NM


@pytest.fixture(scope="module")
def two(case):
    """Two runs of one machine, the second with a spindle that turns and without a sensor less."""
    return case(7, "hsm600u").run, case(11, "hsm600u").run


def test_setups_poses_and_times_stay_those_of_their_run(two) -> None:
    run = joined({"spring": two[0], "autumn": two[1]})
    t = run.touches
    assert t.runs == ("spring", "autumn")
    assert {s.name for s in t.setups} >= {"spring/a", "autumn/a"}
    for i, one in enumerate(two):
        own = run[t.run == i]
        np.testing.assert_array_equal(own.deviation, one.deviation)
        np.testing.assert_allclose(own.touches.since_start, one.touches.time, atol=NM)
        np.testing.assert_allclose(own.touches.point_table, one.touches.point_table, atol=NM)
        np.testing.assert_array_equal(own.touches.pose, one.touches.pose)
    assert t.time[t.run == 1].min() > t.time[t.run == 0].max()
    assert run.fingerprints[:2] == tuple(one.fingerprint for one in two)


@pytest.mark.parametrize(
    "name",
    ["thermal-lag(EZZ)", "thermal-lag(EZZ,spindle)", "drift", "thermal-lag(EZZ,spindle_rpm)"],
)
def test_what_happened_in_one_run_does_not_reach_the_next(two, name) -> None:
    """A body is as warm in each run as if the others had not been."""
    rng = np.random.default_rng(0)
    runs = []
    for one in two:
        rpm = rng.choice([0.0, 6000.0, 12000.0], len(one))
        runs.append(replace(one, touches=replace(one.touches, spindle_rpm=rpm)))
    both = joined({"spring": runs[0], "autumn": runs[1]}).touches
    effect = parse_effect(name, both.chain)
    alone = [columns([effect], one.touches) for one in runs]
    np.testing.assert_allclose(columns([effect], both), np.concatenate(alone), atol=1e-9)


def test_what_one_run_has_not_recorded_is_left_out_and_said(two) -> None:
    t = two[1].touches
    fewer = {k: v for k, v in t.temperature.items() if k != "spindle"}
    less = replace(two[1], touches=replace(t, temperature=fewer))
    run = joined({"spring": two[0], "autumn": less})
    assert "spindle" not in run.touches.temperature
    assert len(run.touches.temperature) == len(fewer)
    assert any("T_spindle_degC is not in autumn" in remark for remark in run.remarks)


def test_one_run_is_itself(two) -> None:
    run = joined({"spring": two[0]})
    assert run.touches.runs == ("",)
    assert run.fingerprints == (two[0].fingerprint,)


def test_another_machine_another_instrument_and_the_same_run_twice_are_refused(two, case) -> None:
    other = case(7, "fork").run
    with pytest.raises(DesignError, match="autumn: of another machine than spring: name is 'fork'"):
        joined({"spring": two[0], "autumn": other})
    laser = replace(two[1], touches=replace(two[1].touches, instrument=Instrument.LASER))
    with pytest.raises(DesignError, match="autumn: measured by laser, expected touch-probe"):
        joined({"spring": two[0], "autumn": laser})
    with pytest.raises(DesignError, match="the same measurements as spring"):
        joined({"spring": two[0], "autumn": two[0]})
    with pytest.raises(DesignError, match="no run"):
        joined({})
