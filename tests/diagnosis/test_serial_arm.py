"""A serial arm under a tracker: joints that give way, beside everything else it does wrong."""

import numpy as np
import pytest
from made_up import ARM, arm_poses
from marks import slow
from unchanged import answer_text

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.policy import POLICY
from matstd.report.run_view import diagnosis_step
from matstd.report.verdict import diagnosis_meaning, part_lines
from matstd.report.words import verdict_sentence
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


def test_joints_that_sag_are_found_and_none_beside_them(unchanged) -> None:
    weights = 0.3 * URAD  # 0.3 mrad a metre of every lever: a third of a millimetre in all
    result = diagnose(run_of({"B": [weights] * 4, "B1": [weights] * 3}))
    assert sorted(e.name for e in result.found) == ["joint-sag(B)", "joint-sag(B1)"]
    assert result.fit.test_rms < 1.5 * NOISE < 0.5 * result.steps[0].fit.test_rms
    for step in result.steps[1:]:
        size = next(r for r in step.reported if r.quantity == "peak_to_valley")
        assert size.u < 0.2 * size.value
    unchanged(answer_text(result))


def test_a_stiff_arm_has_no_joints_that_sag() -> None:
    run = run_of({})
    assert not diagnose(run, candidates=proposals(run.touches, ("joint-sag", "drift"))).found


@pytest.mark.parametrize(
    ("weight", "verdict"),
    [(0.0, Verdict.NONE), (0.034, Verdict.UNDECIDED), *slow((0.06, Verdict.MISSING))],
)
def test_a_sag_that_a_zero_may_be_is_undecided(weight, verdict, unchanged) -> None:
    """Chance does not make it, and yet its size is within what wrong zeros of the joints leave."""
    run = run_of({"B": [weight * URAD] * 4}, 3)
    found = diagnose(run, candidates=[parse_effect("joint-sag(B)", ARM)])
    assert found.verdict is verdict
    if verdict is not Verdict.UNDECIDED:
        return
    (step,) = found.steps[1:]
    assert step.p_value < POLICY.false_alarm
    assert step.worth < POLICY.significant_ratio
    assert found.parts.headline == ()
    said = verdict_sentence(found)
    why = "less than 2 times its uncertainty"
    assert said.startswith(
        f"This run cannot decide: one effect would reduce the error, but it is {why}"
    )
    assert "joint-sag" not in said  # no headline names it, the part on names does
    named = dict(part_lines(found))["named effects"]
    assert named.startswith("sag of joint B")
    assert f", {why}" in named
    assert "further readings" in diagnosis_step(found, "run.csv")
    assert "does not decide whether the machine has an effect" in diagnosis_meaning(found)
    unchanged(answer_text(found))
