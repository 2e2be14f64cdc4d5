"""Effects after recorded drives, against the differential equation solved by another library."""

import re
from dataclasses import replace

import numpy as np
import pytest
from made_up import gauge_touches
from scipy.integrate import solve_ivp

from matstd.twin.effects import Repeated
from matstd.twin.errors import BadFile, UnknownEffect
from matstd.twin.files import read_run, write_run
from matstd.twin.library import parse_effect, proposals
from matstd.twin.model import columns
from matstd.twin.record import Run, Touches, without_copies
from matstd.twin.thermal import field
from matstd.twin.thermal.thermal_field import LAGS, ThermalField
from matstd.twin.units import UM

N = 60
INTEGRATED = 1e-6
"""Relative accuracy asked of the integrator."""


@pytest.fixture
def touches() -> Touches:
    """One linear axis that stands still under a dial gauge along +Z, with two sensors."""
    rng = np.random.default_rng(4)
    time = np.cumsum(rng.uniform(30.0, 90.0, N))
    bed = 25.0 + 60.0 * (1.0 - np.exp(-time / 500.0))
    frame = 22.0 + 4.0 * np.sin(time / 900.0)
    return gauge_touches(
        time,
        temperature={"bed": bed, "frame": frame},
        spindle_rpm=np.where(time > 1000.0, 4000.0, 0.0),
        value={"flow_l_min": 5.0 + 3.0 * np.cos(time / 700.0)},
    )


def solved(touches: Touches, drive: np.ndarray, tau: float, begin: float) -> np.ndarray:
    """``tau dy/dt = d - y`` with the drive straight between records, by Runge and Kutta."""
    t = touches.time
    found = solve_ivp(
        lambda at, y: (np.interp(at, t, drive) - y) / tau,
        (t[0], t[-1]),
        [begin],
        t_eval=t,
        max_step=5.0,
        rtol=INTEGRATED,
        atol=1e-9,
    )
    return found.y[0]


def test_at_once_is_the_temperature_against_the_normal(touches) -> None:
    """Z longer by a (T - 20) on the tool side: a surface that looks up seems to stand lower."""
    column = columns([parse_effect("thermal-static(EZZ,frame)", touches.chain)], touches)[:, 0]
    np.testing.assert_allclose(column, -(touches.temperature["frame"] - 20.0), atol=1e-12)


def test_a_column_of_the_users_own_is_followed_in_steps_of_its_own(touches) -> None:
    (effect,) = [e for e in proposals(touches, ["follows"]) if e.name.startswith("follows(EZZ")]
    assert effect.name == "follows(EZZ,flow_l_min)"
    column = columns([effect], touches)[:, 0]
    values = touches.value["flow_l_min"]
    np.testing.assert_allclose(column, -values / 1.0, atol=1e-12)
    assert parse_effect("follows(EZZ,V_flow_l_min)", touches.chain).name == effect.name
    with pytest.raises(UnknownEffect, match=r"no column 'V_flaw_l_min'.*flow_l_min"):
        columns([parse_effect("follows(EZZ,flaw_l_min)", touches.chain)], touches)


def test_a_field_is_the_sum_of_lags_that_an_integrator_finds(touches) -> None:
    warm = field(touches)
    assert isinstance(warm, ThermalField)
    assert warm.name == "thermal-field(Z,bed,frame,spindle_rpm,V_flow_l_min)"
    assert parse_effect(warm.name, touches.chain) == warm
    C = columns([warm], touches)
    names = [p.name for p in warm.parameters]
    for drive in ("bed", "frame"):
        warmth = touches.temperature[drive] - 20.0
        at_once = C[:, names.index(f"EZ {drive} at once")]
        np.testing.assert_allclose(at_once, -warmth, atol=1e-12)
        for tau in LAGS:
            first_order_lag = C[:, names.index(f"EZ {drive} {tau / 60:g} min")]
            expected = -solved(touches, warmth, tau, warmth[0])
            np.testing.assert_allclose(first_order_lag, expected, atol=1e-3)
    assert not any(n.startswith("EZ spindle_rpm at once") for n in names)
    assert C.shape[1] == 6 * (3 * (1 + len(LAGS)) + len(LAGS))
    flow = touches.value["flow_l_min"]
    half = columns([warm.tuned(2.0)], touches)  # in steps of 2 l/min
    for values, k in (
        (flow, names.index("EZ V_flow_l_min at once")),
        (solved(touches, flow, LAGS[1], flow[0]), names.index("EZ V_flow_l_min 16 min")),
    ):
        np.testing.assert_allclose(C[:, k], -values, atol=1e-3)
        np.testing.assert_allclose(half[:, k], -values / 2.0, atol=1e-3)


