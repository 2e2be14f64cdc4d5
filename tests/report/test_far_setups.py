"""A standard that was clamped otherwise than the file states is said before anything else."""

import numpy as np
import pytest
from simulator_case import read_back, simulate_case

from matstd.diagnosis.answer import compare, diagnose
from matstd.report.words import comparison_sentence, verdict_sentence
from matstd.twin.frames import rotation, rotation_vector

STATED = ("origin_mm = [-69.639683, 99.324447, 9.755860]", "rotation_deg = [0.0, 0.0, 52.943151]")
"""Of set-up b of three, where it stands."""


@pytest.fixture(scope="module")
def text():
    run, machine, _ = simulate_case(np.random.default_rng(3), "hsm600u", (), poses=10)
    assert all(line in run for line in STATED)
    return run, machine


@pytest.mark.parametrize(
    ("origin", "rotation_deg", "said"),
    [
        (None, "[0.0, 0.0, -37.056849]", "stands a quarter turn about Z of the table (+90.0"),
        (None, "[0.0, 0.0, 142.943151]", "stands a quarter turn about Z of the table (-90.0"),
        (None, "[0.0, 0.0, 232.943151]", "stands half a turn about Z of the table ("),
        (None, "[10.0, 0.0, 52.943151]", "stands turned by +10.00° about (-0.60, -0.80, "),
        ("[-19.639683, 99.324447, 9.755860]", None, "stands X -50.0, Y +0.0, Z +0.0 mm from"),
    ],
)
def test_the_turn_and_the_place_come_first(text, origin, rotation_deg, said) -> None:
    """The file states another place than that of the touches, by this much."""
    run, machine = text
    for old, new in zip(STATED, (origin, rotation_deg), strict=True):
        run = run if new is None else run.replace(old, f"{old.split()[0]} = {new}")
    read = read_back(run, machine)
    sentence = comparison_sentence(compare(read))
    assert sentence.startswith(f"Set-up b {said}")
    assert "Set-up a" not in sentence
    assert verdict_sentence(diagnose(read)).startswith(f"Set-up b {said}")


def test_a_standard_that_stands_as_stated_is_not_mentioned(text) -> None:
    assert comparison_sentence(compare(read_back(*text))).startswith("Measured ")


@pytest.mark.parametrize("angle", [1e-7, 0.3, 1.5708, 3.0, 3.1415, np.pi])
def test_the_vector_of_a_rotation_is_its_inverse(angle) -> None:
    for axis in ([0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0]):
        R = rotation(angle * np.array(axis))
        found = rotation_vector(R)
        assert np.linalg.norm(found) == pytest.approx(angle, abs=1e-6)
        np.testing.assert_allclose(rotation(found), R, atol=1e-6)
