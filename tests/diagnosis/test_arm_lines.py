"""Lengths and twists of links, against lines that were displaced and then measured anew."""

import numpy as np
import pytest
from made_up import ARM, arm_poses
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry.arm_links import arm_functionals
from matstd.diagnosis.geometry.quantities import geometric_effects
from matstd.twin.effects import LocationError
from matstd.twin.library import ordinary_model
from matstd.twin.record import Run

JOINTS = ("C", "B", "B1", "A")


@pytest.fixture(scope="module")
def fit():
    touches = arm_poses(30)
    quiet = Run(touches, np.zeros(len(touches)), np.full(len(touches), 0.01))
    return fit_run(quiet, ordinary_model(ARM))


def displaced(errors: dict[str, float]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Point and direction of every line with location errors in machine directions, mm and rad."""
    out = {}
    for joint in JOINTS:
        link = ARM.link(joint)
        shift = [errors.get(f"E{c}0{joint}", 0.0) for c in "XYZ"]
        turn = [errors.get(f"E{c}0{joint}", 0.0) for c in "ABC"]
        out[joint] = link.point + shift, Rotation.from_rotvec(turn).apply(link.direction)
    return out


def distance(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> float:
    def square(s: np.ndarray) -> float:
        apart = one[0] + s[0] * one[1] - other[0] - s[1] * other[1]
        return float(apart @ apart)

    return float(np.sqrt(minimize(square, np.zeros(2), tol=1e-14).fun))


def test_links_of_displaced_lines_are_measured_as_they_are(fit) -> None:
    """Lengths where lines are apart, angles whatever way the lines run; B and B1 run opposite."""
    places = {
        effect.symbol.name: start
        for start, effect in geometric_effects(fit)
        if isinstance(effect, LocationError)
    }
    chosen = [n for n in places if n[3:] in JOINTS and n[1] != n[3]]
    rng = np.random.default_rng(3)
    errors = {n: float(rng.normal(0.0, 0.1 if n[1] in "XYZ" else 1e-4)) for n in chosen}
    theta = np.zeros(len(fit.model.parameters))
    for name, value in errors.items():
        theta[places[name]] = value
    reported = {f.symbol: float(f.weights @ theta) for f in arm_functionals(fit, JOINTS)}
    before, after = displaced({}), displaced(errors)
    for one, other in (("C", "B"), ("B1", "A")):
        change = distance(after[one], after[other]) - distance(before[one], before[other])
        assert reported[f"a({one},{other})"] == pytest.approx(change, abs=2e-3)
        angle = [np.arccos(s[one][1] @ s[other][1]) for s in (before, after)]
        assert abs(reported[f"alpha({one},{other})"]) == pytest.approx(
            abs(angle[1] - angle[0]), abs=1e-6
        )
    lean = np.array([reported["alpha(B,B1)"], reported["beta(B,B1)"]])
    opposite = np.pi - np.arccos(after["B"][1] @ after["B1"][1])
    assert -np.cos(opposite) == pytest.approx(after["B"][1] @ after["B1"][1])
    assert np.linalg.norm(lean) == pytest.approx(opposite, rel=1e-3)
