"""Error left against the number of touches: the comparison's own figures, and nothing rises."""

import numpy as np
import pytest

from matstd.artefact.worth import TouchCurve, random_touches, touch_curve
from matstd.information.criteria import Posterior
from matstd.report.plots import draw_touch_curves
from matstd.twin.errors import DesignError
from matstd.twin.units import UM

ALGEBRA = 1e-6  # relative: trace of a form against the sum over poses


@pytest.fixture(scope="module")
def touches(criterion):
    rng = np.random.default_rng(9)
    return random_touches(criterion.reach, criterion.volume, criterion.rotary, 120, rng)


def left(criterion, W):
    """Root mean square of what stays unknown at the poses, from the covariance itself."""
    after = Posterior(W, criterion.prior_sd, criterion.model.names)
    return [
        np.sqrt(np.mean(after.predicted_sd(tip) ** 2))
        for tip in (criterion.tip_volume, criterion.tip_user)
    ]


def test_all_touches_leave_what_the_comparison_says(criterion, touches):
    curve = touch_curve(criterion, "scatter", touches, (60, 240))
    assert curve.counts == (60, 120, 240)
    at_design = [curve.rms[1], curve.rms_user[1]]
    expected = left(criterion, criterion.whitened(touches))
    np.testing.assert_allclose(at_design, expected, rtol=ALGEBRA)


def test_twice_the_touches_are_half_the_variance_of_the_noise(criterion, touches):
    curve = touch_curve(criterion, "scatter", touches, (240,))
    expected = left(criterion, np.sqrt(2.0) * criterion.whitened(touches))
    np.testing.assert_allclose([curve.rms[-1], curve.rms_user[-1]], expected, rtol=ALGEBRA)


def test_more_touches_never_leave_more(criterion, touches):
    curve = touch_curve(criterion, "scatter", touches)
    assert curve.counts == (50, 70, 100, 120, 140, 200, 300, 400, 550, 750, 1000)
    assert np.all(np.diff(curve.rms**2 + curve.rms_user**2) < 0.0)
    # many touches: noise alone is left of what can be seen, so it goes with the square root at best
    assert curve.rms[-1] > 0.99 * curve.rms[-2] * np.sqrt(750 / 1000)


def test_the_first_touches_are_the_good_ones(criterion, touches):
    curve = touch_curve(criterion, "scatter", touches, (60,))
    rng = np.random.default_rng(1)
    by_chance = [
        np.hypot(*left(criterion, criterion.whitened(touches[rng.permutation(120)[:60]])))
        for _ in range(5)
    ]
    assert np.hypot(curve.rms[0], curve.rms_user[0]) < min(by_chance)


def test_no_touches_are_refused(criterion, touches):
    with pytest.raises(DesignError, match="0 touches"):
        touch_curve(criterion, "nothing", touches[:0])
    with pytest.raises(DesignError, match="expected some"):
        touch_curve(criterion, "scatter", touches, (0, 10))


def test_the_picture_holds_the_curves_and_marks_the_design():
    counts = (50, 480, 1000)
    standard = TouchCurve("standard", 480, counts, np.array([7, 0.8, 0.5]) * UM, np.ones(3) * UM)
    ideal = TouchCurve("ideal scatter", 480, counts, np.array([6, 0.6, 0.4]) * UM, np.ones(3) * UM)
    drawn = draw_touch_curves([standard, ideal], 1.0 * UM)
    user, volume = drawn.axes
    line = volume.lines[0]
    np.testing.assert_allclose(line.get_ydata(), [7.0, 0.8, 0.5])
    assert tuple(line.get_xdata()) == counts
    assert line.get_markevery() == [1]
    assert [ln.get_linestyle() for ln in volume.lines] == ["-", "--"]
    assert volume.get_xscale() == volume.get_yscale() == "log"
    assert volume.get_xlabel() == "touches of 1 µm noise"
    assert user.get_ylabel() == "unpredicted tool point error in µm rms"
    titles = [a.get_title(loc="left") for a in drawn.axes]
    assert titles == ["your workspace", "probed volume"]
    assert [t.get_text() for t in drawn.legends[0].get_texts()] == ["standard", "ideal scatter"]
