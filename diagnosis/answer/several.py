"""Diagnosis of a machine that may have changed: between runs, or since its model was made.

Everything of the geometry may be another in every run; effects are common to all. Once the effects
are known, a run that shows no change from the one before shares its geometry, and the diagnosis is
made anew: with fewer numbers to learn, what is common is known better. What is told of changes
rests on the first of both, in which each run stands for itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from diagnosis.answer.trend import Trend, run_errors
from diagnosis.answer.verdict import Diagnosis
from diagnosis.fit import Fit, fit_run
from diagnosis.geometry import GeometryRow, changing, geometry_rows, with_changes
from diagnosis.search import DiagnosisTask


def settled(task: DiagnosisTask, diagnosed: Callable[[DiagnosisTask], Diagnosis]) -> Diagnosis:
    """The diagnosis with those changes of the geometry that the runs show.

    Args:
        task: Run or joined runs, with a starting model.
        diagnosed: Makes a diagnosis of a task.
    """
    runs = task.run.touches.runs
    possible = range(0 if task.is_known else 1, len(runs))
    if not possible:
        return diagnosed(task)
    free = diagnosed(_with(task, possible))
    shown = [i for i in possible if _is_changed(free.geometry.rows, i)]
    result = free if shown == list(possible) else diagnosed(_with(task, shown))
    if len(runs) == 1:
        return result
    rows = free.geometry.rows if result is free else _apart(result.fit)
    changed = tuple(i in shown for i in range(1, len(runs)))
    return replace(result, trend=Trend(run_errors(result.fit), changed, rows))


def _with(task: DiagnosisTask, since: Sequence[int]) -> DiagnosisTask:
    """The task with a geometry that may be another from some runs on."""
    model = changing(task.model, task.run.touches, since)
    return replace(task, model=model, prior=with_changes(task.prior, model))


def _is_changed(rows: Sequence[GeometryRow], run: int) -> bool:
    """Whether any quantity differs from the run before, or from the model before the first."""
    if run == 0:
        return any(row.has_changed_since_model for row in rows)
    return any(row.has_changed_into(run) for row in rows)


def _apart(fit: Fit) -> tuple[GeometryRow, ...]:
    """The geometry of every run by itself, beside the effects of a fit."""
    touches = fit.run.touches
    model = changing(fit.model, touches, range(1, len(touches.runs)))
    return geometry_rows(fit_run(fit.run, model, gross=fit.gross, memory=fit.memory))
