"""What disturbs a simulated campaign: lags over the whole record, slips over all programs."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from matstd.probe_paths.campaign import VirtualMachine, effects_over_record
from matstd.probe_paths.campaign.disturbances import joined_touches
from matstd.probe_paths.campaign.virtual_run import run_programs
from matstd.twin.effects.artefact import ArtefactSlip
from matstd.twin.effects.backlash import Backlash
from matstd.twin.errors import BadFile, UnknownEffect
from matstd.twin.files import read_sensors
from matstd.twin.library import parse_effect
from matstd.twin.machine import Contribution
from matstd.twin.record import Setup, at_poses
from matstd.twin.units import MINUTE, UM, URAD

BEGIN = datetime(2031, 5, 6, 7, 0, 0)
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """A spindle that runs at 5000 rpm from minute 10 to 20; a room one degree warmer an hour."""
    path = tmp_path_factory.mktemp("sensors") / "sensors.csv"
    rows = ["clock,T_room_degC,spindle_rpm"]
    for minute in range(61):
        clock = (BEGIN + timedelta(minutes=minute)).isoformat()
        rows.append(f"{clock},{20.0 + minute / 60.0:.6f},{5000 if 10 <= minute < 20 else 0}")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return read_sensors(path)


def touches_at(chain, minutes):
    touches = at_poses(chain, np.zeros((len(minutes), len(chain.axes))), 160.0)
    touches.time[:] = MINUTE * np.asarray(minutes, dtype=float)
    return touches


def ezz(chain, added):
    return added.twist[:, chain.link_index("Z"), 2]


def test_a_lag_follows_the_spindle_between_the_touches_too(chain, record):
    """Touched at minute 5 and 40 only: between them the spindle ran, and no touch saw it."""
    tau, amplitude = 12.0, 40.0 * UM
    effect = parse_effect("thermal-lag(EZZ,spindle_rpm)", chain).tuned(tau * MINUTE)
    disturbance = effects_over_record([(effect, np.array([amplitude]))], record)
    found = ezz(chain, disturbance(touches_at(chain, [5.0, 40.0])))
    by_hand = amplitude * 0.5 * (1.0 - np.exp(-10.0 / tau)) * np.exp(-20.0 / tau)
    assert found == pytest.approx([0.0, by_hand], abs=ROUNDING)


def test_a_lag_follows_a_straight_temperature(chain, record):
    """Ramp of 1 K/h from 20 degC: y = r (t - tau (1 - exp(-t/tau)))."""
    tau, amplitude = 30.0, 2.0 * UM
    effect = parse_effect("thermal-lag(EZZ,room)", chain).tuned(tau * MINUTE)
    disturbance = effects_over_record([(effect, np.array([amplitude]))], record)
    found = ezz(chain, disturbance(touches_at(chain, [45.0])))
    by_hand = amplitude / 60.0 * (45.0 - tau * (1.0 - np.exp(-45.0 / tau)))
    assert found == pytest.approx([by_hand], abs=1e-9)


def test_a_field_follows_what_happened_between_the_touches(chain, record):
    """Its share after 16 min is what a lag of 16 min does."""
    field = parse_effect("thermal-field(Z,spindle_rpm)", chain)
    names = [p.name for p in field.parameters]
    theta = np.zeros(len(names))
    theta[names.index("EZ spindle_rpm 16 min")] = 40.0 * UM
    found = ezz(
        chain, effects_over_record([(field, theta)], record)(touches_at(chain, [5.0, 40.0]))
    )
    by_hand = 40.0 * UM * 0.5 * (1.0 - np.exp(-10.0 / 16.0)) * np.exp(-20.0 / 16.0)
    assert found == pytest.approx([0.0, by_hand], abs=ROUNDING)


def test_effects_without_a_record_are_the_plain_sum(chain, record):
    touches = touches_at(chain, [1.0, 2.0])
    touches.approach[:] = [[1.0], [-1.0]]
    pair = (Backlash("X", 0), np.array([4.0 * UM]))
    plain = effects_over_record([pair])(touches)
    with_record = effects_over_record([pair], record)(touches)
    for a, b in zip(plain, with_record, strict=True):
        assert np.array_equal(a, b)


def test_a_record_that_does_not_cover_the_run_is_refused(chain, record):
    disturbance = effects_over_record([], record)
    with pytest.raises(BadFile, match="readings over the run"):
        disturbance(touches_at(chain, [90.0]))


def test_a_drive_without_a_record_is_refused(chain):
    effect = parse_effect("thermal-lag(EZZ,spindle_rpm)", chain)
    with pytest.raises(UnknownEffect, match="spindle speed of these touches is unknown"):
        effects_over_record([(effect, np.array([1.0]))])(touches_at(chain, [1.0]))


def test_set_ups_of_one_name_are_one(chain):
    first, second = touches_at(chain, [0.0, 1.0]), touches_at(chain, [2.0])
    object.__setattr__(second, "setups", (Setup("other"), Setup("table")))
    object.__setattr__(second, "setup", np.array([1]))
    whole = joined_touches([first, second])
    assert [s.name for s in whole.setups] == ["table", "other"]
    assert whole.setup.tolist() == [0, 0, 0]
    assert whole.time.tolist() == [0.0, 60.0, 120.0]


def test_a_slip_turns_about_the_middle_of_the_whole_campaign(read, small, chain):
    """The arms of a slip count from the mean of all touches, not of those of one program."""
    effect = ArtefactSlip(instant=-1.0)
    theta = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 100.0 * URAD])
    seen = []

    def disturbance(touches):
        seen.append(touches)
        return Contribution.zeros(len(touches), len(chain.links))

    run_programs(read, small, VirtualMachine(chain, disturbance), np.random.default_rng(0))
    total = sum(len(program.touches) for program in read)
    assert {len(touches) for touches in seen} == {total}
    assert all(np.all(np.diff(touches.time) > 0.0) for touches in seen)
    plain = effects_over_record([(effect, theta)])
    shifts = np.array([plain(touches).shift.mean(axis=0) for touches in seen])
    assert np.abs(shifts).max() < 1e-9
