"""The budget of a measuring task: by hand, and by what it covers of new places on new machines."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from matstd.diagnosis.files.uncertainty_file import uncertainty_table
from matstd.diagnosis.task import Visits, guarded, task_uncertainty


def test_one_place_is_students_interval_of_the_next_visit() -> None:
    """Mean 2, standard deviation of 3, 1, 2 about it 1: U = t(2) sqrt(1 + 1/3) by the textbook."""
    y = np.array([[3.0], [1.0], [2.0]])
    one = Visits(y, np.array(["FF1"]), np.zeros(1), np.zeros(1), np.zeros((1, 1)))
    found = task_uncertainty(one)
    assert (found.bias, found.u_p, found.u_cal) == pytest.approx((2.0, 1.0, 0.0))
    assert pytest.approx(4.3027 * np.sqrt(4.0 / 3.0), rel=0.01) == found.U
    assert found.dof == pytest.approx(2.0, rel=0.02)
    assert found.u_b == pytest.approx(np.sqrt(1.0 / 3.0), rel=0.05)
    assert found.U_uncorrected == pytest.approx(found.U + 2.0)


def test_much_is_known_where_much_was_measured() -> None:
    """The sum of the standard with k = 1.96, calibration common to all places, workpieces."""
    rng = np.random.default_rng(8)
    face = np.repeat(np.arange(40), 10)
    y = rng.normal(size=(30, 400))
    found = task_uncertainty(
        Visits(y, face.astype(str), face, np.zeros(400), np.full((400, 1), 0.7)), u_w=0.4
    )
    assert found.u_cal == pytest.approx(0.7)
    assert pytest.approx(1.96 * np.sqrt(0.49 + 1.0 + 0.16), rel=0.02) == found.U
    assert found.u_b < 0.2
    assert found.u**2 == pytest.approx(found.u_cal**2 + found.u_p**2 + found.u_b**2 + 0.16)


def test_few_features_that_differ_count_as_few() -> None:
    """Places that differ by feature alone: Student's with as many degrees of freedom, less one."""
    face = np.repeat(np.arange(4), 12)
    means = np.array([3.0, -1.0, 4.0, -6.0])
    rng = np.random.default_rng(2)
    y = means[face] + 1e-3 * rng.normal(size=(6, 48))
    found = task_uncertainty(
        Visits(y, face.astype(str), np.tile(np.arange(12), 4), np.zeros(48), np.zeros((48, 1)))
    )
    u = np.std(means, ddof=1) * np.sqrt(1.0 + 1.0 / 4.0)
    assert pytest.approx(3.1824 * u, rel=0.01) == found.U
    assert found.dof == pytest.approx(3.0, rel=0.05)


def test_u_never_falls_below_what_is_known() -> None:
    """Visits alike to the last digit, and nothing that calibration does not explain."""
    y = np.zeros((3, 12))
    face = np.repeat(["FF1", "FF2"], 6)
    found = task_uncertainty(Visits(y, face, np.zeros(12), np.zeros(12), np.full((12, 1), 0.5)))
    assert found.u == pytest.approx(0.5, rel=1e-3)
    assert pytest.approx(1.96 * 0.5, rel=1e-3) == found.U
    still = task_uncertainty(Visits(y, face, np.zeros(12), np.zeros(12), np.zeros((12, 0))))
    assert pytest.approx(0.0, abs=1e-9) == still.U


def test_calibration_is_counted_once() -> None:
    """Places that differ by nothing but their calibration leave no error to the machine."""
    rng = np.random.default_rng(3)
    face = np.repeat(np.arange(200), 2)
    K = (face[:, None] == np.arange(200)).astype(float)
    y = np.tile(K @ rng.normal(size=200), (2, 1)) + 1e-3 * rng.normal(size=(2, 400))
    found = task_uncertainty(Visits(y, face.astype(str), face, np.zeros(400), K))
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
    """Machines with errors by face, table pose and place; results at new ones of each.

    The whole range: `python benchmarks/uncertainty_of_components.py`.
    """
    rng = np.random.default_rng(5)
    face, pose = np.repeat(np.arange(6), 20), np.tile(np.repeat(np.arange(10), 2), 6)
    K = calibration * (face[:, None] == np.arange(6))
    sd = np.sqrt(by_face**2 + by_pose**2 + by_place**2 + 0.3**2 + 1.0)
    covered = []
    for _ in range(16):
        machine = by_face * rng.normal(size=6)[face] + by_pose * rng.normal(size=10)[pose]
        machine = machine + by_place * rng.normal(size=120) - K @ rng.normal(size=6)
        y = machine + 0.3 * rng.normal(size=(5, 1)) + rng.normal(size=(5, 120))
        found = task_uncertainty(Visits(y, face.astype(str), pose, np.arange(120) % 8, K))
        ends = found.bias + found.U * np.array([-1.0, 1.0])
        covered.append(np.diff(norm.cdf(ends / sd)))
    assert 0.93 <= np.mean(covered) <= 0.98


def test_guard_bands() -> None:
    """One-sided 95 % of a normal distribution is 1.645 standard deviations."""
    zone = guarded(20.0, 1.0, 1e6)
    assert zone.guard == pytest.approx(1.6449, abs=1e-3)
    assert (zone.accepted, zone.rejected) == pytest.approx((8.355, 11.645), abs=1e-3)
    assert guarded(2.0, 1.0, 1e6).accepted < 0.0
    assert guarded(2.0, 1.0, 1e6).share == 0.0
    assert guarded(20.0, 1.0, 1e6, bias=-2.0).guard == pytest.approx(3.6449, abs=1e-3)


def test_a_budget_is_written_in_the_units_of_its_keys():
    """Every number another one, and as it is rounded by hand."""
    lengths = ("bias", "u_cal", "u_p", "u_b", "u_w", "spread", "expected", "u", "U")
    known = {name: (1.23456 + k) * 1e-3 for k, name in enumerate(lengths)}
    faces = (("FF1", -0.45678e-3, 0.56789e-3),)
    one = SimpleNamespace(
        **known, U_uncorrected=20.12341e-3, visits=3, places=4, faces=5, poses=6,
        dof=7.89, k=2.36789, by_face=faces,
    )  # fmt: skip
    table = uncertainty_table("bore", {"none": one}, 0.06123456)
    assert (table["task"], table["level"], table["tolerance_um"]) == ("bore", 0.95, 61.2346)
    (found,) = table["budgets"]
    g = 1.8633 * 8.23456  # Student's t of 7.89 degrees of freedom at 95 %, times u
    assert found.pop("conforms_within_um") == pytest.approx(30.61728 - g, rel=1e-3)
    assert found.pop("does_not_conform_beyond_um") == pytest.approx(30.61728 + g, rel=1e-3)
    assert found == {
        "model": "none", "visits": 3, "places": 4, "faces": 5, "poses": 6,
        "b_um": 1.2346, "u_cal_um": 2.2346, "u_p_um": 3.2346, "u_b_um": 4.2346, "u_w_um": 5.2346,
        "spread_um": 6.2346, "spread_by_calibration_um": 7.2346, "u_um": 8.2346,
        "degrees_of_freedom": 7.9, "k": 2.368, "U_um": 9.2346, "U_uncorrected_um": 20.1234,
        "by_face": [{"feature": "FF1", "mean_um": -0.4568, "spread_um": 0.5679}],
    }  # fmt: skip
    (wide,) = uncertainty_table("bore", {"none": one}, 0.02)["budgets"]
    assert wide["conforms_within_um"] is None
    assert "conforms_within_um" not in uncertainty_table("bore", {"none": one})["budgets"][0]
