"""The learnt geometry: what was planted in the exact chain comes back with sign, size and name."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.geometry import (
    Estimate,
    GeometryRow,
    Quantity,
    Rung,
    geometry_rows,
    learnt_geometry,
)
from matstd.report.geometry.geometry_words import _is_usual, correction_line, noted_lines
from matstd.twin.errors import BadValue
from matstd.twin.frames import apply, inverse
from matstd.twin.library import ordinary_model
from matstd.twin.machine import Axis, make_chain, tip
from matstd.twin.record import Instrument, Run, Setup, Touches
from matstd.twin.units import UM, URAD

KEY = (2, "hsm600u")
SHRUNK = 0.03
"""What the prior may take of a planted value, as a share, beside a hundredth of a micrometre."""


def with_link(chain, name, **changes):
    links = tuple(replace(k, **changes) if k.name == name else k for k in chain.links)
    return replace(chain, links=links)


def displaced(touches, chain, q):
    """Where the ball of a chain at some readings is from where it should be, (N,), mm."""
    true = apply(inverse(touches.T_table_artefact), tip(chain, q, touches.length))
    return np.einsum("ni,ni->n", touches.normal, true - touches.ball_artefact)


@pytest.fixture(scope="module")
def learnt(case):
    """A function: true chain, readings that are true -> rows by symbol; none for as simulated."""
    run = case(*KEY).run
    t = run.touches

    def of(moved):
        fit = fit_run(replace(run, deviation=run.deviation - moved), ordinary_model(t.chain))
        return fit, {r.symbol: r for r in geometry_rows(fit)}

    as_simulated = of(0.0)

    def made(chain=None, scale=None):
        if chain is None and scale is None:
            return as_simulated
        return of(displaced(t, chain or t.chain, t.q if scale is None else t.q * scale))

    return made


def turned(direction, omega):
    out = direction + np.cross(omega, direction)
    return out / np.linalg.norm(out)


@pytest.mark.parametrize(
    ("axis", "symbol", "omega"),
    [("Y", "EC0Y", (0, 0, 40.0)), ("Z", "EB0Z", (0, 40.0, 0)), ("Z", "EA0Z", (40.0, 0, 0))],
)
def test_an_axis_out_of_square_is_found_with_its_sign(case, learnt, axis, symbol, omega) -> None:
    chain = case(*KEY).run.touches.chain
    turn = turned(chain.link(axis).direction, np.array(omega) * URAD)
    before = learnt()[1][symbol]
    after = learnt(with_link(chain, axis, direction=turn))[1][symbol]
    assert after.quantity is Quantity.SQUARENESS
    assert after.is_determined
    got = after.estimate.value - before.estimate.value
    assert got == pytest.approx(40.0 * URAD, rel=SHRUNK)
    assert after.at_ends.value == pytest.approx(abs(after.estimate.value) * after.lever)


def test_a_scale_is_found(case, learnt) -> None:
    """X goes 18 ppm farther than it says."""
    scale = np.ones(len(case(*KEY).run.touches.chain.axes))
    scale[case(*KEY).run.touches.chain.axis_index("X")] += 18e-6
    before, after = learnt()[1], learnt(scale=scale)[1]
    for symbol, wanted in (("EXX", 18e-6), ("EYY", 0.0), ("EZZ", 0.0)):
        got = after[symbol].estimate.value - before[symbol].estimate.value
        assert got == pytest.approx(wanted, abs=SHRUNK * 18e-6)
    assert after["EXX"].unit == "1"


def test_a_motion_of_a_rotary_axis_is_reported_from_peak_to_valley(case) -> None:
    """C turns 40 µrad sin C too far, and nothing else is wrong."""
    run = case(*KEY).run
    q, c = run.touches.q.copy(), run.touches.chain.axis_index("C")
    q[:, c] += 40.0 * URAD * np.sin(q[:, c])
    planted = replace(run, deviation=-displaced(run.touches, run.touches.chain, q))
    rows = {
        r.symbol: r for r in geometry_rows(fit_run(planted, ordinary_model(planted.touches.chain)))
    }
    assert rows["ECC"].quantity is Quantity.ROTARY_MOTION
    assert rows["ECC"].is_determined
    assert rows["ECC"].estimate.value == pytest.approx(80.0 * URAD, rel=0.01)


@pytest.mark.parametrize(("symbol", "i"), [("EX0C", 0), ("EY0C", 1), ("EX0B", 0), ("EZ0B", 2)])
def test_a_displaced_line_is_found_and_corrected(case, learnt, symbol, i) -> None:
    chain = case(*KEY).run.touches.chain
    axis = symbol[-1]
    shift = 60.0 * UM * np.eye(3)[i]
    true = with_link(chain, axis, point=chain.link(axis).point + shift)
    before = learnt()[1][symbol]
    fit, rows = learnt(true)
    assert rows[symbol].is_determined
    got = rows[symbol].estimate.value - before.estimate.value
    assert got == pytest.approx(60.0 * UM, rel=SHRUNK)
    geometry = learnt_geometry(fit)
    found = {c.key: c for c in geometry.corrections}
    value = rows[symbol].estimate
    if abs(value.value) > 3.0 * value.u:
        point = found[f"axis.{axis}.point"]
        assert point.found[i] == pytest.approx(chain.link(axis).point[i] + value.value)
        assert point.u[i] == value.u
        assert f"[axis.{axis}] point = [" in correction_line(point)


@pytest.mark.parametrize(("axis", "symbol", "i"), [("C", "EA0C", 0), ("B", "EC0B", 2)])
def test_a_tilted_line_is_found(case, learnt, axis, symbol, i) -> None:
    chain = case(*KEY).run.touches.chain
    turn = turned(chain.link(axis).direction, 50.0 * URAD * np.eye(3)[i])
    before = learnt()[1][symbol]
    after = learnt(with_link(chain, axis, direction=turn))[1][symbol]
    got = after.estimate.value - before.estimate.value
    # the turned axis also moves its line at the height of the standard: a share of the tilt
    assert got == pytest.approx(50.0 * URAD, rel=0.1)


def test_what_the_tool_on_its_axis_cannot_show_is_no_result(learnt) -> None:
    """Roll of Z about a tool that stands in it: never a number, always open."""
    rows = learnt()[1]
    assert not rows["ECZ"].is_determined
    assert not rows["ECZ"].has_changed
    assert not rows["ECZ"].is_beyond_expected


def test_the_same_machine_has_not_changed_and_a_crash_has(case, learnt) -> None:
    """The model of one run against another with one axis knocked out of square."""
    fit, _ = learnt()
    machine = len(fit.model.parameters)
    before = Prior.of_estimates(fit.theta[:machine], fit.covariance[:machine, :machine])
    same = learnt_geometry(fit, before)
    assert not [r.symbol for r in same.rows if r.has_changed]
    chain = case(*KEY).run.touches.chain
    turn = turned(chain.link("Y").direction, np.array([0.0, 0.0, 60.0]) * URAD)
    crashed = learnt_geometry(learnt(with_link(chain, "Y", direction=turn))[0], before)
    changed = {r.symbol: r for r in crashed.rows if r.has_changed}
    assert "EC0Y" in changed
    assert changed["EC0Y"].change.value == pytest.approx(60.0 * URAD, rel=SHRUNK)
    (line,) = [t for t in noted_lines(crashed) if "EC0Y" in t]
    assert "squareness of Y to X (EC0Y): " in line
    assert " → " in line


def test_the_ladder_begins_with_the_setup_alone(learnt) -> None:
    fit, _ = learnt()
    steps = learnt_geometry(fit).ladder
    assert [s.rung for s in steps] == [Rung.SETUP, Rung.GEOMETRY]
    assert steps[0].test_rms > 5.0 * steps[1].test_rms
    assert steps[1].test_rms == fit.test_rms


TARGETS = np.array([-15.0, -10.0, -5.0, 0.0, 5.0])


def column_run(shown, expected=None) -> Run:
    """Ten times up a short column, with deviations at five targets, mm."""
    axis = Axis((-15.0, 5.0), expected=expected)
    chain = make_chain("column", "[w f Z t]", {"Z": axis})
    z = np.tile(TARGETS, 10)
    n = len(z)
    touches = Touches(
        chain=chain,
        q=z[:, None],
        length=np.zeros(n),
        radius=np.zeros(n),
        point=np.column_stack([np.zeros((n, 2)), z]),
        normal=np.tile([0.0, 0.0, 1.0], (n, 1)),
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=np.zeros(n),
        approach=np.ones((n, 1)),
        pose=np.repeat(np.arange(10), 5),
        instrument=Instrument.LASER,
    )
    return Run(touches, -np.tile(shown, 10), np.full(n, 1.0 * UM))


def test_the_scale_of_five_targets_is_the_line_through_them() -> None:
    """Deviations without a trend, which a curve through five targets makes one of in between."""
    shown = np.array([1.3, 13.9, -20.0, -1.7, 8.3]) * UM
    run = column_run(shown)
    rows = {r.symbol: r for r in geometry_rows(fit_run(run, ordinary_model(run.touches.chain)))}
    slope = np.polyfit(TARGETS, shown, 1)[0]
    assert rows["EZZ"].estimate.value == pytest.approx(slope, abs=3.0 * rows["EZZ"].estimate.u)
    assert rows["EZZ"].estimate.u < 50e-6


@pytest.mark.parametrize("axis_expects", [None, 1.3 * UM])
def test_what_is_unusual_is_said_by_what_the_axis_expects_and_moves_no_fit(axis_expects) -> None:
    """1000 ppm over 20 mm: nothing beside the 77 µm of the class, much beside 1.3 µm."""
    run = column_run(1e-3 * (TARGETS + 5.0), axis_expects)
    rows = {r.symbol: r for r in geometry_rows(fit_run(run, ordinary_model(run.touches.chain)))}
    assert rows["EZZ"].estimate.value == pytest.approx(1e-3, abs=3.0 * rows["EZZ"].estimate.u)
    assert rows["EZZ"].is_determined
    assert rows["EZZ"].is_beyond_expected == (axis_expects is not None)


def test_only_a_linear_axis_expects_a_length() -> None:
    with pytest.raises(BadValue, match="only a linear axis"):
        make_chain("table", "[w C' f t]", {"C": Axis((-1.0, 1.0), expected=0.01)})
    with pytest.raises(BadValue, match="a length in mm above 0"):
        make_chain("column", "[w f Z t]", {"Z": Axis((-1.0, 1.0), expected=0.0)})


@pytest.mark.parametrize(
    ("value", "u", "usual", "is_determined", "is_far"),
    [
        (0.051, 0.002, 0.010, True, True),  # five usual sizes are 0.050
        (-0.051, 0.002, 0.010, True, True),
        (0.049, 0.002, 0.010, True, False),
        (0.051, 0.011, 0.010, True, False),  # five of its own uncertainties are 0.055
        (0.051, 0.002, 0.010, False, False),
        (0.051, 0.002, None, True, False),
    ],
)
def test_far_is_beyond_five_usual_sizes_and_uncertainties(
    value, u, usual, is_determined, is_far
) -> None:
    row = GeometryRow(
        quantity=Quantity.SCALE,
        symbol="EX0C",
        axes=("C",),
        unit="mm",
        estimate=Estimate(value, u),
        lever=2.0,
        expected=1.0,
        is_determined=is_determined,
        usual=usual,
    )
    assert row.is_far is is_far
    assert row.at_ends == Estimate(2.0 * abs(value), 2.0 * u)


SWUNG = [(0, 0), *((c, 30) for c in (0, 90, 180, 270)), (45, 60)]
UPRIGHT = [(c, 0) for c in (0, 90, 180, 270, 45, 135)]


def head_run(poses, moved: dict, noise: float = 0.8 * UM) -> Run:
    """Touches by a gantry mill with a C A head: readings of both, deg, and what is elsewhere."""
    swing = Axis((-np.pi / 2, np.pi / 2), point=(0.0, 0.0, 235.0))
    axes = dict.fromkeys("XYZ", Axis((-600.0, 600.0))) | {"C": Axis((-np.pi, np.pi)), "A": swing}
    chain = make_chain("gantry", "[w f X Y Z C A t]", axes)
    rng = np.random.default_rng(3)
    n, k = 480, len(poses)
    pose = np.arange(n) % k
    q = np.column_stack([rng.uniform(-400.0, 400.0, (n, 3)), np.deg2rad(poses)[pose]])
    touches = Touches(
        chain=chain,
        q=q,
        length=np.full(n, 210.0),
        radius=np.zeros(n),
        point=tip(chain, q, 210.0),
        normal=np.eye(3)[np.arange(n) // k % 3],
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=np.zeros(n),
        approach=np.zeros((n, 5)),
        pose=pose,
    )
    true = chain
    for axis, changes in moved.items():
        true = with_link(true, axis, **changes)
    seen = -displaced(touches, true, q) + rng.normal(0.0, noise, n)
    return Run(touches, seen, np.full(n, 0.8 * UM))


BESIDE = {"C": {"point": np.array([14.0, -9.0, 0.0]) * UM}}


def test_a_line_of_a_head_is_no_tilt_where_the_head_swings_the_tool_away() -> None:
    """The circle of one place of the tool is a displacement and a tilt at once, half of each."""
    run = head_run(SWUNG, BESIDE)
    rows = {r.symbol: r for r in geometry_rows(fit_run(run, ordinary_model(run.touches.chain)))}
    for symbol, true in {"EX0C": 14 * UM, "EY0C": -9 * UM, "EA0C": 0.0, "EB0C": 0.0}.items():
        found = rows[symbol].estimate
        assert rows[symbol].is_determined
        assert abs(found.value - true) < 3.5 * found.u
        assert found.u < 2.0 * UM
    # the tool 445 mm below A turns within 385 mm of C, whatever the size of the standard
    assert rows["EB0C"].lever < 1200.0


def test_a_head_that_never_swings_shows_its_line_at_the_tool_and_no_tilt() -> None:
    """By hand: a line turned by 60 µrad about Y is 12.6 µm off where the ball is, 210 mm below."""
    tilt = turned(np.array([0.0, 0.0, 1.0]), np.array([0.0, 60.0 * URAD, 0.0]))
    run = head_run(UPRIGHT, {"C": {"direction": tilt}}, noise=0.0)
    rows = {r.symbol: r for r in geometry_rows(fit_run(run, ordinary_model(run.touches.chain)))}
    assert rows["EX0C"].is_determined
    assert rows["EX0C"].estimate.value == pytest.approx(-12.6 * UM, rel=SHRUNK)
    assert not rows["EA0C"].is_determined
    assert not rows["EB0C"].is_determined


def test_linear_axes_copied_first_and_lines_after_them_leave_the_machine_as_it_is() -> None:
    """The tilt of a line is against the linear axes: as these are turned, so it changes."""
    turns = {"Y": np.array([-40.0, 0.0, 0.0]), "Z": np.array([-30.0, 20.0, 0.0])}
    true = {a: {"direction": np.eye(3)["XYZ".index(a)] + v * URAD} for a, v in turns.items()}
    first = run = head_run(SWUNG, {**true, **BESIDE})
    t = first.touches
    chain = t.chain
    for axes in ("XYZ", "CA"):
        found = learnt_geometry(fit_run(run, ordinary_model(chain))).corrections
        for one in found:
            _, axis, key = one.key.split(".")
            if axis in axes:
                chain = with_link(chain, axis, **{key: np.array(one.found)})
                u = np.array([np.inf if u is None else u for u in one.u])
                wanted = {**true, **BESIDE}.get(axis, {}).get(key, one.stated)
                assert np.all(np.abs(one.found - wanted) < 3.5 * u), one.key
        # the same readings of the same points, by the file as it is now
        seen = first.deviation + displaced(t, chain, t.q)
        run = Run(replace(t, chain=chain), seen, first.u)
    rows = geometry_rows(fit_run(run, ordinary_model(chain)))
    for row in rows:
        if row.is_determined and row.quantity in (Quantity.ROTARY_LINE, Quantity.SQUARENESS):
            assert abs(row.estimate.value) < 3.0 * row.estimate.u, row.symbol


@pytest.mark.parametrize(
    ("quantity", "symbol", "axes", "is_usual"),
    [
        (Quantity.SQUARENESS, "EC0Y", ("X", "Y"), True),
        (Quantity.SCALE, "EXX", ("X",), True),
        (Quantity.ROTARY_MOTION, "ECC", ("C",), True),
        (Quantity.ROTARY_MOTION, "EAC", ("C",), False),
        (Quantity.STRAIGHTNESS, "EYX", ("X",), False),
    ],
)
def test_positioning_is_the_usual_question_on_a_rotary_axis(quantity, symbol, axes, is_usual):
    assert _is_usual(SimpleNamespace(quantity=quantity, symbol=symbol, axes=axes)) == is_usual
