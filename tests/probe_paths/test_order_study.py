"""What an order costs and gains: against brute force, the whole covariance, the plan's programs."""

from dataclasses import replace

import numpy as np
import pytest
from unchanged import facts

from matstd.artefact.reach import Requests
from matstd.artefact.tool import Probe
from matstd.probe_paths.plan import PlanOptions
from matstd.probe_paths.stations import orders, probing_time
from matstd.probe_paths.stations.order_study import _sd_beside, _shortest
from matstd.twin.library import ordinary_model
from matstd.twin.record import Setup
from matstd.twin.rows import picked
from matstd.twin.units import MINUTE, UM

END_OF_A_FILE = 10.0
"""Turning home and back, s."""


@pytest.fixture(scope="module")
def found(plan):
    return orders(plan, ordinary_model(plan.chain), 1.0 * UM)


def test_the_orders_are_what_they_were(found, unchanged):
    unchanged(facts(found))


def test_quicker_orders_know_less_of_drift(found, plan):
    durations = [order.duration for order in found]
    assert durations == sorted(durations, reverse=True)
    assert found[0].touches == len(plan)
    assert {order.touches for order in found[1:]} == {int(np.sum(plan.request >= 0))}
    # the planned order has more touches, more time between them, and every pose twice
    assert found[0].drift == min(order.drift for order in found)
    assert found[-1].drift > 1.1 * found[0].drift
    assert all(0.0 < value < np.inf for order in found for value in order.reversal)


def test_the_planned_order_takes_as_long_as_its_programs(found, programs, plan):
    # the ends of the files are all that differs: one here, several there
    ends = END_OF_A_FILE * len(programs.programs)
    assert found[0].duration == pytest.approx(programs.duration, abs=ends)


def test_touches_are_the_same_in_every_order(plan):
    bare = np.flatnonzero(plan.request >= 0)
    short = _shortest(picked(plan, bare))
    assert sorted(short.request) == sorted(plan.request[bare])
    poses = [visit.pose for visit in short.visits]
    assert len(poses) == len(set(poses)) == len({visit.pose for visit in plan.visits})
    for name in ("point", "contact"):
        of = dict(zip(plan.request[bare], getattr(plan, name)[bare], strict=True))
        for row, request in enumerate(short.request):
            assert np.array_equal(getattr(short, name)[row], of[request])


def test_standard_deviations_against_the_whole_covariance():
    rng = np.random.default_rng(0)
    C, W = rng.normal(size=(40, 3)), rng.normal(size=(40, 7))
    both = np.concatenate([C, W], axis=1)
    covariance = np.linalg.inv(np.eye(10) + both.T @ both)
    np.testing.assert_allclose(_sd_beside(C, W), np.sqrt(np.diag(covariance)[:3]), rtol=1e-10)


def test_time_of_another_body(plan, programs, small):
    rows = np.flatnonzero(plan.request >= 0)
    rotary = [plan.chain.axis_index(name) for name in plan.chain.rotary_axes]
    wanted = Requests(
        plan.feature[rows], plan.point[rows], plan.normal[rows], plan.contact[rows][:, rotary]
    )
    seconds = probing_time(small, plan.chain, plan.probe, plan.setup, wanted, plan.options)
    assert seconds == pytest.approx(programs.duration, rel=0.02)
    # a touch that cannot be made counts like the others
    upside_down = replace(
        wanted, normal=wanted.normal * np.where(np.arange(len(rows)) < 1, -1, 1)[:, None]
    )
    again = probing_time(small, plan.chain, plan.probe, plan.setup, upside_down, plan.options)
    assert again == pytest.approx(seconds, abs=2.0 * MINUTE)
    none = replace(wanted, normal=-wanted.normal)
    assert np.isnan(probing_time(small, plan.chain, Probe(), Setup("a"), none, PlanOptions()))
