"""Circular tests: layouts, signs, and servo lag, against a circle that shares no code."""

import numpy as np
import pytest

from matstd.cli import main
from matstd.diagnosis.answer import diagnose
from matstd.importers import circle_machine, circle_run, read_circle, read_sheet
from matstd.importers.instruments import circle_parameters
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_machine, read_run
from matstd.twin.library import parse_effect
from matstd.twin.model import columns
from matstd.twin.units import DEG, UM, URAD

RADIUS, FEED = 100.0, 2000.0
BAD = 2


def radial(degrees, sense, lag=0.0, reversal=0.0, square=0.0):
    """Radial error of a circle: X lags by `lag` s, Y stands off by half its reversal, a shear."""
    th = degrees * DEG
    v = FEED / 60.0
    x_error = lag * v * np.sin(th) * sense - square * RADIUS * np.sin(th)
    y_error = 0.5 * reversal * np.sign(np.cos((degrees - 0.01 * sense) * DEG)) * sense
    return np.cos(th) * x_error + np.sin(th) * y_error


@pytest.fixture
def table(tmp_path):
    """A function: errors -> sheet as a German report has it, CCW and CW beside one another."""

    def made(step=3.0, seed=2, noise=0.2, **errors):
        degrees = np.arange(0.0, 360.0, step)
        rng = np.random.default_rng(seed)
        both = [
            radial(degrees, s, **errors) / UM + rng.normal(0.0, noise, len(degrees))
            for s in (1, -1)
        ]
        rows = [f"{a:.1f};{p:.2f};{m:.2f}" for a, p, m in zip(degrees, *both, strict=True)]
        head = "Kreisformtest;Ebene XY\n\nWinkel [°];gegen Uhrzeigersinn [µm];im Uhrzeigersinn [µm]"
        text = "\n".join([head, *rows]).replace(".", ",") + "\n"
        (tmp_path / "kreis.csv").write_text(text, encoding="cp1252")
        return read_sheet(tmp_path / "kreis.csv")

    return made


def test_lag_reversal_and_squareness_are_distinguished(table):
    errors = {"lag": 2e-4, "reversal": 5.0 * UM, "square": 40.0 * URAD}
    test = read_circle(table(**errors), "XY", RADIUS)
    assert list(dict.fromkeys(test.run)) == ["gegen Uhrzeigersinn", "im Uhrzeigersinn"]
    assert np.all(np.diff(test.angle[test.sense < 0]) < 0.0), "clockwise is taken backwards"
    run = circle_run(test, circle_machine("XY", RADIUS), 0.2 * UM, feed=FEED)
    result = diagnose(run)
    found = {e.kind: s.reported[0] for s in result.steps if (e := s.effect) is not None}
    assert set(found) == {"servo-lag", "backlash"}
    lag = found["servo-lag"]
    sign = 1.0 if any(e.name == "servo-lag(X)" for e in result.found) else -1.0
    assert (lag.unit, sign * lag.value) == ("ms", pytest.approx(0.2, abs=3 * lag.u))
    assert found["backlash"].value == pytest.approx(5.0, abs=3 * found["backlash"].u)
    square = next(r for r in result.geometry.rows if r.symbol == "EC0Y").estimate
    assert square.value == pytest.approx(40.0 * URAD, abs=3 * square.u)
    assert result.fit.test_rms < 0.3 * UM


