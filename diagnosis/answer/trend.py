"""What several runs show of one machine's course, and how well each of them is known.

Everything of the geometry may be another in every run; effects are common to all. Once the effects
are known, a run that shows no change since the last one shares its geometry with those before, and
the diagnosis is made anew: with fewer numbers to learn, what is common is known better.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from matstd.diagnosis.fit import Fit, Prior, fit_run
from matstd.diagnosis.geometry import (
    Estimate,
    GeometryRow,
    changed_runs,
    changed_since,
    changing,
    geometry_rows,
    with_changes,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search import FOUND_PRIOR_FACTOR, DiagnosisTask
from matstd.twin.display import Displayed
from matstd.twin.model import Effect, Model, columns, original_of, traits
from matstd.twin.numbers import rms

if TYPE_CHECKING:
    from matstd.diagnosis.answer.verdict import Diagnosis


@dataclass(frozen=True, slots=True)
class RunErrors:
    """How well one of several runs is known, mm."""

    name: str
    touches: int
    # root mean square residual of those that were fitted; None if the run was held out
    rms: float | None
    # plain error of its poses, each predicted by all others; None for a held-out run
    test_rms: float | None
    # plain error of the whole run, its set-ups fitted, the machine predicted by the other runs: as
    # in the run before, of the first run as in the one after. None where no other run was fitted
    left_out: float | None

    @property
    def is_held_out(self) -> bool:
        """Whether the diagnosis was made without it."""
        return self.rms is None


@dataclass(frozen=True, slots=True)
class SingleChange:
    """What changed into a run, if nothing else of the geometry did."""

    effect: Effect
    unit: str  # of its parameter, "mm" or "rad"
    size: Estimate


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Trend(Displayed):
    """What changed between several runs of one machine, and what did not.

    Of a change several estimates exist, with other runs taken together or apart: quote that of
    `known_best`, which sentences, tables and files have.
    """

    runs: tuple[RunErrors, ...]
    # runs, by number, whose geometry differs from that of the run before; 0 stands for the first
    # beside the model that the diagnosis began with
    changed: tuple[int, ...]
    rows: tuple[GeometryRow, ...]  # the geometry with its course, every run by itself
    # the same with runs between which nothing changed as one: what did change is known better by it
    pooled: tuple[GeometryRow, ...]
    # by run, the one change that is beyond chance if nothing else changed, where none is while
    # everything may
    alone: Mapping[int, SingleChange] = field(default_factory=dict)

    def known_best(self, run: int) -> tuple[GeometryRow, ...]:
        """The rows, in the same order, by which what changed into a run is known best."""
        return self.pooled if run in self.changed else self.rows


def run_errors(fit: Fit) -> tuple[RunErrors, ...]:
    """Figures of every run of a fit."""
    run_of = fit.run.touches.run
    held_out, out = fit.held_out_errors, []
    for i, name in enumerate(fit.run.touches.runs):
        rows, own = fit.used & (run_of == i), run_of[fit.used] == i
        is_fitted = bool(rows.any())
        counted = rows if is_fitted else fit.test_rows & (run_of == i)
        others = _without(fit, i) if is_fitted else fit
        out.append(
            RunErrors(
                name=name,
                touches=int(counted.sum()),
                rms=rms(fit.residual[rows]) if is_fitted else None,
                test_rms=rms(held_out[own]) if is_fitted else None,
                left_out=None if others is None else rms(others.residual[counted]),
            )
        )
    return tuple(out)


def single_change(fit: Fit, run: int) -> SingleChange | None:
    """The clearest change of one effect into a run, all else constant; None within chance.

    One column more beside a fit: ``a = c^T r / c^T P c`` with P the projection on what the model
    cannot imitate and r what it leaves.
    """
    touches = fit.run.touches
    beside = changing(fit.model, touches, [run]).effects
    tried = [e for e in beside if traits(e).since_run is not None and len(e.parameters) == 1]
    C = columns(tried, touches)
    C = fit.whitener(C) if fit.whitener else C[fit.used] / (fit.u[fit.used, None] * fit.weight)
    left = C - fit.solution.Q @ (fit.solution.Q.T @ C)
    size = np.einsum("np,np->p", C, left)
    sd = np.array([p.sd for e in tried for p in e.parameters])
    seen = np.flatnonzero(size * sd**2 > 1.0)  # what is expected would show beyond the noise
    if not len(seen):
        return None
    value, u = (left.T @ fit.solution.residual)[seen] / size[seen], 1.0 / np.sqrt(size[seen])
    clear = np.abs(value) / u
    # a slope of a straightness and a squareness are one thing: the user's word is the second
    is_place = np.array([original_of(tried[i]).kind == "location" for i in seen])
    best = int(np.argmax(clear + POLICY.location_lead * is_place))
    if clear[best] <= POLICY.clear_change:
        return None
    effect = original_of(tried[seen[best]])
    return SingleChange(
        effect, effect.parameters[0].unit, Estimate(float(value[best]), float(u[best]))
    )


def _without(fit: Fit, run: int) -> Fit | None:
    """The fit to the other runs alone; None where there is no other."""
    touches = fit.run.touches
    others = [i for i in np.unique(touches.run[fit.used]) if i != run]
    if not others:
        return None
    # changes since a run that is left out cannot be estimated
    since = [i for i in changed_since(fit.model) if i in others[1:]]
    split = np.where(fit.used & (touches.run != run), "", "test")
    model = changing(fit.model, touches, since)
    return fit_run(replace(fit.run, split=split), model, gross=fit.gross, memory=fit.memory)


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
    model = changing(fit.model, touches, fitted[1:])
    rows = geometry_rows(fit_run(fit.run, model, gross=fit.gross, memory=fit.memory))
    return Trend(
        runs=run_errors(fit),
        changed=tuple(shown),
        rows=rows,
        pooled=geometry_rows(fit),
        alone=alone,
    )


def shown_changes(
    task: DiagnosisTask, free: "Diagnosis", possible: Sequence[int]
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


def _fit(task: DiagnosisTask, free: "Diagnosis", since: Iterable[int]) -> Fit:
    """The runs beside the effects that were found, with changes of the geometry since some."""
    changes = changing_since(task, sorted(since))
    model = Model(task.model.chain, (*changes.model.effects, *free.found))
    prior = changes.prior.joined(Prior.of_effects(free.found).widened(FOUND_PRIOR_FACTOR))
    return fit_run(task.run, model, prior, gross=free.fit.gross, memory=free.fit.memory)


def _evidence(fit: Fit) -> float:
    """Log evidence of a fit up to a constant, ``-n log s - log det R - objective / 2``.

    With s the size of the noise: what a geometry that may change explains, less what so many free
    numbers explain by chance.
    """
    spread = float(np.log(np.abs(np.diag(fit.solution.R))).sum())
    size = int(fit.used.sum()) * float(np.log(fit.noise.factor))
    return -size - spread - 0.5 * fit.solution.objective
