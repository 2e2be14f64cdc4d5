"""Saved laws of a drift as errors of a machine: against closed forms of heat, and probed."""

import json
from dataclasses import replace

import numpy as np
import pytest
from bench import LENGTH

from matstd.api.known_errors import with_unknowns
from matstd.cli import main
from matstd.compensation.field import MachineErrors, State, deviation
from matstd.compensation.service import OutputLimits, Service
from matstd.compensation.service.output import Quality
from matstd.diagnosis.drift import DriftRecord, Judged, JudgedLaws, write_drift
from matstd.diagnosis.drift.lags import Lagged
from matstd.diagnosis.drift.linear import LinearLaw
from matstd.effect_kinds import DRIFT_LAW
from matstd.twin.errors import BadFile, DesignError, UnknownEffect, UnknownSymbol
from matstd.twin.library import parse_effect, register
from matstd.twin.record import at_poses
from matstd.twin.units import HOUR, MINUTE, UM, URAD

STEP, TAU, SPIN = 60.0, 0.5 * HOUR, 20.0 * MINUTE
PER_K, PER_RPM, TILT = 4.0 * UM, 0.01 * UM, 3.0 * URAD
KNOWN, LEFT, MEMORY = 0.05, np.array([1.0 * UM, 2.0 * URAD]), 30.0 * MINUTE
"""Standard deviations: of a coefficient, per unit of what the law leaves; of that itself."""


@pytest.fixture(scope="module")
def thermal_json(tmp_path_factory):
    """z follows a frame with 30 min and the spindle with 20 min; a tilt follows the frame alone."""
    places = (("frame", TAU), ("spindle_rpm", SPIN))
    law = LinearLaw(
        inputs=Lagged(places),
        mean=np.array([20.0, 2000.0]),
        scale=np.array([2.0, 1000.0]),
        intercept=np.array([PER_RPM * 2000.0, 0.0]),
        coefficients=np.array([[2.0 * PER_K, 2.0 * TILT], [1000.0 * PER_RPM, 0.0]]),
        weight=1e-6,
        covariance=np.diag([1e-3, KNOWN**2, KNOWN**2]),
        residual=LEFT,
        memory=MEMORY,
    )
    nothing = np.zeros(2)
    judged = Judged(
        name="lags",
        law=law,
        one_step=nothing,
        left_out=nothing,
        free_run=nothing,
        noisy=None,
        factor=np.ones(2),
    )
    record = DriftRecord(
        time=STEP * np.arange(3),
        stretch=np.zeros(3, dtype=np.int64),
        step=STEP,
        drives=("frame", "spindle_rpm"),
        drive=np.zeros((3, 2)),
        components=("z", "tilt"),
        units=("mm", "rad"),
        displacement=np.zeros((3, 2)),
    )
    path = tmp_path_factory.mktemp("law") / "thermal.json"
    rows = np.arange(3)
    found = JudgedLaws(record=record, train=rows, held=rows, judged=[judged], best=judged)
    write_drift(path, found, {})
    return path


@pytest.fixture
def drifting(thermal_json, bench_chain):
    """The law of z on EZZ and of the tilt on EAY, which are parts of one effect."""
    register(DRIFT_LAW)
    return parse_effect(f"drift-law({thermal_json},z:EZZ,tilt:-EAY)", bench_chain).whole


def at_state(drifting, chain, **state):
    """A machine whose only error is the law, at a state."""
    errors = MachineErrors.of_errors(chain, [], State(**state))
    return errors.with_known([(drifting, drifting.known[0])], drifting.known[1])


def warmth(time, tau):
    return -np.expm1(-np.maximum(time, 0.0) / tau)


# --- replayed ---------------------------------------------------------------------------------


def test_irregular_touches_give_what_heat_gives(drifting, bench_chain):
    """Frame from 20 to 24 degC in a straight hour, spindle on at 40 min: closed forms."""
    rng = np.random.default_rng(4)
    time = rng.permutation(np.concatenate([[0.0], rng.uniform(0.0, 3.0 * HOUR, 400), [9e3]]))
    touches = replace(
        at_poses(bench_chain, np.zeros((len(time), 6)), LENGTH),
        time=time,
        temperature={"frame": 20.0 + 4.0 * np.minimum(time / HOUR, 1.0)},
        spindle_rpm=np.where(time >= 40.0 * MINUTE, 3000.0, 0.0),
    )
    ramp = np.minimum(time, HOUR) / HOUR - TAU / HOUR * (
        warmth(time, TAU) - warmth(time - HOUR, TAU)
    )
    expected = PER_K * 4.0 * ramp + PER_RPM * 3000.0 * warmth(time - 40.0 * MINUTE, SPIN)
    found = drifting.replay(touches).predicted
    np.testing.assert_allclose(found[:, 0], expected, atol=0.6 * UM)
    np.testing.assert_allclose(found[:, 1], TILT * 4.0 * ramp, atol=0.1 * URAD)


