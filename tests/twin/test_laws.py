"""Laws as effects: shapes by hand, carriers by hand, names that lead back."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import made_up

from matstd.twin.errors import UnknownEffect
from matstd.twin.laws import SHAPES, driver_of, drivers, grid, play, shapes_of, surface_columns
from matstd.twin.library import owner_of, parse_effect
from matstd.twin.model import columns
from matstd.twin.units import UM


def one(word, x, *places):
    (column,) = SHAPES[word].values(np.array(x, dtype=float), *places)
    return column


def test_shapes_are_what_their_formulas_say() -> None:
    assert one("bump", [10.0, 20.0], 10.0, 10.0) == pytest.approx([1.0, np.exp(-1.0)])
    assert one("bump-before", [9.0, 11.0], 10.0, 1.0) == pytest.approx([np.exp(-1.0), 0.0])
    assert one("window", [0.0, 1.0, 3.0], 0.5, 2.0) == pytest.approx([0.0, 1.0, 0.0])
    assert one("ramp", [0.0, 1.5, 9.0], 1.0, 2.0) == pytest.approx([0.0, 0.5, 1.0])
    assert one("plateau", [0.0, 1.5, 2.5, 3.1], 1.0, 2.0, 1.0) == pytest.approx([0, 1, 0.5, 0])
    assert one("kink", [1.0, 4.0], 2.0, 2.0) == pytest.approx([0.0, 1.0])
    assert one("dead-band", [-4.0, 0.5, 4.0], 0.0, 1.0, 1.0) == pytest.approx([-3.0, 0.0, 3.0])
    assert one("exp", [0.0, 60.0], 0.0, 60.0) == pytest.approx([1.0, np.exp(-1.0)])
    assert one("log", [0.0, 60.0], 0.0, 60.0) == pytest.approx([0.0, np.log(2.0)])
    assert one("square", [1.0, 3.0], 4.0, 0.0) == pytest.approx([1.0, -1.0])
    assert one("saw", [0.0, 1.0, 3.0], 4.0, 0.0) == pytest.approx([-1.0, -0.5, 0.5])
    assert one("half-wave", [np.pi / 2, -np.pi / 2], 0.0) == pytest.approx([1.0, 0.0])
    assert one("bump-after", [9.0, 11.0], 10.0, 1.0) == pytest.approx([0.0, np.exp(-1.0)])
    assert one("pulse", [1.0, 3.0], 1.0, 2.0) == pytest.approx([0.0, 1.0])
    assert one("step", [1.0, 2.0], 1.5) == pytest.approx([0.0, 1.0])
    assert one("power", [-4.0, 4.0], 0.0, 2.0, 2.0) == pytest.approx([4.0, 4.0])
    assert one("quad-about", [1.0, 7.0], 3.0, 2.0) == pytest.approx([1.0, 4.0])
    assert one("kink-before", [0.0, 3.0], 2.0, 2.0) == pytest.approx([1.0, 0.0])
    assert one("saturation", [1.0, 9.0], 1.0, 0.1) == pytest.approx([0.0, 1.0])
    assert one("settling", [-5.0, 60.0], 0.0, 60.0) == pytest.approx([0.0, 1.0 - np.exp(-1.0)])
    assert one("hysteresis", [0.0, 3.0, 2.0], 1.0, 1.0) == pytest.approx([0.0, 1.0, 0.0])
    quarter = [v[0] for v in SHAPES["sine"].values(np.array([1.0]), 4.0)]
    assert quarter == pytest.approx([1.0, 0.0], abs=1e-12)


def test_a_temperature_that_turns_once_has_no_trend_that_says_more_than_the_time() -> None:
    touches = made_up("hsm600u")
    at = np.linspace(0.0, 1.0, len(touches))
    once, twice = at * (1.0 - at), np.sin(3.0 * np.pi * at)
    names = [d.name for d in drivers(replace(touches, temperature={"a": once, "b": twice}))]
    assert [n for n in names if n.startswith("trend-")] == ["trend-T-b"]


def test_a_surface_is_alike_in_all_directions_and_dies_away_outside() -> None:
    """Correlation at one distance along an axis and along the diagonal; variance far outside."""
    places = (0.0, 100.0, 0.1, 2.0, -50.0, 50.0, 0.1, 1.0)

    def correlation(dx, dy):
        a, b = np.stack(surface_columns(50.0 + dx, dy, *places), axis=1)
        return a @ b / np.sqrt(a @ a * (b @ b))

    for d in (5.0, 10.0, 15.0):
        to = np.array([0.0, d])
        along = correlation(to, 0.0 * to)
        assert correlation(0.0 * to, to) == pytest.approx(along, abs=1e-9)
        assert correlation(to * 0.5**0.5, to * 0.5**0.5) == pytest.approx(along, abs=0.02)
        assert along < 1.0 - 0.002 * d
    for x, y in ((-900.0, 0.0), (50.0, 900.0), (900.0, -900.0)):
        far = np.array(surface_columns(np.array([x]), np.array([y]), *places))
        assert float((far**2).sum()) == pytest.approx(2.0**2)
        assert np.count_nonzero(far[-8:]) == 1


def test_a_play_follows_only_while_it_is_pushed() -> None:
    x = np.array([0.0, 1.0, 3.0, 2.0, 0.0, -3.0])
    assert play(x, 1.0) == pytest.approx([0.0, 0.0, 2.0, 2.0, 1.0, -2.0])


def test_every_shape_has_a_grid_with_its_parameters() -> None:
    touches = made_up("hsm600u")
    for driver in drivers(touches):
        x = driver.values(touches)
        for shape in shapes_of(driver, x):
            points = grid(shape, driver, x)
            assert points.ndim == 2, shape.word
            assert points.shape[1] == len(shape.places), shape.word
            if len(points):
                columns_ = np.stack(shape.values(x, *points[len(points) // 2]))
                assert np.all(np.isfinite(columns_)), shape.word


def test_a_bump_lifts_by_its_amplitude_along_the_normal() -> None:
    """EZY = a exp(-((Y - x0)/w)^2): a lifted tool sees the surface lower, ``-n_z a``."""
    touches = made_up("hsm600u")
    law = parse_effect("law(EZY,bump Y)", touches.chain).tuned(20.0, 50.0)
    y = touches.reading("Y")
    # EZZ moves the tip as EZY does: the column of a constant shape is that of the carrier
    per_mm = touches.signature.of(touches.chain.twist_of(touches.chain.symbol("EZY")))
    found = columns([law], touches)[:, 0] * 10.0 * UM
    assert found == pytest.approx(10.0 * UM * np.exp(-(((y - 20.0) / 50.0) ** 2)) * per_mm)


def test_a_linear_axis_is_counted_from_the_middle_in_half_travels(chain) -> None:
    low, high = chain.link("X").range
    x, c, sensor = (driver_of(name, chain) for name in ("X", "C", "T-spindle"))
    assert (x.nature, x.unit, x.zero, x.scale) == (
        "linear",
        "mm",
        (low + high) / 2,
        (high - low) / 2,
    )
    assert (c.nature, c.unit, c.zero, c.scale) == ("rotary", "rad", 0.0, 1.0)
    assert (sensor.nature, sensor.unit, sensor.zero) == ("level", "degC", 20.0)


def test_names_that_mean_nothing_are_refused() -> None:
    chain = made_up("hsm600u").chain
    for text, said in (
        ("law(EZY,hump Y)", "a shape of"),
        ("law(EZY,bump W)", "is no variable of a law"),
        ("law(EZY)", "2 to 3 arguments"),
        ("law(EZY,surface Y)", "a surface over two variables"),
        ("law(EZY,surface Y,bump X)", "a surface over two variables"),
    ):
        with pytest.raises(UnknownEffect, match=said):
            parse_effect(text, chain)


def test_what_only_the_clock_of_a_run_shows_belongs_to_that_run(chain) -> None:
    texts = {
        "machine": ("law(EXX,log time)", "law(EXX,exp time,sine time)", "law(EXX,curve X)",
                    "law(shift,exp since-setup)", "law(EXX,square V-coolant)",
                    "law(EXX,course time)"),
        "run": ("law(EXX,curve time)", "law(EXX,lin X,step time)", "law(EXX,square time)", "drift",
                "law(EXX,step time,two-exp time)"),
    }  # fmt: skip
    for owner, names in texts.items():
        assert {name: owner_of(parse_effect(name, chain)) for name in names} == dict.fromkeys(
            names, owner
        )


def test_a_relaxation_travels_if_the_run_saw_its_end() -> None:
    """By hand: with x = T/(2 w), the first half makes 1/(1 + exp(-x)) of the motion."""
    touches = made_up("hsm600u")
    law = parse_effect("law(EXX,exp time)", touches.chain)
    end = float(np.ptp(touches.since_start))
    limit = end / (2.0 * np.log(3.0))  # three quarters
    assert law.tuned(0.0, 0.98 * limit).rests(touches)
    assert not law.tuned(0.0, 1.02 * limit).rests(touches)
    assert parse_effect("law(EXX,exp X)", touches.chain).tuned(0.0, 1e6).rests(touches)


def test_a_driver_of_one_run_is_as_large_as_uncertain_in_another() -> None:
    """By hand: of 5 sin + 12 cos the size is 13, at every time of another run."""
    touches = made_up("hsm600u")
    law = parse_effect("law(EXX,sine time)", touches.chain).tuned(1000.0)
    elsewhere = law.elsewhere(np.array([5.0e-3, 12.0e-3]), np.nan)
    moved = np.stack(elsewhere.amounts(touches), axis=1)
    size = np.sqrt((moved**2).sum(axis=1).mean())
    assert [p.sd for p in elsewhere.parameters] == [1.0] * moved.shape[1]
    assert size == pytest.approx(13.0e-3, rel=0.1)


def test_what_a_run_fixes_by_its_edges_and_what_it_fixes_smoothly() -> None:
    """Half a bump jumps at its top alone; a wave that jumps does so at edges that all move."""
    named = {w: [SHAPES[w].places[i] for i in SHAPES[w].smooth] for w in SHAPES}
    edges = {w: [SHAPES[w].places[i] for i in SHAPES[w].edges] for w in SHAPES}
    assert (edges["bump-after"], named["bump-after"]) == (["x0"], ["w"])
    assert (edges["bump-before"], named["bump-before"]) == (["x0"], ["w"])
    assert (edges["window"], named["window"]) == (["x1", "x2"], [])
    assert (edges["saw"], named["saw"]) == ([], [])
    assert (edges["bump"], named["bump"]) == ([], ["x0", "w"])
