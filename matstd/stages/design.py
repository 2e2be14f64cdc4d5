"""The design run: machine file in; standard, CAD, probing programs and proof out.

Each stage is one call into one room; nothing is computed here.
"""

import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard, write_standard
from matstd.artefact.brief import Project
from matstd.artefact.certify import dmis_program, like_task
from matstd.artefact.compare import WorstRegions, identifiability_report, worst_regions
from matstd.artefact.place import Placement, design_standard
from matstd.cad_out.details import datum_touches, details_of, engraved_on
from matstd.cad_out.making import Stiffness, making_of, stiffness_of, with_sag, write_making
from matstd.cad_out.verify import Conformity, export_standard
from matstd.diagnosis.answer import probed_volume, prove, seen_from
from matstd.diagnosis.files import write_uncertainty
from matstd.diagnosis.fit import fit_run
from matstd.probe_paths.campaign import Campaign, VirtualMachine, simulate
from matstd.probe_paths.plan import TouchPlan
from matstd.probe_paths.stations import all_programs, make_stations, plan_campaign
from matstd.report.drawing import Issuer, write_drawing
from matstd.report.identifiability import write_identifiability, write_identification
from matstd.report.pages import Design, Proven
from matstd.sensitivity.first_order import Workspace, latin_hypercube
from matstd.sensitivity.montecarlo import Workers
from matstd.sensitivity.population import drawn_errors
from matstd.sensitivity.study import Study
from matstd.stages.budgets import virtual_budgets
from matstd.stages.from_project import (
    blank,
    clampings,
    dialect,
    dialects,
    feeds,
    placement_options,
    plan_options,
    probe_reach,
    probes,
)
from matstd.stages.reach import check_reach
from matstd.stages.seat import check_beside, check_seat
from matstd.stages.space import check_space
from matstd.stages.streams import streams
from matstd.stages.study_run import study_and_maps
from matstd.twin.compute import Progress
from matstd.twin.files import errors_toml, write_run, write_whole
from matstd.twin.frames import Array
from matstd.twin.model import Effect, contribution
from matstd.twin.record import at_poses

PROOF_POSES = 2000
"""Poses at which predicted and true volumetric error are compared, none of them probed."""


def design(project: Project, folder: Path, progress: Progress, workers: Workers = None) -> Design:
    """Run all stages and write their files into a folder.

    Args:
        project: What shall be designed, for which machine.
        folder: Empty folder.
        progress: Told what is going on.
        workers: Who draws the random machines of the maps; None for this process.

    Raises:
        DesignError: A stage that cannot do its work; its message says which constraint binds.
    """
    rng = streams(project.seed)
    progress("reach", 0, 1)
    check_seat(project)
    poses = check_reach(project, folder)
    check_space(project, folder, poses)
    shutil.copyfile(project.machine_path, folder / "machine.toml")
    workspace = Workspace(project.chain, project.workspace, project.probe_length)
    placement = _placement(project, workspace, rng.placement, progress, poses)
    placement, stiffness = _with_sag(placement, project.standard.down)
    plans = _plans(project, placement)
    _write_standard(folder, placement.standard)
    with ThreadPoolExecutor(1) as beside:  # the kernel works in processes of its own
        cad = beside.submit(_export, project, placement.standard, folder)
        progress("what can be told apart", 0, 1)
        known = identifiability_report(placement.criterion, placement.requests, rng.other_setups)
        write_identifiability(folder / "identifiability.json", known)
        study, maps = study_and_maps(
            project, workspace, project.poses, folder / "sensitivity", rng, progress, workers
        )
        progress("STEP and STL", 0, 1)
        making = making_of(placement.standard, stiffness)
        write_making(folder / "making.json", making)
        conformity = cad.result()
    _draw(project, placement.standard, conformity, folder)
    progress("probing programs", 0, 1)
    stations = make_stations(plans, dialects(project), feeds(project))
    paths = all_programs(stations).write(folder / "programs")
    machines = []
    for seed in range(project.machines):
        progress("proof on the twin", seed, project.machines)
        machine = _prove(project, workspace, placement, paths, seed, rng.proof.spawn(1)[0])
        machines.append(machine)
    first = machines[0]
    write_whole(folder / "errors.toml", errors_toml(first.errors))
    write_run(folder / "run.csv", first.campaign.run, "machine.toml")
    progress("visits on the twin", 0, 1)
    known_places = placement_options(project).criterion.calibration
    twin, task = _twin(project, first.errors), project.task
    budgets, visits = virtual_budgets(
        project, placement.standard, known_places, paths, twin, rng.visits
    )
    write_uncertainty(folder / "uncertainty.json", task.name, budgets, task.tolerance)
    proofs = [m.proof for m in machines]
    found = write_identification(folder / "identification.json", first.fit, proofs)
    return Design(
        project=project,
        study=study,
        maps=maps,
        placement=placement,
        worst=_worst(placement, study),
        conformity=conformity,
        making=making,
        stations=stations,
        machines=tuple(machines),
        known=known,
        effective=found.effective,
        budgets=budgets,
        visits=visits,
    )