def test_an_own_column_is_followed_with_a_lag_that_an_integrator_finds(touches) -> None:
    """Flow of 5 l/min that swings by 3: a step of 1 l/min, in balance at the first record."""
    offered = {e.name: e for e in proposals(touches, ["thermal-lag"])}
    lag = offered["thermal-lag(EZZ,V_flow_l_min)"].tuned(900.0, 1.0)
    assert [p.unit for p in lag.parameters] == ["mm"]
    flow = touches.value["flow_l_min"]
    expected = -solved(touches, flow, 900.0, flow[0])
    np.testing.assert_allclose(columns([lag], touches)[:, 0], expected, atol=1e-3)
    coarse = columns([lag.tuned(900.0, 10.0)], touches)[:, 0]
    np.testing.assert_allclose(coarse, expected / 10.0, atol=1e-4)
    assert list(lag.tuning) == [i.name for i in lag.inner(touches)] == ["tau", "step"]
    with pytest.raises(UnknownEffect, match="no column 'V_flo_l_min'"):
        columns([parse_effect("thermal-lag(EZZ,V_flo_l_min)", touches.chain)], touches)


def test_an_effect_stands_twice_with_inner_parameters_of_its_own(touches) -> None:
    first = parse_effect("thermal-lag(EZZ,bed)", touches.chain).tuned(300.0)
    second = parse_effect("thermal-lag(EZZ,bed)#2", touches.chain).tuned(3000.0)
    assert isinstance(second, Repeated)
    assert (second.name, second.kind) == ("thermal-lag(EZZ,bed)#2", "thermal-lag")
    C = columns([first, second], touches)
    warmth = touches.temperature["bed"] - 20.0
    for column, tau in zip(C.T, (300.0, 3000.0), strict=True):
        np.testing.assert_allclose(column, -solved(touches, warmth, tau, warmth[0]), atol=1e-3)


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("thermal-lag(EZZ,bed)#1", "a number from 2"),
        ("thermal-lag(EZZ,bed)#two", "a number from 2"),
        ("thermal-static(EZZ,bed)#2", "no inner parameter"),
        ("thermal-field(Z)", "an axis, then sensors"),
        ("thermal-field(Q,bed)", "an axis of Z"),
        ("thermal-field(Z,bed,bed)", "every drive once"),
    ],
)
def test_names_that_mean_nothing(touches, name, fault) -> None:
    with pytest.raises(UnknownEffect, match=fault):
        parse_effect(name, touches.chain)


def gauge_run(touches: Touches, deviation: np.ndarray) -> Run:
    return Run(touches, deviation, np.full(len(touches), 0.5 * UM))


def test_columns_of_the_users_own_go_through_a_file(touches, tmp_path) -> None:
    (tmp_path / "m.toml").write_text(
        'format = "machine/1"\nname = "gauge"\nchain = "[w f Z t]"\n'
        "[axis.Z]\nrange = [0.0, 350.0]\n"
    )
    deviation = np.random.default_rng(1).normal(size=N) * UM
    write_run(tmp_path / "run.csv", gauge_run(touches, deviation), "m.toml")
    again = read_run(tmp_path / "run.csv")
    np.testing.assert_allclose(
        again.touches.value["flow_l_min"], touches.value["flow_l_min"], rtol=1e-8
    )
    text = (tmp_path / "run.csv").read_text().splitlines()
    head = next(i for i, line in enumerate(text) if line.startswith("feature"))
    cells = text[head + 3].split(",")
    cells[text[head].split(",").index("V_flow_l_min")] = ""
    text[head + 3] = ",".join(cells)
    (tmp_path / "gap.csv").write_text("\n".join(text) + "\n")
    gap = read_run(tmp_path / "gap.csv")
    flow = touches.value["flow_l_min"]
    t = touches.time
    between = np.interp(t[2], t[[1, 3]], flow[[1, 3]])
    assert gap.touches.value["flow_l_min"][2] == pytest.approx(between)
    assert any("V_flow_l_min has no number in 1 row; the readings" in r for r in gap.remarks)
    bare = "\n".join(text).replace("V_flow_l_min", "V_flow")
    (tmp_path / "bare.csv").write_text(bare + "\n")
    with pytest.raises(BadFile, match=r"V_flow: found no unit.*V_flow_bar"):
        read_run(tmp_path / "bare.csv")
    (tmp_path / "cold.csv").write_text("\n".join(text).replace("T_bed_degC", "T_bed") + "\n")
    with pytest.raises(BadFile, match=r"T_bed: found no unit.*T_bed_degC"):
        read_run(tmp_path / "cold.csv")


