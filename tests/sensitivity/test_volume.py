"""Volumes and points over the rotary axes: where things stand in a map, and what is drawn."""

import numpy as np
import pytest
from machines import LATHE, LENGTH

from matstd.report.maps.study_maps import draw_rotary
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.sensitivity.study import has_volume, level, points_over_rotary, run_study, volume
from matstd.twin.errors import NotReachable
from matstd.twin.frames import apply
from matstd.twin.machine import Axis, make_chain, tip
from matstd.twin.units import DEG, UM

NM = 1e-6  # mm


@pytest.fixture(scope="module")
def tilted(workspace):
    return volume(workspace, {"B": -90.0 * DEG, "C": 30.0 * DEG}, (5, 4, 3))


def test_readings_of_a_map_bring_the_tool_point_where_the_map_says(tilted, chain):
    p = np.random.default_rng(3).uniform(-100.0, 100.0, (20, 3))
    q = np.tile(tilted.q[:1], (20, 1))
    q[:, [chain.axis_index(a) for a in "XYZ"]] = apply(tilted.T_readings_table, p)
    np.testing.assert_allclose(tip(chain, q, LENGTH), p, atol=NM)


def test_rotary_axes_stand_where_the_machine_file_puts_them(workspace, tilted):
    # B line at machine (0, *, -420): the tip, 160 below the gauge point, is there at Z = -260.
    # C line through the foundation's z axis, which crosses the B line.
    upright = volume(workspace, {"B": 0.0, "C": 0.0}).lines()
    np.testing.assert_allclose(upright["B"][0][[0, 2]], [0.0, -260.0], atol=NM)
    np.testing.assert_allclose(np.abs(upright["B"][1]), [0.0, 1.0, 0.0], atol=NM)
    np.testing.assert_allclose(upright["C"][0][:2], [0.0, 0.0], atol=NM)
    np.testing.assert_allclose(np.abs(upright["C"][1]), [0.0, 0.0, 1.0], atol=NM)
    # a quarter turn of B lays the C line level, along X and through the B line
    lying = tilted.lines()
    np.testing.assert_allclose(np.abs(lying["C"][1]), [1.0, 0.0, 0.0], atol=NM)
    np.testing.assert_allclose(lying["C"][0][1:], [0.0, -260.0], atol=NM)
    np.testing.assert_allclose(lying["B"][0][[0, 2]], [0.0, -260.0], atol=NM)


def test_a_volume_holds_its_values_in_the_order_of_the_readings(tilted, chain):
    assert tilted.axes == ("X", "Y", "Z")
    assert tilted.shape == (5, 4, 3)
    assert tilted.rotary == pytest.approx({"B": -90.0 * DEG, "C": 30.0 * DEG})
    # S of the rotation about the B line is the distance from it, whatever Y is
    x, z = tilted.readings[0], tilted.readings[2]
    expected = np.hypot(x[:, None, None], z[None, None, :] + 260.0) * np.ones((1, 4, 1))
    np.testing.assert_allclose(tilted.sensitivity(chain.symbol("EBB")), expected, atol=NM)


def test_the_error_without_sampling_is_that_of_drawn_machines(workspace, chain, tilted):
    from matstd.sensitivity.montecarlo.random_machines import volumetric

    population = Population(chain)
    sampled = volumetric(population, tilted.q, LENGTH, 2000, np.random.default_rng(1)).p95
    found = tilted.volumetric(population).ravel()
    # bounded errors have shorter tails than normal ones: up to 8 %, sampling 2 %
    np.testing.assert_allclose(found, sampled, rtol=0.1)


def test_points_outside_the_volume_of_the_workspace_have_no_value(chain, workspace):
    box = ((-80.0, -80.0, 0.0), (80.0, 80.0, 100.0))
    area = Workspace(chain, workspace.limits, LENGTH, box)
    found = volume(area, {"B": 0.0, "C": 0.0}, (7, 7, 6))
    S = found.sensitivity(chain.symbol("EXX"))
    x, y, z = np.meshgrid(*found.readings, indexing="ij")
    # upright, the table frame is X, Y and Z + 340
    inside = (np.abs(x) <= 80.0) & (np.abs(y) <= 80.0) & (np.abs(z + 290.0) <= 50.0)
    np.testing.assert_array_equal(np.isfinite(S), inside)


def test_a_machine_without_three_linear_axes_has_no_volume():
    area = Workspace(LATHE, {}, 50.0)
    assert not has_volume(area)
    assert points_over_rotary(area) == ()
    with pytest.raises(NotReachable, match="room along X, Z, expected three linear axes"):
        volume(area, {})


def test_a_point_of_the_workpiece_stays_where_it_is_while_the_table_turns(workspace, chain):
    points = points_over_rotary(workspace)
    assert [p.linear for p in points] == [
        {"X": 0.0, "Y": 0.0, "Z": -275.0},
        {"X": 0.0, "Y": 0.0, "Z": -150.0},
        {"X": 150.0, "Y": 0.0, "Z": -275.0},
        {"X": 150.0, "Y": 150.0, "Z": -400.0},
    ]
    for point in points:
        p = tip(chain, point.q, LENGTH)
        np.testing.assert_allclose(p, np.tile(p[:1], (len(p), 1)), atol=NM)
    assert all(p.reached.all() for p in points[:3])
    # the low corner dips below the travel of Z when it turns to the deep side of the cradle
    beyond = points[3].q[~points[3].reached]
    assert len(beyond) > 20
    assert np.all(beyond[:, chain.axis_index("Z")] < -500.0)


def test_level_is_the_reading_next_to_zero(chain):
    limits = {"B": (-90.0 * DEG, -20.0 * DEG)}
    assert level(Workspace(chain, limits, LENGTH)) == pytest.approx({"B": -20.0 * DEG, "C": 0.0})


def test_maps_over_the_rotary_axes_are_labelled_and_hold_the_values(chain, workspace):
    study = run_study(Population(chain), workspace, 150, 100, np.random.default_rng(5))
    drawn = draw_rotary(study)
    titles = [a.get_title() for a in drawn.axes if a.get_title()]
    assert titles[0] == "point at X 0, Y 0, Z -275"
    assert titles[4] == "S of EX0C in µm/µm"
    maps = [a for a in drawn.axes if a.get_title()]
    assert {a.get_xlabel() for a in maps} == {"B in °"}
    assert {a.get_ylabel() for a in maps} == {"C in °"}
    # a displaced C line moves the point by 2 sin(C / 2) times the displacement
    shown = maps[4].collections[0].get_array()
    C = np.linspace(-180.0, 180.0, 61) * DEG
    expected = np.tile(2.0 * np.abs(np.sin(C / 2.0))[:, None], (1, 61))
    np.testing.assert_allclose(shown[~shown.mask], expected[~shown.mask], atol=NM / UM)
    assert any(a.get_ylabel() == "95 % quantile in µm" for a in drawn.axes)


def test_without_a_rotary_axis_the_picture_says_so():
    mill = make_chain(
        "mill", "[w X' f Y Z t]", {name: Axis(range=(-100.0, 100.0)) for name in "XYZ"}
    )
    area = Workspace(mill, {}, 50.0)
    study = run_study(Population(mill), area, 40, 50, np.random.default_rng(1))
    (text,) = draw_rotary(study).texts
    assert "No rotary axis" in text.get_text()