def test_columns_move_what_they_are_bound_to(drifting, bench_chain):
    """One pose by hand: Z grows, and about X the way from the foot of Y's table turns."""
    state = {"time": 10.0 * HOUR, "temperature": {"frame": 25.0}, "spindle_rpm": 1000.0}
    errors = at_state(drifting, bench_chain, **state)
    q = np.zeros((1, 6))
    moved = deviation(errors, errors.touches(q, LENGTH))[0]
    assert moved[2] == pytest.approx(5.0 * PER_K + 1000.0 * PER_RPM, rel=1e-3)
    only = parse_effect(f"drift-law({drifting.path},z:EYY@-100:300)", bench_chain)
    assert [p.name for p in only.parameters] == ["law"]  # all that touches have to determine
    y = bench_chain.axis_index("Y")
    q = np.zeros((3, 6))
    q[:, y] = -100.0, 100.0, 300.0
    slope = replace(errors, effects=(only,), theta=(np.ones(1),))
    along = deviation(slope, slope.touches(q, LENGTH))[:, 1]
    np.testing.assert_allclose(along, moved[2] * np.array([0.0, 0.5, 1.0]), rtol=1e-3, atol=1e-9)


def test_u_is_that_of_the_law_and_grows_beyond_its_training(drifting, bench_chain):
    for degc in (20.0, 40.0):
        state = {"time": 10.0 * HOUR, "temperature": {"frame": degc}, "spindle_rpm": 2000.0}
        errors = at_state(drifting, bench_chain, **state)
        at = errors.touches(np.zeros((1, 6)), LENGTH)
        z = errors.columns(at)[0, 2] @ errors.root
        expected = LEFT[0] * np.sqrt(1.0 + 1e-3 + (KNOWN * (degc - 20.0) / 2.0) ** 2)
        assert np.linalg.norm(z) == pytest.approx(expected, rel=1e-3)


def test_a_model_learns_how_much_of_a_law_there_is_and_keeps_its_unknowns(drifting, bench_chain):
    """A model's law, 0.9 +- 0.1, between two other errors: covariances stay where they were."""
    law = parse_effect(drifting.name, bench_chain)
    others = [parse_effect(n, bench_chain) for n in ("backlash(X)", "backlash(Y)")]
    state = State(time=HOUR, temperature={"frame": 25.0}, spindle_rpm=0.0)
    known = [(others[0], np.ones(1)), (law, np.array([0.9])), (others[1], np.ones(1))]
    root = np.array([[1.0, 0.0], [0.0, 0.1], [0.5, 0.5]])
    errors = MachineErrors.of_errors(bench_chain, [], state).with_known(known, root)
    wide = with_unknowns(errors)
    count = len(drifting.parameters)
    assert [len(t) for t in wide.theta] == [1, count, 1]
    assert wide.theta[1][0] == 0.9
    full = wide.root @ wide.root.T
    kept = [0, 1, count + 1]
    np.testing.assert_allclose(full[np.ix_(kept, kept)], root @ root.T)
    np.testing.assert_allclose(full[2 : count + 1, 2 : count + 1], np.eye(count - 1))
    assert not full[2 : count + 1, kept].any()
    at = wide.touches(np.zeros((1, 6)), LENGTH)
    np.testing.assert_allclose(deviation(wide, at), deviation(errors, at))


# --- in the service -----------------------------------------------------------------------------


@pytest.fixture
def service(drifting, bench_chain, datum):
    errors = at_state(drifting, bench_chain, temperature={"frame": 20.0}, spindle_rpm=0.0)
    return Service(errors, LENGTH, datum, OutputLimits(most=1.0))


def warmed(service, until, begin=1.0, degc=30.0):
    for time in np.arange(begin, until + 1.0, 60.0):
        service.drive(float(time), {"frame": degc}, 0.0)


def z_added(service, datum, now):
    service.move(int(1e3 * now), shown(datum.q), now)
    return service.tick(now).k0[2]


def shown(q):
    return [float(v) for v in q]  # the rotary axes stand at zero


def test_temperatures_as_they_come(service, datum):
    """A step of 10 K a second after the preset: z goes as a first-order lag says, u from zero."""
    assert service.uncertainty(shown(datum.q))[2] == pytest.approx(0.0, abs=1e-9)
    warmed(service, HOUR)
    grown = 10.0 * PER_K * warmth(HOUR, TAU)
    assert service.drifts.drift[0] == pytest.approx(grown, rel=0.03)
    assert z_added(service, datum, 1.0) == pytest.approx(-grown, rel=0.03)
    fades = np.exp(-HOUR / MEMORY)
    moved = KNOWN * 10.0 * warmth(HOUR, TAU) / 2.0
    expected = LEFT[0] * np.sqrt(2.0 * (1.0 - fades) + moved**2)
    assert service.drifts.u[0] == pytest.approx(expected, rel=0.03)
    assert service.uncertainty(shown(datum.q))[2] == pytest.approx(service.drifts.u[0], rel=1e-9)