@pytest.mark.parametrize(
    ("column", "sign", "accepted"),
    [
        ("V_2nd-tank_bar", "'-' (hyphen-minus)", "V_2nd_tank_bar"),
        ("V_tank 2_bar", "' ' (space)", "V_tank_2_bar"),
        ("V_\u00d6ldruck (Tank 2)_bar", "' ' (space)", "V_\u00d6ldruck_Tank_2_bar"),
        ("V_O\u0308l_bar", "'\u0308' (combining diaeresis)", "V_\u00d6l_bar"),
        ("V_flow_l/min", "'/' (solidus)", "V_flow_l_min"),
        ("V_tank-2", "'-' (hyphen-minus)", "V_tank_2_bar"),
        ("V_-_bar", "'-' (hyphen-minus)", "V_bar_bar"),
        ("T_head-1_degC", "'-' (hyphen-minus)", "T_head_1_degC"),
        ("T_head-1", "'-' (hyphen-minus)", "T_head_1_degC"),
        ("T_(_degC", "'(' (left parenthesis)", "T_bed_degC"),
    ],
)
def test_a_name_is_refused_by_the_sign_that_cannot_stand_in_it(
    column, sign, accepted, touches, tmp_path
) -> None:
    """What the message proposes is read."""
    (tmp_path / "m.toml").write_text(
        'format = "machine/1"\nname = "gauge"\nchain = "[w f Z t]"\n'
        "[axis.Z]\nrange = [0.0, 350.0]\n"
    )
    path = tmp_path / "run.csv"
    write_run(path, gauge_run(touches, np.random.default_rng(1).normal(size=N) * UM), "m.toml")
    own = {"V": "V_flow_l_min", "T": "T_bed_degC"}[column[0]]
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(own, column), encoding="utf-8")
    words = f"column {column}: found {sign}, expected a name of letters, digits and _, its unit"
    with pytest.raises(BadFile, match=re.escape(words) + f".* such as {accepted}$"):
        read_run(path)
    path.write_text(text.replace(own, accepted), encoding="utf-8")
    read = read_run(path).touches
    assert accepted[2:].removesuffix("_degC") in {*read.value, *read.temperature}


def test_a_drift_test_read_coarsely_is_no_pile_of_copies(touches) -> None:
    """One place, readings to 1 µm: most rows agree with an earlier one, and all are measured."""
    warmth = 3.0 * (1.0 - np.exp(-np.arange(N) / 20.0))
    coarse = np.round(4.0 * warmth) * UM
    still = replace(touches, temperature={"room": 20.0 + warmth}, value={}, spindle_rpm=np.zeros(N))
    run = gauge_run(still, coarse)
    assert len(np.unique(coarse)) < N / 3
    assert without_copies(run) is run


def test_rows_that_differ_in_a_temperature_are_no_copies(touches) -> None:
    fine = np.random.default_rng(2).normal(size=N) * UM
    run = gauge_run(touches, fine)
    pasted = run[np.tile(np.arange(N), 3)]
    later = np.concatenate([touches.time, touches.time + 1e5, touches.time + 2e5])
    moved = replace(pasted.touches, time=later)
    assert len(without_copies(replace(pasted, touches=moved))) == N
    warmer = {k: np.r_[v, v + 0.25, v - 0.25] for k, v in touches.temperature.items()}
    honest = replace(pasted, touches=replace(moved, temperature=warmer))
    assert len(without_copies(honest)) == 3 * N


def test_cycles_read_in_steps_are_no_copies_though_no_time_was_recorded(touches) -> None:
    """Five cycles over 22 targets, noise 0.5 µm, read in 0.1 µm: chance alone repeats some."""
    rng = np.random.default_rng(5)
    t = replace(touches, q=np.linspace(0.0, 350.0, N)[:, None], time=np.zeros(N), temperature={})
    cycles = replace(t, value={}, spindle_rpm=None)[np.tile(np.arange(22), 5)]
    read = np.round(rng.normal(0.0, 0.5, len(cycles)), 1) * UM
    run = Run(touches=cycles, deviation=read, u=np.full(len(cycles), 0.5 * UM))
    assert len(np.unique(np.column_stack([cycles.q, read]), axis=0)) < len(run)
    assert len(without_copies(run)) == len(run)
    # read finely, what agrees to the last digit was copied
    fine = rng.normal(0.0, 0.5, len(cycles)) * UM
    fine[22:26] = fine[:4]
    assert len(without_copies(replace(run, deviation=fine))) == len(run) - 4
