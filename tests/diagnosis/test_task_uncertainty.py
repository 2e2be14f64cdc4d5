"""The budget of a measuring task: by hand, and by what it covers of new places on new machines."""

import numpy as np
import pytest

from diagnosis.task.decision import guarded
from diagnosis.task.uncertainty import task_uncertainty
from diagnosis.task.visits import Visits


def test_one_place_is_the_sum_of_the_standard() -> None:
    """Mean 2, standard deviation of 3, 1, 2 about it 1; U = t(2) sqrt(0.3^2 + 1 + 0.4^2)."""
    y = np.array([[3.0], [1.0], [2.0]])
    one = Visits(y, np.array(["FF1"]), np.array([0]), np.array([[0.3]]))
    found = task_uncertainty(one, u_w=0.4)
    assert (found.bias, found.u_p, found.u_cal, found.u_b) == pytest.approx((2.0, 1.0, 0.3, 0.0))
    u = np.sqrt(0.09 + 1.0 + 0.16)
    assert found.u == pytest.approx(u)
    # the variance of the visits has 2 degrees of freedom, the rest none to spend
    dof = u**4 / ((1.0 - 1.0 / 3.0) ** 2 / 2.0)
    assert found.dof == pytest.approx(dof)
    assert pytest.approx(found.k * u) == found.U
    assert found.U_uncorrected == pytest.approx(found.U + 2.0)


def test_calibration_is_counted_once() -> None:
    """Places that differ by nothing but their calibration leave no error to the machine."""
    rng = np.random.default_rng(3)
    face = np.repeat(np.arange(200), 2)
    K = (face[:, None] == np.arange(200)).astype(float)
    y = np.tile(K @ rng.normal(size=200), (2, 1)) + 1e-3 * rng.normal(size=(2, 400))
    found = task_uncertainty(Visits(y, face.astype(str), face, K))
    assert found.expected == pytest.approx(1.0, rel=0.01)
    assert found.spread == pytest.approx(1.0, rel=0.2)
    assert found.u_b < 0.6
    assert found.u_cal == pytest.approx(1.0 / np.sqrt(200))


@pytest.mark.parametrize(
    ("by_face", "by_pose", "by_place", "calibration"),
    [(0.5, 0.5, 0.5, 1.0), (10.0, 10.0, 10.0, 1.0), (0.0, 0.0, 0.0, 0.0), (0.0, 8.0, 3.0, 0.3)],
)
def test_what_is_stated_is_covered(
    by_face: float, by_pose: float, by_place: float, calibration: float
) -> None:
    """Machines with errors by face, table pose and place; results at new ones of each."""
    rng = np.random.default_rng(5)
    face, pose = np.repeat(np.arange(6), 20), np.tile(np.repeat(np.arange(10), 2), 6)
    K = calibration * (face[:, None] == np.arange(6))
    covered = []
    for _ in range(200):
        machine = by_face * rng.normal(size=6)[face] + by_pose * rng.normal(size=10)[pose]
        machine = machine + by_place * rng.normal(size=120) - K @ rng.normal(size=6)
        y = machine + 0.3 * rng.normal(size=(5, 1)) + rng.normal(size=(5, 120))
        found = task_uncertainty(Visits(y, face.astype(str), pose, K))
        sd = np.sqrt(by_face**2 + by_pose**2 + by_place**2 + 0.3**2 + 1.0)
        covered.append(np.mean(np.abs(sd * rng.normal(size=500) - found.bias) <= found.U))
    assert 0.93 <= np.mean(covered) <= 0.98


def test_guard_bands() -> None:
    """One-sided 95 % of a normal distribution is 1.645 standard deviations."""
    zone = guarded(20.0, 1.0, 1e6)
    assert zone.guard == pytest.approx(1.6449, abs=1e-3)
    assert (zone.accepted, zone.rejected) == pytest.approx((8.355, 11.645), abs=1e-3)
    assert guarded(2.0, 1.0, 1e6).accepted < 0.0
    assert guarded(2.0, 1.0, 1e6).share == 0.0
    assert guarded(20.0, 1.0, 1e6, bias=-2.0).guard == pytest.approx(3.6449, abs=1e-3)
