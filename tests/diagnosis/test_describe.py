"""Sizes as they are reported: unbiased, and in their intervals as often as these say."""

import numpy as np
import pytest
from made_up import made_up

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.fit.describe import _bound, curve_sizes, size
from matstd.twin.library import parse_effect
from matstd.twin.model import Inner, Model, Parameter
from matstd.twin.record import Run
from matstd.twin.units import UM

DRAWS = 1000
BINOMIAL = 4.0
"""Standard deviations of a share by which it may be off."""


class Vector:
    """Stands for an effect with parameters of one unit, and an angle that is none of its size."""

    def __init__(self, count):
        lengths = [Parameter(f"a{i}", "mm", 0.01) for i in range(count)]
        self.parameters = (*lengths, Parameter("turn", "rad", 1e-5))


KNOWN = {
    "sine and cosine": ([3.0, 4.0], [0.3, 0.3]),
    "displacement": ([6.0, -5.0, 4.0], [0.3, 0.3, 1.0]),
    "one of four seen": ([4.5, 0.0, 0.0, 0.0], [0.2, 1.0, 1.0, 1.0]),
    "twice its noise": ([2.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.3, 1.0, 1.0, 1.0, 1.0, 1.0]),
}


@pytest.mark.parametrize("name", KNOWN)
def test_noise_across_does_not_lengthen(name) -> None:
    """The length of noisy estimates, over and over: right on average, intervals hold."""
    true, sd = (np.array(v) * 1e-3 for v in KNOWN[name])
    effect = Vector(len(true))
    covariance = np.diag(np.append(sd**2, 1e-12))
    rng = np.random.default_rng(4)
    z = []
    for _ in range(DRAWS):
        theta = np.append(true + sd * rng.standard_normal(len(sd)), 3e-6)
        stated = size(effect, theta, covariance)
        z.append((stated.value * stated.factor - np.linalg.norm(true)) / (stated.u * stated.factor))
    assert abs(np.mean(z)) < 0.15  # the plain length is off by 0.04, -0.03, 0.75 and 1.26
    held = np.mean(np.abs(z) < 1.96)
    assert held > 0.93 - BINOMIAL * np.sqrt(0.95 * 0.05 / DRAWS)


@pytest.mark.parametrize(
    ("value", "end"),
    [(10.0, -1), (10.009, -1), (10.011, 0), (109.89, 0), (109.91, 1), (110.0, 1)],
)
def test_a_value_within_a_thousandth_of_an_end_of_its_scan_lies_at_it(value, end) -> None:
    """Of 10 at the low end, and of the 100 between the ends at the high one."""
    grid = np.geomspace(10.0, 110.0, 5)
    assert _bound(Inner("tau", "s", grid), value) == end
    assert _bound(Inner("tau", "s", grid[::-1]), value) == end
    for jumps in (Inner("k", "1", grid, False), Inner("t", "s", grid, acts="at an instant")):
        assert _bound(jumps, value) == 0


def test_a_curve_is_measured_in_its_own_unit_however_a_surface_shows_it() -> None:
    """Straightness on faces that lean by every angle: the height of the curve that was planted."""
    t = made_up("hsm600u", 60)
    curve = parse_effect("geometric(EYX,2-4)", t.chain)
    beside = parse_effect("geometric(EZZ,linear)", t.chain)
    model = Model(t.chain, (curve, beside))
    theta = np.array([12.0, -7.0, 5.0, 3.0]) * UM
    fit = fit_run(Run(t, model.deviation(t, theta), np.full(len(t), 1e-3 * UM)), model)
    (whole, *_) = curve_sizes(fit, curve)
    assert whole.quantity == "peak_to_valley"
    assert whole.unit == "um"
    height = np.ptp(theta[:3] @ np.array([term.amount for term in curve.terms(t)]))
    # a hundredth of it is what the scale of Z beside it could be as well
    assert whole.value == pytest.approx(height / UM, rel=0.02)
