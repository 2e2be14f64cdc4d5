"""The design run: machine file in; standard, CAD, probing programs and proof out.

Each stage is one call into one room; nothing is computed here.
"""

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from artefact.knowable import Knowable, knowable, write_identifiability
from artefact.placement import Placement, place
from artefact.standard_file import write_standard
from cad_out.conformity import Conformity
from cad_out.export import export_standard
from diagnosis.fit import Fit, fit_run
from diagnosis.identification_file import write_identification
from diagnosis.proof import Proof, probed_volume, prove
from matstd.project_file import Project
from matstd.reach import check_reach
from matstd.wanted import frame, placement_options, plan_options, probe, probing
from probe_paths.campaign import Campaign, simulate
from probe_paths.contacts import VirtualMachine
from probe_paths.plan import TouchPlan
from probe_paths.planner import plan_touches
from probe_paths.program import ProgramSet, make_programs
from sensitivity.crew import Crew
from sensitivity.maps import draw_maps
from sensitivity.sampling import Population, drawn_errors
from sensitivity.study import Study, run_study
from sensitivity.study_file import write_study
from sensitivity.trajectory_pictures import draw_path
from sensitivity.workspace import Workspace
from twin.effect import Effect, contribution
from twin.files.error_file import errors_toml
from twin.files.run_writer import write_run
from twin.files.whole import write_whole
from twin.frames import Array

PROOF_POSES = 2000
"""Poses at which predicted and true volumetric error are compared, none of them probed."""

Stage = Callable[[str, int, int], None]
"""Told the name of a stage, what is done and how much there is."""


@dataclass(frozen=True, eq=False)
class Proven:
    """One random machine, probed with the emitted programs and identified.

    Attributes:
        seed: Of its errors and noise, beside the project's.
        errors: Its true errors.
        campaign: The programs run on its twin.
        fit: The identified model.
        proof: Predicted against true volumetric error.
    """

    seed: int
    errors: list[tuple[Effect, Array]]
    campaign: Campaign
    fit: Fit
    proof: Proof


@dataclass(frozen=True, eq=False)
class Design:
    """Everything that a design run made; the files of the same names hold it.

    Attributes:
        project: What was asked for.
        study: Sensitivities and random machines.
        maps: File and caption of the study's pictures.
        placement: Standard and touches.
        conformity: CAD files, measured after they were written.
        plan: Touches in their order.
        programs: Text that makes them.
        machines: Random machines, probed and identified.
        known: What the touches can and cannot tell apart.
        effective: Number of parameters that the first machine's data decide rather than the prior.
    """

    project: Project
    study: Study
    maps: list[tuple[str, str]]
    placement: Placement
    conformity: Conformity
    plan: TouchPlan
    programs: ProgramSet
    machines: tuple[Proven, ...]
    known: Knowable
    effective: float


def design(project: Project, folder: Path, progress: Stage, crew: Crew = None) -> Design:
    """Run all stages and write their files into a folder.

    Args:
        project: What shall be designed, for which machine.
        folder: Empty folder.
        progress: Told what is going on.
        crew: Who draws the random machines of the maps; None for this process.

    Raises:
        DesignError: A stage that cannot do its work; its message says which constraint binds.
    """
    rng_study, rng_place, rng_proof, rng_maps, rng_known = _generators(project)
    progress("reach", 0, 1)
    poses = check_reach(project, folder)
    shutil.copyfile(project.machine_path, folder / "machine.toml")
    population = project.population
    workspace = Workspace(project.chain, project.workspace, project.probe_length)
    placement = _placement(project, workspace, rng_place, progress, poses)
    plan = _plan(project, placement)
    write_standard(folder / "standard.toml", placement.standard)
    progress("what can be told apart", 0, 1)
    known = knowable(placement.criterion, placement.requests, rng_known)
    write_identifiability(folder / "identifiability.json", known)
    study = run_study(
        population,
        workspace,
        project.poses,
        project.draws,
        rng_study,
        progress,
        project.tolerance,
        project.digits,
        crew,
    )
    write_study(study, folder / "sensitivity")
    maps = draw_maps(study, folder / "sensitivity", rng_maps)
    maps += draw_path(study, folder / "sensitivity")
    progress("STEP and STL", 0, 1)
    conformity = export_standard(placement.standard, folder)
    progress("probing programs", 0, 1)
    programs = make_programs(plan)
    paths = programs.write(folder / "programs")
    machines = []
    for seed in range(project.machines):
        progress("proof on the twin", seed, project.machines)
        machines.append(_prove(project, population, placement, paths, seed, rng_proof.spawn(1)[0]))
    first = machines[0]
    write_whole(folder / "errors.toml", errors_toml(first.errors))
    write_run(folder / "run.csv", first.campaign.run, "machine.toml")
    proofs = [m.proof for m in machines]
    found = write_identification(folder / "identification.json", first.fit, proofs)
    return Design(
        project=project,
        study=study,
        maps=maps,
        placement=placement,
        conformity=conformity,
        plan=plan,
        programs=programs,
        machines=tuple(machines),
        known=known,
        effective=found.effective,
    )


def _generators(project: Project) -> list[np.random.Generator]:
    """Random numbers of study, placement, proof, maps, other ways to measure."""
    return np.random.default_rng(project.seed).spawn(5)


def _placement(
    project: Project,
    workspace: Workspace,
    rng: np.random.Generator,
    progress: Stage,
    poses: Array | None = None,
) -> Placement:
    """Standard and touches for the project's machine."""
    return place(
        probing(project),
        frame(project),
        workspace,
        rng,
        project.ranges,
        placement_options(project),
        progress,
        project.expected.distributions,
        poses,
    )


def _plan(project: Project, placement: Placement) -> TouchPlan:
    """Touches that the placement wants, in the order of a cautious operator."""
    return plan_touches(
        placement.standard,
        project.chain,
        probe(project),
        project.setup,
        placement.requests,
        plan_options(project),
    )


def _prove(
    project: Project,
    population: Population,
    placement: Placement,
    programs: list[Path],
    seed: int,
    rng: np.random.Generator,
) -> Proven:
    """Probe one random machine by the text of the programs, identify it, compare with its truth."""
    rng_errors, rng_noise, rng_poses = rng.spawn(3)
    errors = drawn_errors(population, rng_errors)
    machine = VirtualMachine(
        project.chain, lambda touches: contribution(errors, touches), noise=project.noise
    )
    table = project.limits.table_radius_mm
    campaign = simulate(programs, placement.standard, machine, rng_noise, table_radius=table)
    fit = fit_run(campaign.run, population.expected())
    poses = probed_volume(campaign.run, PROOF_POSES, rng_poses)
    return Proven(seed, errors, campaign, fit, prove(fit, errors, project.setup, poses))
