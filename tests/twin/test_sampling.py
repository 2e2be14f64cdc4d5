"""Points of grids, by hand."""

import numpy as np

from matstd.twin.sampling import grid_points


def test_the_last_axis_of_a_grid_runs_fastest() -> None:
    points = grid_points(np.array([1.0, 2.0]), np.array([5.0, 6.0, 7.0]))
    assert points.tolist() == [[1, 5], [1, 6], [1, 7], [2, 5], [2, 6], [2, 7]]