def test_the_lag_is_the_formula_of_the_ball_bar(table):
    """``-(F T/2) sin 2 theta`` along the radius, of the other sign the other way round."""
    test = read_circle(table(lag=0.0), "XY", RADIUS)
    run = circle_run(test, circle_machine("XY", RADIUS), 0.2 * UM, feed=FEED)
    found = columns([parse_effect("servo-lag(X)", run.touches.chain)], run.touches)[:, 0]
    v = FEED / 60.0
    seen = 0.5 * v * np.sin(2.0 * test.angle) * test.sense  # tool farther out, per second
    inner = np.ones(len(found), dtype=bool)
    inner[[0, len(found) // 2 - 1, len(found) // 2, -1]] = False  # one-sided differences
    np.testing.assert_allclose(found[inner], -seen[inner], atol=2e-3 * v)


def test_a_long_table_by_the_command(tmp_path):
    rows = ["run,angle [deg],radius [mm]"]
    for sense, name in ((1, "CCW"), (-1, "CW")):
        for a in np.arange(0.0, 360.1, 10.0)[::sense]:
            rows.append(f"{name},{a:g},{RADIUS + 1e-3 * sense:.4f}")
    (tmp_path / "bar.csv").write_text("\n".join(rows))
    out = tmp_path / "run.csv"
    words = ["--circle", "zx", "--radius", "100", "--u-um", "0.5", "-o", str(out)]
    assert main(["import", str(tmp_path / "bar.csv"), *words]) == 0
    run = read_run(out, read_machine(tmp_path / "run.machine.toml"))
    wanted = np.where(run.touches.feature == "CCW", -1.0, 1.0)
    np.testing.assert_allclose(run.deviation / UM, wanted, atol=1e-6)
    z, x = run.touches.reading("Z"), run.touches.reading("X")
    np.testing.assert_allclose(run.touches.normal[:, 2] * RADIUS, z, atol=1e-6)
    np.testing.assert_allclose(run.touches.normal[:, 0] * RADIUS, x, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("angle,a [µm],b [µm]\n0,1,2\n9,1,2\n", "radial deviations"),
        ("angle,dr1 [µm],dr2 [µm]\n0,1,2\n9,1,2\n", "CCW or CW"),
        ("angle,CCW,CW\n0,1,2\n9,1,2\n", "unknown unit"),
        ("place,CCW [µm]\n0,1\n9,1\n", "column of angles"),
    ],
)
def test_what_is_not_said_is_asked_for(tmp_path, text, found):
    (tmp_path / "bar.csv").write_text(text, encoding="utf-8")
    with pytest.raises(BadFile, match=found):
        read_circle(read_sheet(tmp_path / "bar.csv"), "XY", RADIUS)


def test_places_of_a_grid_plate_are_a_circle(tmp_path):
    th = np.arange(0.0, 360.0, 15.0) * DEG
    rows = [f"{RADIUS * np.cos(a) + 0.002:.6f};{RADIUS * np.sin(a):.6f}" for a in th[::-1]]
    (tmp_path / "grid.csv").write_text("X [mm];Y [mm]\n" + "\n".join(rows))
    test = read_circle(read_sheet(tmp_path / "grid.csv"), "XY", RADIUS)
    assert set(test.sense) == {-1}
    np.testing.assert_allclose(test.deviation, 0.002 * np.cos(test.angle), atol=1e-6)


def test_a_circle_beside_the_travel_is_refused(table):
    test = read_circle(table(), "XY", RADIUS)
    with pytest.raises(DesignError, match="--centre"):
        circle_run(test, circle_machine("XY", RADIUS), 0.2 * UM, (50.0, 0.0, 0.0))


def test_a_loaded_bar_pushes_the_tool_outwards(tmp_path):
    """40 nm/N of X under 300 N: the circle is 12 um wider along X, whatever X reads."""
    path = tmp_path / "bar.csv"
    angles = np.arange(0.0, 360.0, 5.0)
    wider = 12.0 * np.cos(np.radians(angles)) ** 2
    rows = [f"{a:g},{w:.4f}" for a, w in zip(angles, wider, strict=True)]
    path.write_text("angle_deg,deviation_um\n" + "\n".join(rows) + "\n")
    out = tmp_path / "run.csv"
    asked = ["import", str(path), "--circle", "XY", "--radius", "150", "--u-um", "0.5"]
    asked += ["--bar-force", "300"]
    assert main([*asked, "-o", str(out)]) == 0
    run = read_run(out)
    stiff = parse_effect("tool-point-stiffness", run.touches.chain)
    C = columns([stiff], run.touches)
    found = np.linalg.lstsq(C[:, :1], run.deviation)[0]
    assert found[0] == pytest.approx(40e-6, rel=1e-3)


def test_squareness_scale_and_reversal_of_iso_230_4_alone(tmp_path):
    """A bar of 150 mm: 90 degrees less 30 µrad, X 20 ppm too long, 5 µm reversal of X; by hand."""
    rng = np.random.default_rng(5)
    degrees = np.arange(0.0, 360.0, 2.0)
    at = np.radians(degrees)
    rows = ["angle [deg];CCW [um];CW [um]"]
    for angle, a in zip(degrees, at, strict=True):
        # Y leans to +X: the tool is 30e-6 y farther along X, which is 30e-6 sin cos of the radius
        own = 150e3 * (30e-6 * np.sin(a) * np.cos(a) + 20e-6 * np.cos(a) ** 2)
        each = [
            own + 2.5 * np.sign(-np.sin(a) * s) * np.cos(a) + rng.normal(0, 0.3) for s in (1, -1)
        ]
        rows.append(";".join(f"{v:.3f}" for v in (angle, *each)))
    path = tmp_path / "ball.csv"
    path.write_text("\n".join(rows) + "\n")
    found = circle_parameters(read_circle(read_sheet(path), "XY", 150.0))
    expected = [-30e-6, 20e-6, 0.0, 5e-3, 0.0]
    assert [one.name for one in found][::3] == ["squareness of X and Y", "reversal of X"]
    for one, value in zip(found, expected, strict=True):
        assert one.value == pytest.approx(value, abs=4.0 * one.u)
    # 360 readings of 0.3 µm: the mean square of sin cos is an eighth
    assert found[0].u == pytest.approx(0.3e-3 / 150.0 / np.sqrt(360 / 8), rel=0.15)


@pytest.mark.parametrize("radius", ["-150", "nan", "1e9"])
def test_a_radius_is_refused_with_the_range_that_is_expected(tmp_path, capsys, radius):
    path = tmp_path / "ball.csv"
    path.write_text("angle [deg];CCW [um]\n" + "".join(f"{a};0\n" for a in range(0, 360, 5)))
    asked = ["import", str(path), "--circle", "XY", "--u-um", "0.5", "--radius", radius]
    assert main([*asked, "-o", str(tmp_path / "run.csv")]) == 2
    line = capsys.readouterr().err
    assert f"--radius {float(radius):g}: expected a number above 0, below 1000000" in line
    assert not (tmp_path / "run.csv").exists()
