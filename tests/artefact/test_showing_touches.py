"""Touches that show unmodelled effects best: against the signals of whole sets."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from matstd.artefact.hidden import (
    Scan,
    hidden_effects,
    hidden_power,
    measured_together,
    possible_places,
    scanned,
    showing_poses,
    showing_touches,
    touched,
)
from matstd.artefact.hidden.touches_that_show import _Choice
from matstd.artefact.layout import Blank, Wave, wavy_face
from matstd.artefact.place.wavy_proof import showing_on_body, showing_table_poses, square_of
from matstd.artefact.reach import ProbeReach, ProbeShape
from matstd.artefact.worth import (
    Calibration,
    CriterionOptions,
    criterion_for,
    each_at,
    face_grid,
)
from matstd.artefact.worth.touch_choice import touches_at
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.twin.errors import NotReachable
from matstd.twin.files import read_machine
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM

POSE = np.array([[0.0]])
MACHINE = Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml"


@pytest.fixture(scope="module")
def scene(criterion, upright):
    """Criterion without form errors on a body with a wavy face, its balls touched."""
    exact = replace(criterion, calibration=Calibration(form=0.0))
    face = wavy_face("FF1", Blank(), Wave((0.0, 0.0), (60.0, 60.0), 60.0, 45.0 * DEG))
    body = replace(upright, patches=(face,))
    tried = each_at(face, face_grid(face.half_size, 12), POSE)
    tried = tried[criterion.reach.is_reachable(tried)]
    balls = touches_at(upright.spheres, POSE, 4)
    given = touched(balls[criterion.reach.is_reachable(balls)], UM)
    at = possible_places(criterion.reach, criterion.volume, POSE, np.random.default_rng(1))
    return exact.on(body), body, tried, given, at


def test_gains_are_those_of_the_whole_measurement(scene):
    """What a touch adds to every signal, against the test of all touches solved anew."""
    here, _, tried, given, at = scene
    choice = _Choice.begun(here, given, touched(tried, UM), at)
    for row in (3, 40, 41):
        choice.take(row)
    some = measured_together([given, touched(tried[[3, 40, 41]], UM)])
    whole = hidden_power(here, some, at, with_power=False).signal
    bump = np.array([effect.is_bump for effect in hidden_effects(here.reach)])
    np.testing.assert_allclose(np.sqrt(choice.square)[bump], whole[bump], rtol=1e-9)
    # fields are factors of a covariance to a hundredth of it, each for its own points
    np.testing.assert_allclose(np.sqrt(choice.square), whole, rtol=0.05)
    before = choice.left_after()[77]
    choice.take(77)
    assert np.sum(1.0 / choice.square) == pytest.approx(before, rel=1e-4)


def test_chosen_touches_show_more_than_even_ones(scene):
    here, body, tried, given, at = scene
    chosen = showing_on_body(here, body, tried, given, at, 30)
    even = tried[np.linspace(0, len(tried) - 1, 30).astype(int)]
    least = [
        hidden_power(here, measured_together([given, touched(one, UM)]), at, False).least_signal
        for one in (chosen, even)
    ]
    assert least[0] > 1.05 * least[1]
    slope = np.arccos(chosen.normal[:, 2])
    assert slope.mean() > 1.05 * np.arccos(tried.normal[:, 2]).mean()
    assert len(np.unique(chosen.point, axis=0)) == 30
    area = np.bincount(square_of(body.patches[0], chosen.point), minlength=9)
    assert area.max() <= 4  # nine squares of 40 mm, 30 touches


def test_chosen_lots_are_those_whose_whole_measurement_shows_most(scene):
    """Sums of products against the test of all touches solved anew, lot after lot."""
    here, _, tried, given, at = scene
    order = np.argsort(tried.normal[:, 2])  # the steepest first
    lots = [touched(tried[rows], UM) for rows in (order[60:90], order[-12:], order[:30])]

    def unseen(numbers):
        some = measured_together([given, *(lots[k] for k in numbers)])
        return np.sum(1.0 / hidden_power(here, some, at, with_power=False).signal ** 2)

    first, second = showing_poses(here, given, lots, at, 2)
    assert unseen([first]) == min(unseen([k]) for k in range(3))
    assert unseen([first, second]) == min(unseen([first, k]) for k in range(3) if k != first)
    assert showing_poses(here, given, lots[:2], at, 3) == [0, 1]


def test_a_face_is_scanned_where_the_table_does_not_hide_it(scene):
    """Poses with room at half as many places as the best one has, each once."""
    _, body, _, given, _ = scene
    chain = read_machine(MACHINE)
    reach = ProbeReach(chain, Setup("a"), ProbeShape(3.0, ((80.0, 2.0), (160.0, 25.0))), 160.0)
    volume, population = Workspace(chain, {}, 160.0), Population(chain)
    rng, wanted = np.random.default_rng(4), (CriterionOptions(), 480, population)
    here = criterion_for(reach, population.model, Blank(), volume, UM, rng, *wanted).on(body)
    poses = np.column_stack([np.zeros(5), np.array([-90.0, -75.0, -20.0, 0.0, 10.0]) * DEG])
    given = touched(replace(given.touches, rotary=np.tile(poses[3], (len(given), 1))), UM)
    at = possible_places(reach, here.volume, poses, np.random.default_rng(1))
    chosen = showing_table_poses(here, body, given, poses, at, 3)
    seen = [len(scanned(body.patches[0], Scan(), p[None], reach, body)) for p in poses]
    assert min(seen) < 0.4 * max(seen)
    rows = [int(np.flatnonzero((poses == p).all(axis=1))[0]) for p in chosen]
    assert len(set(rows)) == 3
    assert min(np.take(seen, rows)) > 0.4 * max(seen)
    alone = showing_table_poses(here, body, given, poses[:1], at, 3)
    np.testing.assert_array_equal(alone, poses[:1])


def test_areas_with_too_few_places_leave_their_share_to_others(scene):
    here, _, tried, given, at = scene
    some = tried[:20]
    area = np.array([0] * 2 + [1] * 18)
    rows = showing_touches(here, given, touched(some, UM), at, 12, np.arange(20), area)
    assert len(set(rows.tolist())) == 12
    assert np.sum(area[rows] == 1) >= 10


def test_too_few_places_are_refused(scene):
    here, body, tried, given, at = scene
    with pytest.raises(NotReachable, match="20 places of the wavy face can be touched, 21 wanted"):
        showing_on_body(here, body, tried[:20], given, at, 21)
