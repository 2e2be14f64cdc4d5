"""Touches that prove lie all over the faces, evenly, and no table pose is crowded."""

from itertools import combinations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from matstd.artefact.place import proving_touches
from matstd.artefact.place.proving import (
    covering,
    even_shares,
    informative_touches,
    touches_on_faces,
)
from matstd.artefact.reach import Requests
from matstd.twin.errors import NotReachable
from matstd.twin.units import DEG

POSES = np.array([[-120.0], [-30.0], [0.0], [75.0], [150.0]]) * DEG
HONEYCOMB = 5.0 / (18.0 * np.sqrt(3.0))  # mean squared distance to the middle of a unit cell


def left(area, places):
    """Mean squared distance from a point of the area to the nearest place."""
    return np.mean(cKDTree(places).query(area)[0] ** 2)


def test_a_cover_is_nearly_the_best_of_all():
    rng = np.random.default_rng(7)
    for _ in range(5):
        area, places = rng.uniform(0.0, 10.0, (200, 2)), rng.uniform(0.0, 10.0, (11, 2))
        best = min(left(area, places[list(some)]) for some in combinations(range(11), 4))
        chosen = covering(area, places, 4)
        assert len(set(chosen.tolist())) == 4
        assert left(area, places[chosen]) <= 1.15 * best


def test_a_cover_is_nearly_as_even_as_a_honeycomb():
    rng = np.random.default_rng(8)
    area, places = rng.uniform(0.0, 40.0, (1500, 2)), rng.uniform(0.0, 40.0, (250, 2))
    cell = 40.0 * 40.0 / 27
    assert left(area, places[covering(area, places, 27)]) < 1.15 * HONEYCOMB * cell
    corners = np.lexsort((np.abs(places - 20.0).max(axis=1),))[-27:]  # as at edges alone
    assert left(area, places[corners]) > 3.0 * HONEYCOMB * cell


def test_shares_go_by_weight_as_far_as_there_is_room():
    assert even_shares(np.ones(6), np.full(6, 99), 160).tolist() == [27, 27, 27, 27, 26, 26]
    assert even_shares(np.array([1.0, 2.0, 5.0]), np.full(3, 99), 80).tolist() == [10, 20, 50]
    assert even_shares(np.array([1.0, 2.0, 5.0]), np.array([99, 99, 20]), 80).tolist() == [
        20,
        40,
        20,
    ]
    assert even_shares(np.array([1.0, 0.0]), np.array([9, 0]), 9).tolist() == [9, 0]


@pytest.fixture(scope="module")
def chosen(criterion, upright):
    tried = touches_on_faces(criterion.reach, upright, POSES, 40)
    rng = np.random.default_rng(3)
    some = tried[rng.choice(len(tried), 60, replace=False)]
    return tried, some, proving_touches(criterion.on(upright), upright, tried, some, 40)


def test_touches_cover_every_face(criterion, upright, chosen):
    tried, some, proof = chosen
    assert len(proof) == len(np.unique(proof.point, axis=0)) == 40  # nowhere twice
    areas = [4.0 * np.prod(face.half_size) for face in upright.patches]
    for face, area in zip(upright.patches, areas, strict=True):
        mine = proof[proof.feature == face.name]
        assert len(mine) == pytest.approx(40 * area / sum(areas), abs=1.0)
        spread = left(face.point(face.grid(0.5)), mine.point)
        assert spread < 1.35 * HONEYCOMB * area / len(mine)  # edges are kept clear, slopes longer
        most = informative_touches(criterion.on(upright), tried, some, 40)
        stated = most[most.feature == face.name]
        assert spread < 0.7 * left(face.point(face.grid(0.5)), stated.point)
    assert np.bincount(proof.pose).max() <= np.ceil(1.25 * 40 / 5)


def test_few_places_are_touched_more_than_once(criterion, upright, chosen):
    tried = chosen[0]
    few = tried[np.isin(tried.point[:, 0], np.unique(tried.point[:, 0])[:3])]
    places = len(np.unique(few.point, axis=0))
    count = places + 4
    proof = proving_touches(criterion.on(upright), upright, few, tried[:20], count)
    each = np.unique(proof.point, axis=0, return_counts=True)[1]
    assert len(each) == places
    assert each.max() == 2
    keys = np.column_stack([proof.point, proof.rotary])
    assert len(np.unique(keys, axis=0)) == count


def test_too_few_touches_are_refused(criterion, upright, chosen):
    tried: Requests = chosen[0][:10]
    with pytest.raises(NotReachable, match="10 touches can be made for the proof, 11 are wanted"):
        proving_touches(criterion.on(upright), upright, tried, tried, 11)
    with pytest.raises(NotReachable, match="10 touches can be made for the proof, 11 are wanted"):
        informative_touches(criterion.on(upright), tried, tried, 11)