def _write_standard(folder: Path, standard: Standard) -> None:
    """The design, and the program of its calibration."""
    write_standard(folder / "standard.toml", standard)
    program = dmis_program(standard, datum_touches(standard), engraved_on(standard))
    write_whole(folder / "cmm.dmi", program, newline="\r\n")


def _worst(placement: Placement, study: Study) -> WorstRegions:
    """What the faces see of the poses at which machines are wrong again and again."""
    on_body = placement.criterion.on(placement.standard)
    return worst_regions(on_body, placement.proof, study.q, study.volumetric.recurrence)


def _export(project: Project, standard: Standard, folder: Path) -> Conformity:
    """STEP, STL, 3MF and glTF of a standard, measured; refused where a clamp stands in it."""
    who = project.standard
    made = export_standard(standard, folder, author=who.author, organisation=who.organisation)
    check_beside(project, standard, folder)
    return made


def _draw(project: Project, standard: Standard, conformity: Conformity, folder: Path) -> None:
    """The drawing of a standard, with the mass that was measured."""
    who = project.standard
    write_drawing(folder, standard, Issuer(who.author, who.organisation, conformity.mass))


def _placement(
    project: Project,
    workspace: Workspace,
    rng: np.random.Generator,
    progress: Progress,
    poses: Array | None = None,
) -> Placement:
    """Standard and touches for the project's machine."""
    placement = design_standard(
        probe_reach(project),
        blank(project),
        workspace,
        rng,
        project.population,
        placement_options(project),
        progress,
        poses,
    )
    # refused here rather than after programs and CAD, where no touch is like the user's task
    proving = placement.criterion.reach.touches(placement.touches)
    like_task(project.task, placement.standard, proving)
    return placement


def _with_sag(placement: Placement, down: str) -> tuple[Placement, Stiffness | None]:
    """The standard with what its weight does to it, which evaluations take off, if it is known."""
    standard = placement.standard
    stiffness = stiffness_of(standard, details_of(standard))
    if stiffness is None:
        return placement, None
    return replace(placement, standard=with_sag(standard, stiffness, down)), stiffness


def _plans(project: Project, placement: Placement) -> list[tuple[int, TouchPlan]]:
    """Touches that the placement wants, in the order of a cautious operator, by probe."""
    return plan_campaign(
        placement.standard,
        project.chain,
        probes(project),
        clampings(project),
        placement.touches,
        plan_options(project),
    )


def _prove(
    project: Project,
    workspace: Workspace,
    placement: Placement,
    programs: list[Path],
    seed: int,
    rng: np.random.Generator,
) -> Proven:
    """Probe one random machine by the text of the programs, identify it, compare with its truth."""
    rng_errors, rng_noise, rng_volume, rng_workspace = rng.spawn(4)
    population = project.population
    errors = drawn_errors(population, rng_errors)
    machine = _twin(project, errors)
    campaign = _held_back(
        simulate(programs, placement.standard, machine, rng_noise), placement.standard
    )
    fit = fit_run(campaign.run, population.expected())
    in_volume = probed_volume(campaign.run, PROOF_POSES, rng_volume)
    q = latin_hypercube(workspace, PROOF_POSES, rng_workspace)
    believed = campaign.run.touches.setups[0]
    in_workspace = seen_from(at_poses(project.chain, q, project.probe_length), believed)
    return Proven(
        seed=seed,
        errors=errors,
        campaign=campaign,
        fit=fit,
        proof=prove(fit, errors, project.setup, in_volume),
        in_workspace=prove(fit, errors, project.setup, in_workspace),
    )


def _twin(project: Project, errors: list[tuple[Effect, Array]]) -> VirtualMachine:
    """The project's machine with some errors."""
    return VirtualMachine(
        project.chain,
        lambda touches: contribution(errors, touches),
        noise=project.noise,
        dialect=dialect(project),
    )


def _held_back(campaign: Campaign, standard: Standard) -> Campaign:
    """A campaign whose touches on freeform faces prove and do not identify."""
    on_face = np.isin(campaign.run.touches.feature, [p.name for p in standard.patches])
    run = replace(campaign.run, split=np.where(on_face, "test", "train"))
    return replace(campaign, run=run)
