"""A jump at a row of a run without times: found where it was planted, against plain means."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.remarks.order import jump_in_order
from matstd.importers.points import linear_machine, points_run
from matstd.importers.points.point_list import PointList
from matstd.twin.library import ordinary_model
from matstd.twin.units import UM

N, AT = 40, 23
SIZE = 9.0 * UM


def fitted(jump: float, time: float = 0.0):
    """Points of a plate in no order of places; from the 24th on it lies elsewhere in Y."""
    rng = np.random.default_rng(8)
    deviation = rng.normal(0.0, 1.0 * UM, (N, 3))
    deviation[AT:, 1] += jump
    deviation[:, 2] = np.nan
    nominal = np.c_[rng.uniform(0.0, 200.0, (N, 2)), np.zeros(N)]
    points = PointList(
        nominal=nominal,
        deviation=deviation,
        feature=np.array([f"P{k}" for k in range(N)]),
        setup=np.full(N, "a"),
        line=np.arange(N) + 2,
        approach=np.zeros((N, 3), dtype=np.int64),
    )
    run = points_run(points, "standard", linear_machine(points), 1.0 * UM)
    touches = replace(run.touches, time=time * np.arange(len(run)))
    run = replace(run, touches=touches)
    return fit_run(run, ordinary_model(run.touches.chain)), deviation


def test_a_jump_is_found_at_its_row_with_its_size() -> None:
    fit, deviation = fitted(SIZE)
    found = jump_in_order(fit)
    assert found is not None
    assert (found.before, found.after) == (AT + 1, AT + 2)
    means = deviation[AT:, :2].mean(axis=0) - deviation[:AT, :2].mean(axis=0)
    assert found.size == pytest.approx(np.linalg.norm(means), abs=2.0 * found.u)
    assert found.size == pytest.approx(SIZE, abs=3.0 * found.u)
    # what the mean of AT points and of the others is known to, and a little for what is fitted
    plain = 1.0 * UM * np.sqrt(1.0 / AT + 1.0 / (N - AT))
    assert plain < found.u < 2.5 * plain


def test_no_jump_is_reported_of_noise_or_where_times_are_known() -> None:
    assert jump_in_order(fitted(0.0)[0]) is None
    assert jump_in_order(fitted(SIZE, time=1.0)[0]) is None