def test_probing_moves_the_correction_and_what_passes_fades(service, datum):
    """The machine drifts 6 um more than the law says; probed, that is corrected, then u grows."""
    warmed(service, HOUR)
    before = z_added(service, datum, 1.0)
    service.tick(1.5)
    u = service.drifts.u[0]
    service.probed([6.0 * UM, float("nan")], [0.5 * UM, float("nan")])
    gain = u**2 / (u**2 + (0.5 * UM) ** 2)
    after = z_added(service, datum, 1.6)
    assert after - before == pytest.approx(-6.0 * UM * gain, rel=1e-6)
    assert service.drifts.u[0] == pytest.approx(u * np.sqrt(1.0 - gain), rel=1e-6)
    tilted = service.drifts.drift[1]
    assert tilted == pytest.approx(10.0 * TILT * warmth(HOUR, TAU), rel=0.03)
    warmed(service, HOUR + 20.0 * MINUTE, begin=HOUR + 60.0)
    assert 0.5 * UM < service.drifts.u[0] < 1.2 * u
    law = 10.0 * PER_K * warmth(HOUR + 20.0 * MINUTE, TAU)
    left = service.drifts.drift[0] - law
    assert 0.5 * UM < left < 6.0 * UM * gain  # of what passes the larger part has gone


def test_what_was_probed_beside_a_held_correction_is_refused(service, datum):
    warmed(service, 10.0 * MINUTE)
    with pytest.raises(DesignError, match="probed while the correction was fading"):
        service.probed([0.0, 0.0], [UM, URAD])
    z_added(service, datum, 1.0)
    assert service.tick(1.0).sent.quality is Quality.VALID
    with pytest.raises(DesignError, match="1 values and 2 uncertainties probed, expected 2: z, ti"):
        service.probed([0.0], [UM, URAD])
    with pytest.raises(DesignError, match="uncertainties above zero"):
        service.probed([0.0, 0.0], [UM, 0.0])


# --- words --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "error", "said"),
    [
        ("", UnknownEffect, "the file of matstd thermal and what its columns move"),
        (",z", UnknownEffect, "a column and a component error for 'z'"),
        (",q:EZZ", UnknownEffect, "a column of the law for 'q'"),
        (",z:EAZ", UnknownEffect, "a component error in mm for 'z:EAZ'"),
        (",z:EZQ", UnknownSymbol, "EZQ"),
        (",z:EYY@1:1", UnknownEffect, "two readings after @"),
        (",z:EYY@a:1", UnknownEffect, "two readings after @"),
    ],
)
def test_what_a_law_cannot_be_bound_to(thermal_json, bench_chain, words, error, said):
    register(DRIFT_LAW)
    with pytest.raises(error) as refused:
        parse_effect(f"drift-law({thermal_json}{words})", bench_chain)
    assert said in str(refused.value)


def test_a_file_that_is_no_law(bench_chain, bench):
    register(DRIFT_LAW)
    with pytest.raises(BadFile, match=r"machine.toml.*expected a thermal\.json of ours"):
        parse_effect(f"drift-law({bench},z:EZZ)", bench_chain)


def test_an_unstable_law_is_refused(thermal_json, bench_chain, tmp_path):
    register(DRIFT_LAW)
    data = json.loads(thermal_json.read_text())
    data["law"]["inputs"]["places"][0][1] = -600.0
    changed = tmp_path / "changed.json"
    changed.write_text(json.dumps(data))
    with pytest.raises(BadFile, match="a time constant of -600 s: an unstable law"):
        parse_effect(f"drift-law({changed},z:EZZ)", bench_chain)


def test_command(bench, errors_file, thermal_json, tmp_path, refusal, unrendered):
    """Over a program of an hour the spindle warms the machine; without a sensor: a line."""
    source = tmp_path / "part.ngc"
    source.write_text("G0 X0 Y0 Z0\nG1 X100 F2.5\nG1 X0\n")
    command = ["contributions", str(bench), "--errors", str(errors_file), "--program", str(source)]
    command += ["--tool-length", str(LENGTH), "--add", f"drift-law({thermal_json},z:EZZ)"]
    command += ["--rpm", "3000", "-o", str(tmp_path / "out")]
    said = refusal(command)
    assert "thermal.json: its law follows frame; there is spindle_rpm" in said
    assert "expected --temperature, --rpm or --value" in said
    assert main([*command, "--temperature", "frame=20"]) == 0
    table = np.genfromtxt(
        tmp_path / "out" / "contributions.csv", delimiter=",", names=True, deletechars=""
    )
    name = next(n for n in table.dtype.names if n.startswith("drift-law") and "dz" in n)
    grown = 3000.0 * PER_RPM / UM * warmth(table["time_s"], SPIN)
    np.testing.assert_allclose(table[name], grown, atol=1.0)
    assert table[name].max() > 20.0
