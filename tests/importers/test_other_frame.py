"""Lists in another frame, turned and shifted by anything, against rotations written out by hand."""

import math

import numpy as np
import pytest

from matstd.importers.points import linear_machine, points_run
from matstd.importers.points.other_frame import in_measured_frame, in_nominal_frame, measured_frames
from matstd.importers.points.point_list import PointList
from matstd.twin.errors import DesignError
from matstd.twin.record import computed_deviation
from matstd.twin.units import UM

TURN, AWAY = 2.3, np.array([512.0, -81.0, 33.0])
N = 24


def at_random(letters: int = 3) -> np.ndarray:
    nominal = np.random.default_rng(4).uniform(0.0, 200.0, (N, 3))
    nominal[:, letters:] = 0.0
    return nominal


def turned(places: np.ndarray) -> np.ndarray:
    c, s = math.cos(TURN), math.sin(TURN)
    x, y, z = places.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1) + AWAY


def points(nominal: np.ndarray, measured: np.ndarray, letters: int = 3) -> PointList:
    deviation = measured - nominal
    deviation[:, letters:] = np.nan
    return PointList(
        nominal=nominal,
        deviation=deviation,
        feature=np.array([f"H{k}" for k in range(N)]),
        setup=np.full(N, "a"),
        line=np.arange(N),
        approach=np.zeros((N, 3), dtype=np.int64),
    )


def distances(places: np.ndarray) -> np.ndarray:
    return np.array([math.dist(a, b) for a in places for b in places])


@pytest.mark.parametrize("letters", [2, 3])
def test_errors_of_a_part_are_those_in_the_frame_of_the_machine(letters) -> None:
    """Errors of 1 µm are left as they are, but for a rigid motion, which changes no distance."""
    nominal = at_random(letters)
    errors = np.random.default_rng(5).normal(0.0, 1.0 * UM, (N, 3))
    errors[:, letters:] = 0.0
    listed = points(nominal, turned(nominal + errors), letters)
    (frame,) = measured_frames(listed)
    assert frame.turn == pytest.approx(TURN, abs=2e-5)
    back = np.nan_to_num(in_nominal_frame(listed, [frame]).deviation)
    np.testing.assert_allclose(distances(nominal + back), distances(nominal + errors), atol=1e-9)
    assert np.abs(back - errors).max() < 2.0 * UM, "no more than the set-up of errors of 1 µm"


def test_a_plate_stands_where_it_was_measured_and_its_deviations_follow() -> None:
    nominal = at_random()
    measured = turned(nominal) * np.array([1.0 + 50e-6, 1.0, 1.0])  # X reads 50 ppm too long
    listed = points(nominal, measured)
    frames = measured_frames(listed)
    moved = in_measured_frame(listed, frames)
    run = points_run(moved, "standard", linear_machine(moved, frames), 1.0 * UM, frames)
    t = run.touches
    # the machine stood at the measured place: what its controller believed, minus the nominal
    along = np.einsum("ni,nij->nj", t.normal, np.linalg.inv(t.T_table_artefact[:, :3, :3]))
    np.testing.assert_allclose(np.abs(along).max(axis=1), 1.0, atol=1e-9)
    believed = run.deviation.reshape(N, 3) + t.point_table.reshape(N, 3, 3)[:, 0]
    np.testing.assert_allclose(believed, measured, atol=1e-9)
    assert np.abs(computed_deviation(t)).max() < 1e-9, "readings are those of the nominal places"


def test_what_lies_near_its_frame_is_left_to_the_set_up_and_a_mirror_is_refused() -> None:
    nominal = at_random()
    assert not measured_frames(points(nominal, nominal + 0.5))[0].is_far
    with pytest.raises(DesignError, match="mirrored frame"):
        measured_frames(points(nominal, nominal * [-1.0, 1.0, 1.0]))


def test_gross_points_do_not_turn_a_list() -> None:
    nominal = at_random(2)
    measured = turned(nominal)
    measured[:3] += 40.0
    (frame,) = measured_frames(points(nominal, measured, 2))
    assert frame.turn == pytest.approx(TURN, abs=1e-9)


def test_a_height_far_away_is_shifted_and_a_missing_coordinate_is_left_out() -> None:
    nominal = at_random(2)
    heights = points(nominal, nominal + np.array([0.0, 0.0, 120.0]))
    heights.deviation[:, :2] = np.nan
    (frame,) = measured_frames(heights)
    assert np.abs(in_nominal_frame(heights, [frame]).deviation[:, 2]).max() < 1e-9
    listed = points(nominal, turned(nominal), 2)
    listed.deviation[4, 0] = np.nan
    back = in_nominal_frame(listed, measured_frames(listed)).deviation[:, :2]
    assert np.isnan(back[4]).all()
    assert np.abs(np.delete(back, 4, axis=0)).max() < 1e-9
