"""The design run: machine file in; standard, CAD, probing programs and proof out.

Each stage is one call into one room; nothing is computed here.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.artefact.body import Standard, write_standard
from matstd.artefact.brief import Brief
from matstd.artefact.certify import like_task, that_prove
from matstd.artefact.compare import WorstRegions, identifiability_report, worst_regions
from matstd.artefact.feasibility import check_beside, check_seat, feasibility
from matstd.artefact.hidden import write_scan_path
from matstd.artefact.place import Placement, design_standard
from matstd.artefact.price import Construction
from matstd.cad_out.details import details_of
from matstd.cad_out.making import Stiffness, making_of, stiffness_of, with_sag, write_making
from matstd.cad_out.meshes import read_stl
from matstd.cad_out.verify import Conformity, export_standard
from matstd.diagnosis.accuracy import probed_volume, prove, seen_from
from matstd.diagnosis.files import write_uncertainty
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.task import TaskUncertainty, Visits
from matstd.probe_paths.campaign import Campaign, VirtualMachine, simulate
from matstd.probe_paths.control import ReadProgram
from matstd.probe_paths.plan import TouchPlan
from matstd.probe_paths.stations import (
    all_programs,
    dialects_of,
    feeds_of,
    make_stations,
    plan_campaign,
    plan_options_of,
)
from matstd.report.drawing import Issuer, write_drawing
from matstd.report.identifiability import identifiability_table, write_identification
from matstd.report.pages import Design, Proven, machine_times
from matstd.report.plots import draw_reach, draw_room
from matstd.report.style import save
from matstd.sensitivity.first_order import latin_hypercube
from matstd.sensitivity.montecarlo import Workers
from matstd.sensitivity.population import drawn_errors
from matstd.sensitivity.study import Study
from matstd.stages.budgets import virtual_budgets
from matstd.stages.cmm import cmm_program
from matstd.stages.refusals import REACH, ROOM
from matstd.stages.study_run import Streams, streams, study_and_maps
from matstd.stages.warm_body import WarmBody
from matstd.twin.beside import beside
from matstd.twin.compute import Progress, silent
from matstd.twin.errors import BadFile
from matstd.twin.files import errors_toml, write_run, write_whole
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.model import Effect, contribution
from matstd.twin.record import at_poses

PROOF_POSES = 2000
"""Poses at which predicted and true volumetric error are compared, none of them probed."""


def design(brief: Brief, folder: Path, progress: Progress, workers: Workers = None) -> Design:
    """Run all stages and write their files into a folder.

    Args:
        progress: Called with stage, done and total.
        workers: Draw the random machines of the maps; None for this process.

    Raises:
        DesignError: A stage that cannot do its work; its message says which constraint binds.
    """
    rng = streams(brief.seed)
    progress("reach", 0, 1)
    check_seat(brief)
    poses = _feasible_poses(brief, folder)
    if brief.machine_path is not None:
        shutil.copyfile(brief.machine_path, folder / "machine.toml")
    where, maps_in = (brief.workspace, brief.study.poses), folder / "sensitivity"
    # the maps need nothing of the standard: drawn while it is sought, they cost no time
    with beside(study_and_maps, brief, *where, maps_in, rng, silent, workers) as studied:
        placement = design_standard(brief, rng.placement, progress, poses)
        return _made(brief, placement, folder, rng, progress, studied)


def _made(
    brief: Brief,
    placement: Placement,
    folder: Path,
    rng: Streams,
    progress: Progress,
    studied: Callable[[], tuple[Study, list[tuple[str, str]]]],
) -> Design:
    """Everything that is made of a placement; `studied` waits for the study and its maps."""
    # refused here rather than after programs and CAD, where no touch is like the user's task
    proving = placement.criterion.reach.touches(placement.touches)
    like_task(brief.task, placement.standard, proving)
    placement, stiffness = _with_sag(placement, brief.down)
    _check_first_mode(brief, stiffness)
    plans = _plans(brief, placement)
    if brief.options.scan is not None and len(placement.scan_poses):
        standard, at = placement.standard, placement.scan_poses
        path, scan = folder / "scan_path.csv", brief.options.scan
        write_scan_path(path, standard.patches[0], scan, at, brief.reach, standard)
    making = making_of(placement.standard, stiffness)
    write_making(folder / "making.json", making)
    write_standard(folder / "standard.toml", placement.standard)
    write_whole(folder / "cmm.dmi", cmm_program(placement.standard), newline="\r\n")
    plan = plans[0][1]
    with (
        beside(_export, brief, placement.standard, making.make, folder, proving.q) as exported,
        beside(machine_times, brief, placement, plan) as times,
    ):
        progress("identifiability", 0, 1)
        known = identifiability_report(placement.criterion, placement.requests, rng.other_setups)
        write_json(folder / "identifiability.json", identifiability_table(known))
        progress("probing programs", 0, 1)
        stations = make_stations(plans, dialects_of(brief), feeds_of(brief))
        paths = all_programs(stations).write(folder / "programs")
        tried = _on_twins(brief, placement, paths, folder, rng, progress)
        progress("maps", 0, 1)
        study, maps = studied()
        progress("STEP and STL", 0, 1)
        conformity, on_machine = exported(), times()
    return Design(
        brief=brief,
        study=study,
        maps=maps,
        placement=placement,
        worst=_worst(placement, study),
        conformity=conformity,
        making=making,
        stations=stations,
        machines=tried.machines,
        identifiability=known,
        effective=tried.effective,
        budgets=tried.budgets,
        visits=tried.visits,
        times=on_machine,
    )


class _OnTwins(NamedTuple):
    """What the programs did on random machines; fields as of `Design`."""

    machines: tuple[Proven, ...]
    effective: float
    budgets: Mapping[str, TaskUncertainty]
    visits: Visits


def _on_twins(
    brief: Brief,
    placement: Placement,
    paths: list[Path],
    folder: Path,
    rng: Streams,
    progress: Progress,
) -> _OnTwins:
    """Run the programs on random machines, and visit the first again and again for the task."""
    machines: list[Proven] = []
    programs: Sequence[Path | ReadProgram] = paths
    for seed in range(brief.study.machines):
        progress("proof on the twin", seed, brief.study.machines)
        machines.append(_prove(brief, placement, programs, seed, rng.proof.spawn(1)[0]))
        # read and checked for the first machine: the text is the same for all
        programs = [one.program for one in machines[0].campaign.runs]
    first = machines[0]
    write_whole(folder / "errors.toml", errors_toml(first.errors))
    write_run(folder / "run.csv", first.campaign.run, "machine.toml")
    progress("visits on the twin", 0, 1)
    twin, task = _twin(brief, first.errors), brief.task
    budgets, visits = virtual_budgets(brief, placement.standard, programs, twin, rng.visits)
    write_uncertainty(folder / "uncertainty.json", task.name, budgets, task.tolerance)
    proofs = [m.proof for m in machines]
    found = write_identification(folder / "identification.json", first.fit, proofs)
    return _OnTwins(tuple(machines), found.effective, budgets, visits)


def _worst(placement: Placement, study: Study) -> WorstRegions:
    """What the faces see of the poses at which machines are wrong again and again."""
    on_body = placement.criterion.on(placement.standard)
    return worst_regions(on_body, placement.proof, study.q, study.volumetric.recurrence)


def _export(
    brief: Brief, standard: Standard, make: Construction, folder: Path, q: Array
) -> Conformity:
    """STEP, STL, 3MF and glTF of a standard, measured, and its drawing with the mass found.

    Refused where a clamp stands in it.

    Args:
        make: How the workshop makes it.
        q: Planned readings, (N, A), mm and rad.
    """
    made = export_standard(standard, folder, author=brief.author, organisation=brief.organisation)
    check_beside(brief, standard, read_stl(folder / "standard.stl"), q)
    issuer = Issuer(
        brief.author,
        brief.organisation,
        mass=made.mass,
        approved=brief.approved,
        date=brief.date,
        make=make,
    )
    write_drawing(folder, standard, issuer)
    return made


def _feasible_poses(brief: Brief, folder: Path) -> Array:
    """Table poses to choose from; pictures of what is reached, and of what does not fit."""
    found = feasibility(brief)
    save(draw_reach(found.places, brief.chain, brief.blank), folder / REACH)
    if found.room is not None and not found.room.is_enough:
        save(draw_room(found.room), folder / ROOM)
    found.check()
    return found.poses


def _with_sag(placement: Placement, down: str) -> tuple[Placement, Stiffness | None]:
    """The standard with what its weight does to it, which evaluations take off, if it is known."""
    standard = placement.standard
    stiffness = stiffness_of(standard, details_of(standard))
    if stiffness is None:
        return placement, None
    return replace(placement, standard=with_sag(standard, stiffness, down)), stiffness


def _check_first_mode(brief: Brief, stiffness: Stiffness | None) -> None:
    """Raise BadFile for a first mode below the limit of the project."""
    wanted = brief.first_mode
    if not wanted or (stiffness is not None and stiffness.first_mode >= wanted):
        return
    if stiffness is None:
        found = f"{wanted:g} for '{brief.blank.material.name}', whose modulus is not known"
        raise BadFile(brief.path, "limits.first_mode_Hz", found, "material.modulus_MPa as well")
    raise BadFile(
        brief.path,
        "limits.first_mode_Hz",
        f"{wanted:g}",
        f"at most {stiffness.first_mode:.0f}, the first mode of this design; a smaller "
        "blank.height_mm or a material with more stiffness per mass raises it",
    )


def _plans(brief: Brief, placement: Placement) -> list[tuple[int, TouchPlan]]:
    """Touches that the placement wants, in the order of a cautious operator, by probe."""
    return plan_campaign(
        placement.standard,
        brief.chain,
        brief.probes,
        brief.clampings,
        placement.touches,
        plan_options_of(brief),
    )


def _prove(
    brief: Brief,
    placement: Placement,
    programs: Sequence[Path | ReadProgram],
    seed: int,
    rng: np.random.Generator,
) -> Proven:
    """Probe one random machine by the text of the programs, identify it, compare with its truth."""
    # a stream for each use: more draws of one leave the numbers of the others as they were
    rng_errors, rng_noise, rng_volume, rng_workspace, rng_body = rng.spawn(5)
    population = brief.population
    errors = drawn_errors(population, rng_errors)
    machine = _twin(brief, errors)
    standard = placement.standard
    body = WarmBody.of(brief.study, standard, brief.options.criterion.calibration)
    (piece,) = body.pieces(standard, 1, rng_body)
    probed = simulate(programs, piece, machine, rng_noise, calibrated=standard)
    campaign = _with_split(replace(probed, run=body.stated_in(probed.run)), standard)
    fit = fit_run(campaign.run, population.expected())
    in_volume = probed_volume(campaign.run, PROOF_POSES, rng_volume)
    q = latin_hypercube(brief.workspace, PROOF_POSES, rng_workspace)
    believed = campaign.run.touches.setups[0]
    in_workspace = seen_from(at_poses(brief.chain, q, brief.probe.length), believed)
    return Proven(
        seed=seed,
        errors=errors,
        campaign=campaign,
        fit=fit,
        proof=prove(fit, errors, brief.setup, in_volume),
        in_workspace=prove(fit, errors, brief.setup, in_workspace),
    )


def _twin(brief: Brief, errors: list[tuple[Effect, Array]]) -> VirtualMachine:
    """The project's machine with some errors."""
    return VirtualMachine(
        brief.chain,
        lambda touches: contribution(errors, touches),
        noise=brief.noise,
        dialect=dialects_of(brief)[0],
    )


def _with_split(campaign: Campaign, standard: Standard) -> Campaign:
    """A campaign whose touches on features that prove do not identify."""
    proves = that_prove(standard, campaign.run.touches)
    run = replace(campaign.run, split=np.where(proves, "test", "train"))
    return replace(campaign, run=run)
