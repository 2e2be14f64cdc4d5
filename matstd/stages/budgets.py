"""Budgets of a measuring task from runs of a standard: artefact and diagnosis strung together."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import Brief, Task
from matstd.artefact.certify import displaced_features, like_task, that_prove
from matstd.artefact.reach import Requests
from matstd.artefact.worth import Calibration
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.task import TaskUncertainty, Visits, task_uncertainty, visits_of
from matstd.probe_paths.campaign import VirtualMachine, visits
from matstd.probe_paths.control import ReadProgram
from matstd.stages.warm_body import WarmBody
from matstd.twin.errors import DesignError
from matstd.twin.frames import pose, rotation
from matstd.twin.model import Model
from matstd.twin.record import Run
from matstd.twin.units import UM, URAD

UNCORRECTED = "as measured"  # results that no model corrects

CLAMPING_SCATTER = (50.0 * UM, 200.0 * URAD)
"""How far from where it is believed a standard stands in a virtual visit, mm and rad: less than
the room between a touch and the edge of its face."""


def budgets(
    runs: Sequence[Run],
    standard: Standard,
    known: Calibration,
    task: Task,
    models: Mapping[str, tuple[Model, Prior] | None],
) -> tuple[dict[str, TaskUncertainty], Visits]:
    """Budgets of a task without and with models, and the visits that the last rests upon.

    Arguments and errors as of `places_of`.
    """
    seen = places_of(runs, standard, known, task, models)
    found = {name: task_uncertainty(one, task.u_w) for name, one in seen.items()}
    return found, list(seen.values())[-1]


def places_of(
    runs: Sequence[Run],
    standard: Standard,
    known: Calibration,
    task: Task,
    models: Mapping[str, tuple[Model, Prior] | None],
) -> dict[str, Visits]:
    """What several visits found at the places of a task, without and with models.

    Args:
        models: What results are corrected with, by name; None for nothing.

    Raises:
        DesignError: A run of another standard, or no touch like the task.
        NotEnoughData: Too few visits or places.
    """
    for run in runs[1:]:
        if differs := run.touches.chain.difference(runs[0].touches.chain):
            key, ours, theirs = differs
            raise DesignError(
                f"machines of two visits: {key} is {ours} and {theirs}, expected one machine"
            )
    is_datum = [~that_prove(standard, run.touches) for run in runs]
    wanted = [like_task(task, standard, run.touches) for run in runs]
    first = runs[0].touches
    rotary = first.q[:, first.chain.rotary_columns]
    columns = known.columns(standard, Requests(first.feature, first.point, first.normal, rotary))
    out = {}
    for name, model in models.items():
        what, estimates = (None, None) if model is None else model
        out[name] = visits_of(runs, wanted, is_datum, columns, what, estimates)
    return out


def virtual_budgets(
    brief: Brief,
    standard: Standard,
    programs: Sequence[Path | ReadProgram],
    machine: VirtualMachine,
    rng: np.random.Generator,
) -> tuple[dict[str, TaskUncertainty], Visits]:
    """Budgets of the brief's task from visits on the twin, before and after identification.

    The true standard is beside its calibration as much as that allows, and clamped anew for every
    visit, at another temperature than its thermometer reads. The model is identified from the balls
    of the first.

    Args:
        programs: Those that are read already are taken for checked.
    """
    known = brief.options.criterion.calibration
    true = displaced_features(standard, known, rng)
    stands = [
        replace(machine, setup_error=pose(rotation(rng.normal(0.0, b, 3)), rng.normal(0.0, a, 3)))
        for a, b in [CLAMPING_SCATTER] * brief.study.visits
    ]
    body = WarmBody.of(brief.study, standard, known)
    pieces = body.pieces(true, len(stands), rng.spawn(1)[0])
    runs = [
        body.stated_in(visits(programs, piece, [stand], rng, calibrated=standard)[0].run)
        for piece, stand in zip(pieces, stands, strict=True)
    ]
    # the model learns from the balls alone: the features that prove stay unseen
    held_back = np.where(that_prove(standard, runs[0].touches), "test", "train")
    fit = fit_run(replace(runs[0], split=held_back), brief.population.expected())
    count = len(fit.model.parameters)
    learnt = fit.model, Prior(fit.theta[:count], np.zeros((count, count)))
    models = {UNCORRECTED: None, "with the identified model": learnt}
    return budgets(runs, standard, known, brief.task, models)
