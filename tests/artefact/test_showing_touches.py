"""Touches that show unmodelled effects best: against the signals of whole sets."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.hidden import (
    hidden_effects,
    hidden_power,
    measured_together,
    possible_places,
    showing_touches,
    touched,
)
from matstd.artefact.hidden.touches_that_show import _Choice
from matstd.artefact.layout import Blank, Wave, wavy_face
from matstd.artefact.place.wavy_proof import showing_on_body, square_of
from matstd.artefact.worth import Calibration, each_at, face_grid
from matstd.artefact.worth.touch_choice import touches_at
from matstd.twin.errors import NotReachable
from matstd.twin.units import DEG, UM

POSE = np.array([[0.0]])


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
