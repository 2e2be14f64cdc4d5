"""A law after a driver that was not recorded is not blamed on another sensor."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from simulator_case import read_back, simulate_case
from simulator_effects import growth_of_standard
from simulator_experiment import MACHINES

from matstd.diagnosis.answer import ConfusionClass, Verdict, diagnose
from matstd.diagnosis.answer.ambiguity import Rival
from matstd.diagnosis.answer.reported_set import ReportedSet
from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.residual import Shape
from matstd.diagnosis.search import follows_driver
from matstd.diagnosis.search.missing_driver import unrecorded
from matstd.twin.library import parse_effect, proposals
from matstd.twin.model import columns
from matstd.twin.record import Run


@pytest.fixture(scope="module")
def growing() -> Run:
    """A three-axis machine with a standard that expands by 30 µm/(m K)."""
    hidden = growth_of_standard("artefact")
    hidden.amplitude = 30.0
    rng = np.random.default_rng([1, 13])
    text, machine, _ = simulate_case(rng, "hmc1995", [hidden], with_alike=False)
    assert machine == MACHINES["hmc1995"]
    return read_back(text, machine)


def without_sensor(run: Run, name: str) -> Run:
    known = {k: v for k, v in run.touches.temperature.items() if k != name}
    return replace(run, touches=replace(run.touches, temperature=known))


def test_a_recorded_driver_is_named(growing: Run) -> None:
    few = proposals(growing.touches, ("artefact-expansion", "thermal-expansion", "thermal-lag"))
    found = diagnose(growing, candidates=few)
    assert [e.name for e in found.found] == ["artefact-expansion(artefact)"]
    assert found.parts.named[0].against_drift is not None
    assert found.parts.named[0].against_drift > 0.0


@pytest.mark.slow
def test_no_other_sensor_is_named_where_the_driver_is_missing(growing: Run) -> None:
    run = without_sensor(growing, "artefact")
    found = diagnose(run)
    assert not [e.name for e in found.found if follows_driver(e)]
    assert found.verdict is Verdict.UNEXPLAINED
    first = found.left[0]
    assert (first.shape, first.law) == (Shape.DRIVER, "artefact-expansion")
    assert not [o.effect for o in found.nearest if "(" in o.effect and "scale" in o.effect]


def test_a_law_of_a_missing_driver_is_the_law_with_any_smooth_course(growing: Run) -> None:
    """The course of the missing sensor is in the span of its columns, to some per cent."""
    touches = growing.touches
    law = parse_effect("artefact-expansion(artefact)", touches.chain)
    one = next(u for u in unrecorded(touches) if u.law.kind == law.kind and u.half_waves == 6)
    A, b = columns([one], touches), columns([law], touches)[:, 0]
    left = b - A @ np.linalg.lstsq(A, b, rcond=None)[0]
    assert np.linalg.norm(left) < 0.03 * np.linalg.norm(b)
    first = columns([law], replace(touches, temperature={"artefact": np.full(len(b), 21.0)}))[:, 0]
    assert A[:, 0] == pytest.approx(first, abs=1e-12)


@pytest.mark.parametrize(
    ("law", "other", "odds", "is_open"),
    [
        ("thermal-lag(EXX,scaleY)", "thermal-lag(EXX,ambient)", 9.0, True),
        ("thermal-lag(EXX,scaleY)", "thermal-lag(EXX,ambient)", 12.0, False),  # none unrecorded
        ("thermal-lag(EXX,scaleY)", "thermal-lag(EXY,scaleY)", 9.0, False),  # one sensor
        ("thermal-lag(EXX,scaleX)", "thermal-lag(EXX,ambient)", 9.0, False),  # the body's own
    ],
)
def test_a_law_of_which_no_sensor_is_shown_is_not_named(growing, law, other, odds, is_open) -> None:
    one, rival = (ScaledEffect(parse_effect(name, growing.touches.chain)) for name in (law, other))
    state = SimpleNamespace(effects=(one,), is_weighed=False)
    found = ConfusionClass(one, (Rival(rival, 2.0, 1.0),), ())
    tested = ReportedSet(state, (found,), {}, {law: odds})
    assert tested.open_driver == (law if is_open else None)
