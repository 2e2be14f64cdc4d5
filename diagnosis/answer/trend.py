"""What several runs of one machine tell of its course, and how well each of them is known."""

from dataclasses import dataclass, replace

import numpy as np

from diagnosis.answer.comparison import predicted_by
from diagnosis.fit import Fit, Prior, fit_run
from diagnosis.geometry import (
    GeometryRow,
    changed_since,
    changing,
    standing,
    state_of_standing,
)
from diagnosis.regression import BoolArray
from twin.frames import Array
from twin.model import Model
from twin.record import Run


@dataclass(frozen=True, slots=True)
class RunErrors:
    """How well one of several runs is known, mm.

    Attributes:
        name: Of the run.
        touches: Rows that were fitted.
        rms: Root mean square residual of those rows.
        test_rms: Plain error of its poses, each predicted by all others.
        left_out: Plain error of the whole run, its set-ups fitted, the machine predicted by the
            other runs: as in the run before, of the first run as in the one after.
    """

    name: str
    touches: int
    rms: float
    test_rms: float
    left_out: float


@dataclass(frozen=True, slots=True, eq=False)
class Trend:
    """What changed between several runs of one machine, and what did not.

    Attributes:
        runs: In their order.
        changed: Whether the geometry changed from the run before, for every run but the first.
        rows: The geometry with its course, every run by itself.
    """

    runs: tuple[RunErrors, ...]
    changed: tuple[bool, ...]
    rows: tuple[GeometryRow, ...]


def run_errors(fit: Fit) -> tuple[RunErrors, ...]:
    """Figures of every run of a fit."""
    out = []
    run_of = fit.run.touches.run
    for i, name in enumerate(fit.run.touches.runs):
        rows, own = fit.used & (run_of == i), run_of[fit.used] == i
        out.append(
            RunErrors(
                name=name,
                touches=int(rows.sum()),
                rms=_rms(fit.residual[rows]),
                test_rms=_rms(fit.held_out_errors[own]),
                left_out=_left_out(fit, rows, i),
            )
        )
    return tuple(out)


def _left_out(fit: Fit, rows: BoolArray, run: int) -> float:
    """Error of a run that the fit has not seen."""
    since = [i for i in changed_since(fit.model) if i != max(run, 1)]
    others = np.where(rows | ~fit.used, "test", "")
    model = changing(fit.model, fit.run.touches, since)
    learnt = fit_run(replace(fit.run, split=others), model, gross=fit.gross, memory=fit.memory)
    return predicted(learnt, fit.run[rows], run)


def predicted(fit: Fit, run: Run, index: int) -> float:
    """Plain error of a run that a fit has not seen: its set-ups fitted, the machine predicted.

    Args:
        fit: To other runs.
        run: The measurements.
        index: Run of the fit in whose state the machine is taken, or the number of the run itself.
    """
    count = len(fit.model.parameters)
    L = state_of_standing(fit.model, index)
    machine = Model(fit.model.chain, standing(fit.model))
    spread = L @ fit.spread[:count]
    estimates = Prior.of_estimates(L @ fit.theta[:count], spread @ spread.T)
    return predicted_by(run, machine, estimates).rms


def _rms(errors: Array) -> float:
    return float(np.sqrt(np.mean(errors**2))) if len(errors) else float("nan")
