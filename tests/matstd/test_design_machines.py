"""A small design for every kind of machine: from the project file to programs and proof, no CAD."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from matstd.artefact.body import check
from matstd.artefact.brief import Brief, read_project
from matstd.artefact.compare import comparison
from matstd.artefact.feasibility.within_travels import travels
from matstd.artefact.place import design_standard
from matstd.artefact.worth import TouchOptions, ball_choice
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.stations import orders
from matstd.report.plots import draw_order
from matstd.report.style import save
from matstd.stages import design

EXAMPLES = Path(__file__).parents[2] / "examples"
MACHINES = {
    "hsm600u": "[w C' B' X' f Y Z (C1) t]",
    "machines/head-table": "[w C' X' f Y Z B (C1) t]",
    "machines/trunnion": "[w C' A' Y' f X Z (C1) t]",
    "machines/gantry": "[w f X Y Z C A (C1) t]",
    "machines/vertical": "[w X' Y' f Z (C1) t]",
    "machines/horizontal": "[w B' Z' f X Y (C1) t]",
    "machines/four-axis": "[w A' X' Y' f Z (C1) t]",
    "machines/upright": "[w B' X' f Y Z (C1) t]",
}
TOUCHES = 80


def small(name: str) -> Brief:
    """One of the examples with few patches, poses and touches, and one machine to prove it on."""
    project = read_project(EXAMPLES / f"{name}.toml")
    wanted = project.options
    few = replace(
        wanted,
        patches=4,
        balls=7,
        sites=60,
        criterion=replace(wanted.criterion, potential=0.0),
        choice=TouchOptions(TOUCHES, 5, 40),
    )
    return replace(project, options=few)


SLOW = frozenset(MACHINES) - {"machines/vertical"}
"""Ten seconds and more each; the command's own test designs a machine of five axes."""


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if n in SLOW else ()) for n in MACHINES]
)
def test_a_design_for_every_kind_of_machine(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = small(name)
    assert project.chain.notation == MACHINES[name]
    monkeypatch.setattr(ball_choice, "_PLACES", 60)
    monkeypatch.setattr(comparison, "COUNTS", (4,))
    monkeypatch.setattr(comparison, "_SCATTER_SIZE", 600)
    bodies = comparison.rivals
    monkeypatch.setattr(comparison, "rivals", lambda *of: dict([*bodies(*of).items()][:1]))
    rng_place, rng_proof = np.random.default_rng(project.seed).spawn(2)
    found = travels(project)
    assert not found.against
    placement = design_standard(project, rng_place, poses=found.poses)
    check(placement.standard, project.blank.limits)
    assert len(placement.requests) == TOUCHES
    assert (project.reach.reasons(placement.standard, placement.requests) == "").all()
    ((_, plan),) = design._plans(project, placement)
    found = orders(plan, placement.criterion.model, project.noise)
    assert all(len(order.reversal) == len(project.chain.rotary_axes) for order in found)
    assert all(np.isfinite([o.drift, *o.reversal]).all() and o.duration > 0.0 for o in found)
    save(draw_order(plan), tmp_path / "order.png")
    programs = make_programs(plan).write(tmp_path)
    machine = design._prove(project, placement, programs, 0, rng_proof)
    assert len(machine.campaign.run) == len(plan)
    # what the touches predict: far better than nothing, and as well as they say themselves
    assert machine.proof.factor > 5.0
    assert machine.proof.rms_after < 2.0 * machine.proof.rms_u
