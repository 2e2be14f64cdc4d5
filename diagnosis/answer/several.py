"""Diagnosis of a machine that may have changed: between runs, or since its model was made.

Everything of the geometry may be another in every run; effects are common to all. Once the effects
are known, a run that shows no change since the last one shares its geometry with those before, and
the diagnosis is made anew: with fewer numbers to learn, what is common is known better.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.answer.trend import SingleChange, Trend, run_errors, single_change
from matstd.diagnosis.answer.verdict import Diagnosis
from matstd.diagnosis.fit import Fit, Prior, fit_run
from matstd.diagnosis.geometry import (
    changed_runs,
    changing,
    geometry_rows,
    with_changes,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search import FREEDOM, DiagnosisTask
from matstd.twin.model import Model


def possible_changes(task: DiagnosisTask) -> list[int]:
    """Runs from which on the geometry may be another; 0 of the first beside an earlier model."""
    fitted = [int(i) for i in np.unique(task.run.touches.run[task.run.split != "test"])]
    return [0] * task.is_known + fitted[1:]


def changing_since(task: DiagnosisTask, since: Sequence[int]) -> DiagnosisTask:
    """The task with a geometry that may be another from some runs on."""
    if not since:
        return task
    model = changing(task.model, task.run.touches, since)
    return replace(task, model=model, prior=with_changes(task.prior, model))


def trend(fit: Fit, shown: Sequence[int], alone: Mapping[int, SingleChange]) -> Trend | None:
    """The course of a machine over several runs; None for a single one."""
    touches = fit.run.touches
    if len(touches.runs) == 1:
        return None
    fitted = [int(i) for i in np.unique(touches.run[fit.run.split != "test"])]
    rows = geometry_rows(_apart(fit, fitted[1:]))
    return Trend(
        runs=run_errors(fit),
        changed=tuple(shown),
        rows=rows,
        pooled=geometry_rows(fit),
        alone=alone,
    )


def shown_changes(
    task: DiagnosisTask, free: Diagnosis, possible: Sequence[int]
) -> tuple[list[int], dict[int, SingleChange]]:
    """Runs from which on the geometry is another, and what changed into them if only one thing did.

    A quantity says so while all the others may change as well; or all of them together; or one
    effect by itself, which a crash or a shim is likelier to be than a hundred at once.
    """
    shown = set(changed_runs(free.fit))
    if any(row.has_changed_since_model for row in free.geometry.rows):
        shown.add(0)
    alone: dict[int, SingleChange] = {}
    for run in (i for i in possible if i not in shown):
        without, beside = (_fit(task, free, since) for since in (shown, {*shown, run}))
        # an earlier fit that has to be believed less is one of another state of the machine
        is_contradicted = run == 0 and without.widened > 1.0
        single = single_change(without, run) if run else None
        if single is not None:
            alone[run] = single
        if is_contradicted or single or _evidence(beside) > _evidence(without) + POLICY.memory_gain:
            shown.add(run)
    return sorted(shown), alone


def _fit(task: DiagnosisTask, free: Diagnosis, since: Iterable[int]) -> Fit:
    """The runs beside the effects that were found, with changes of the geometry since some."""
    changes = changing_since(task, sorted(since))
    model = Model(task.model.chain, (*changes.model.effects, *free.found))
    prior = changes.prior.joined(Prior.of_effects(free.found).widened(FREEDOM))
    return fit_run(task.run, model, prior, gross=free.fit.gross, memory=free.fit.memory)


def _evidence(fit: Fit) -> float:
    """Log evidence of a fit up to a constant, ``-n log s - log det R - objective / 2``.

    With s the size of the noise: what a geometry that may change explains, less what so many free
    numbers explain by chance.
    """
    spread = float(np.log(np.abs(np.diag(fit.solution.R))).sum())
    size = int(fit.used.sum()) * float(np.log(fit.noise.factor))
    return -size - spread - 0.5 * fit.solution.objective


def _apart(fit: Fit, since: Sequence[int]) -> Fit:
    """The fit with a geometry of its own in every run."""
    model = changing(fit.model, fit.run.touches, since)
    return fit_run(fit.run, model, gross=fit.gross, memory=fit.memory)
