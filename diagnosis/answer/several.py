"""Diagnosis of a machine that may have changed: between runs, or since its model was made.

Everything of the geometry may be another in every run; effects are common to all. Once the effects
are known, a run that shows no change since the last one shares its geometry with those before, and
the diagnosis is made anew: with fewer numbers to learn, what is common is known better.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.answer.trend import Trend, run_errors
from diagnosis.answer.verdict import Diagnosis
from diagnosis.fit import Fit, fit_run
from diagnosis.geometry import (
    GeometryRow,
    changed_runs,
    changing,
    geometry_rows,
    with_changes,
)
from diagnosis.search import DiagnosisTask


def settled(task: DiagnosisTask, diagnosed: Callable[[DiagnosisTask], Diagnosis]) -> Diagnosis:
    """The diagnosis with those changes of the geometry that the runs show.

    Args:
        task: Run or joined runs, with a starting model.
        diagnosed: Makes a diagnosis of a task.
    """
    touches = task.run.touches
    fitted = [int(i) for i in np.unique(touches.run[task.run.split != "test"])]
    possible = [0] * task.is_known + fitted[1:]
    free = diagnosed(_with(task, possible))
    shown = [*_since_model(free.geometry.rows), *changed_runs(free.fit)]
    result = free if shown == possible else diagnosed(_with(task, shown))
    if len(touches.runs) == 1:
        return result
    apart = geometry_rows(_apart(result.fit, fitted[1:]))
    trend = Trend(run_errors(result.fit), tuple(shown), apart, geometry_rows(result.fit))
    return replace(result, trend=trend)


def _with(task: DiagnosisTask, since: Sequence[int]) -> DiagnosisTask:
    """The task with a geometry that may be another from some runs on."""
    if not since:
        return task
    model = changing(task.model, task.run.touches, since)
    return replace(task, model=model, prior=with_changes(task.prior, model))


def _since_model(rows: Sequence[GeometryRow]) -> list[int]:
    """The first run, where it differs from an earlier model."""
    return [0] if any(row.has_changed_since_model for row in rows) else []


def _apart(fit: Fit, since: Sequence[int]) -> Fit:
    """The fit with a geometry of its own in every run."""
    model = changing(fit.model, fit.run.touches, since)
    return fit_run(fit.run, model, gross=fit.gross, memory=fit.memory)
