"""The thresholds of a diagnosis stand once, and each is used."""

import inspect
from dataclasses import FrozenInstanceError, fields
from pathlib import Path

import pytest

import matstd.diagnosis
from matstd.diagnosis.policy import POLICY, Policy

NAME = "false_alarm"
ROOM = Path(inspect.getfile(matstd.diagnosis)).parent


def test_every_threshold_has_its_reason_and_is_used() -> None:
    code = "\n".join(p.read_text() for p in ROOM.rglob("*.py") if p.parent.name != "policy")
    lines = [line.strip() for line in inspect.getsource(Policy).splitlines()]
    for threshold in fields(Policy):
        (at,) = [i for i, line in enumerate(lines) if line.startswith(f"{threshold.name}: ")]
        assert lines[at - 1].startswith("# ") or "  # " in lines[at], threshold.name
        assert f"POLICY.{threshold.name}" in code, threshold.name


def test_a_policy_is_frozen_and_names_the_false_alarms_of_a_run() -> None:
    with pytest.raises(FrozenInstanceError):
        setattr(POLICY, NAME, 0.5)
    assert POLICY.table()["false_alarm_of_run"] == pytest.approx(3e-3)
    assert Policy(false_alarm=1e-4).false_alarm_of_run == pytest.approx(3e-4)
