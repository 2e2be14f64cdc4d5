"""Touches that are offered for the next measurement can be made."""

import numpy as np
import pytest

from matstd.diagnosis.next_visit import candidate_touches
from matstd.diagnosis.next_visit.offers import APPROACH_CONE
from matstd.twin.machine import tip
from matstd.twin.units import NM


def spindle_in_artefact(touches):
    """Direction from the ball to the spindle as the standard sees it, from two stylus lengths."""
    near, far = (tip(touches.chain, touches.q, touches.length + more) for more in (0.0, 1.0))
    turns = np.array([s.T_table_artefact[:3, :3] for s in touches.setups])[touches.setup]
    return np.einsum("nij,ni->nj", turns, near - far)


@pytest.mark.parametrize("key", [(2, "hsm600u"), (7, "fork", ("probe-lobing",))])
def test_offers_reach_known_points_from_known_sides(case, key) -> None:
    run = case(*key).run
    t = run.touches
    offers = candidate_touches(run, np.random.default_rng(0))
    assert len(offers) > 100
    # the ball stands on the point
    ball = tip(t.chain, offers.q, offers.length)
    target = offers.point_table + offers.radius[:, None] * offers.normal_table
    assert np.abs(ball - target).max() < NM
    limits = np.array([t.chain.link(axis).range for axis in t.chain.axes])
    assert np.all((offers.q >= limits[:, 0]) & (offers.q <= limits[:, 1]))
    before, now = spindle_in_artefact(t), spindle_in_artefact(offers)
    for feature in np.unique(offers.feature):
        own = now[offers.feature == feature]
        nearest = (own @ before[t.feature == feature].T).max(axis=1)
        assert nearest.min() > np.cos(APPROACH_CONE) - 1e-6
    # and they are more than the run itself: other points of a feature in a pose
    made = {tuple(row) for row in np.round(np.column_stack([t.q, t.point]), 6)}
    new = [tuple(row) not in made for row in np.round(np.column_stack([offers.q, offers.point]), 6)]
    assert np.mean(new) > 0.5
