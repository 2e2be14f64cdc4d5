"""Effects that no model has: their size, their direction, and what shows them."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.hidden import (
    SIZE,
    HiddenEffect,
    hidden_effects,
    hidden_power,
    measured_together,
    possible_places,
    touched,
)
from matstd.artefact.hidden.smooth_effects import BUMP_WIDTHS, _At, form_columns
from matstd.artefact.worth import Calibration
from matstd.artefact.worth.touch_choice import touches_at
from matstd.twin.units import DEG, UM

POSES = np.array([[-60.0], [0.0], [75.0]]) * DEG


@pytest.fixture(scope="module")
def touches(criterion, upright):
    tried = touches_at((*upright.spheres, *upright.patches), POSES, 5)
    return tried[criterion.reach.is_reachable(tried)]


def test_kinds_are_fields_and_bumps_along_every_axis(criterion):
    kinds = hidden_effects(criterion.reach)
    assert len(kinds) == len(set(kinds)) == 2 * 3 + 2 * 3
    assert sum(kind.is_bump for kind in kinds) == 6


def test_an_effect_displaces_as_an_error_of_the_axis(criterion, touches):
    """A positioning error of X, in the model's own columns, is a displacement along X."""
    at = _At.of(criterion.reach, touched(touches, UM))
    columns = criterion.model.columns(criterion.reach.touches(touches))
    for axis in "XYZ":
        p = criterion.model.names.index(
            next(n for n in criterion.model.names if f"E{axis}{axis}" in n)
        )
        own = at.along(HiddenEffect(True, 40.0, axis))[:, 0]
        size = columns[:, p] / own
        x = at.q[:, at.axes.index(axis)]
        big = np.abs(own) > 0.1
        line = np.polyfit(x[big], size[big], 1)  # linear in its reading, the same at every touch
        np.testing.assert_allclose(size[big], np.polyval(line, x[big]), atol=1e-9)


def test_bumps_are_two_micrometres_rms_over_the_volume(criterion, touches):
    at = _At.of(criterion.reach, touched(touches, UM))
    x = np.linspace(-200.0, 200.0, len(at.q))
    line = replace(at, q=np.column_stack([x, x, x]), lever=np.ones((len(x), 3)))
    places = np.linspace(-100.0, 100.0, 201)[:, None] * np.ones(3)
    for width in BUMP_WIDTHS:
        f = line.bumps(HiddenEffect(True, width, "X"), places)[:, 100]
        assert np.sqrt(np.trapezoid(f**2, x) / 200.0) == pytest.approx(SIZE, rel=1e-3)
        assert np.ptp(x[f > 0.5 * f.max()]) == pytest.approx(width, abs=2.0 * (x[1] - x[0]))


def test_the_field_has_its_size_and_width(criterion, touches):
    at = _At.of(criterion.reach, touched(touches, UM))
    F = at.field(40.0)
    distance = np.linalg.norm(at.q[:, None] - at.q, axis=-1)
    expected = SIZE**2 * 0.5 ** (2.0 * distance**2 / 40.0**2)
    assert np.abs(F @ F.T - expected).max() < 0.15 * SIZE**2
    assert np.trace(F @ F.T) > 0.99 * len(at.q) * SIZE**2


def test_more_touches_and_less_noise_show_more(criterion, upright, touches):
    here = criterion.on(upright)
    places = possible_places(criterion.reach, criterion.volume, POSES, np.random.default_rng(1))
    lots = [touched(touches[::4], UM), touched(touches, UM), touched(touches, 0.5 * UM)]
    found = [hidden_power(here, lot, places) for lot in lots]
    for less, more in itertools.pairwise(found):
        assert (more.signal > less.signal).all()
        assert more.power.mean() > less.power.mean()
    assert found[0].power.min() >= 0.049  # never below its risk


def test_a_calibrated_form_hides_some(criterion, upright, touches):
    places = possible_places(criterion.reach, criterion.volume, POSES, np.random.default_rng(1))
    faces = touches[np.isin(touches.feature, [p.name for p in upright.patches])]
    signals = []
    for form in (0.0, 0.3 * UM, 3.0 * UM):
        here = replace(criterion, calibration=Calibration(form=form)).on(upright)
        signals.append(hidden_power(here, touched(faces, UM), places).signal)
    assert (signals[0] > signals[1]).all()
    assert (signals[1] > signals[2]).all()


def test_form_belongs_to_the_face_and_not_to_the_pose(upright, touches):
    u = 0.5 * UM
    columns = form_columns(upright, touches, u)
    K = columns @ columns.T
    place = np.unique(touches.point, axis=0, return_inverse=True)[1].reshape(-1)
    on_face = np.isin(touches.feature, [p.name for p in upright.patches])
    twice = np.flatnonzero(on_face & (place == place[np.flatnonzero(on_face)[0]]))
    assert K[np.ix_(twice, twice)] == pytest.approx(u**2, rel=0.1)
    assert not columns[~on_face].any()


def test_several_lots_keep_their_noise(touches):
    both = measured_together([touched(touches[:3], UM), touched(touches[3:7], 2.0 * UM)])
    assert both.u.tolist() == [UM] * 3 + [2.0 * UM] * 4
    assert len(both) == 7
