"""A serial arm under a tracker: joints that give way, beside everything else it does wrong."""

import numpy as np
from made_up import ARM, arm_poses

from matstd.diagnosis.answer import diagnose
from matstd.twin.library import ordinary_model, parse_effect, proposals
from matstd.twin.model import Model
from matstd.twin.record import Run
from matstd.twin.units import UM, URAD

NOISE = 10.0 * UM
POSES = 40


def run_of(sags: dict[str, list[float]], seed: int = 5) -> Run:
    """Geometry drawn at random, and joints that give way, by the exact product."""
    touches = arm_poses(POSES)
    rng = np.random.default_rng(seed)
    start = ordinary_model(ARM)
    weak = [parse_effect(f"joint-sag({joint})", ARM) for joint in sags]
    theta = np.concatenate([rng.normal(0.0, 0.5 * start.prior_sd), *sags.values()])
    exact = Model(ARM, (*start.effects, *weak)).deviation(touches, theta)
    return Run(touches, exact + rng.normal(0.0, NOISE, len(touches)), np.full(len(touches), NOISE))


def test_joints_that_sag_are_found_and_none_beside_them() -> None:
    weights = 0.3 * URAD  # 0.3 mrad a metre of every lever: a third of a millimetre in all
    result = diagnose(run_of({"B": [weights] * 4, "B1": [weights] * 3}))
    assert sorted(e.name for e in result.found) == ["joint-sag(B)", "joint-sag(B1)"]
    assert result.fit.test_rms < 1.5 * NOISE < 0.5 * result.steps[0].fit.test_rms
    for step in result.steps[1:]:
        size = next(r for r in step.reported if r.quantity == "peak_to_valley")
        assert size.u < 0.2 * size.value


def test_a_stiff_arm_has_no_joints_that_sag() -> None:
    run = run_of({})
    assert not diagnose(run, candidates=proposals(run.touches, ("joint-sag", "drift"))).found
