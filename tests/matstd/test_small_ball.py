"""Balls from 2 to 8 mm: every one can touch what it fits into, and the plan agrees."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from matstd.artefact.body import DatumSphere, Standard
from matstd.artefact.brief import read_project
from matstd.artefact.worth import each_at, sphere_grid
from matstd.probe_paths.plan import plan_touches
from matstd.probe_paths.stations import plan_options_of

PROJECT = Path(__file__).parents[2] / "examples" / "machines" / "vertical.toml"


@pytest.mark.parametrize("diameter", [2.0, 3.0, 4.0, 6.0, 8.0])
def test_a_ball_of_any_size_has_room(diameter: float) -> None:
    read = read_project(PROJECT)
    stack = ((read.probe.stack[0][0], diameter / 3.0), *read.probe.stack[1:])
    brief = replace(read, probes=(replace(read.probe, stack=stack, radius=0.5 * diameter),))
    made, wanted = brief.blank, brief.reach
    sphere = DatumSphere("SPH1", np.array([0.0, 0.0, 100.0]), 12.5, 6.0, 9.0, 30.0)
    bare = Standard("bare", "", made.material, made.base, None, (), (sphere,), (), 220.0)
    touches = each_at(sphere, sphere_grid(200), np.zeros((1, 0)))
    free = wanted.is_reachable(touches)
    free[free] = wanted.has_room(bare, touches[free])
    lean = np.degrees(np.arccos(touches.normal[:, 2]))
    # the same part of the sphere for every ball, but for the larger room that large ones may have
    assert free[lean < 55.0].all()
    plan = plan_touches(
        bare, brief.chain, brief.probe, brief.setup, touches[free], plan_options_of(brief)
    )
    assert plan.refused == () or all(r.request < 0 for r in plan.refused)
