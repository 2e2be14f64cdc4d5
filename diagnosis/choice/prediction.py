"""Choice by prediction: of several ways to explain a run the one that predicts unseen rows best.

A search finds what fits. Where sensors share what they know, or where something is left that no
effect explains, what fits best need not predict best, and the error of held-out rows flatters a set
that was chosen with all rows in sight. So every *way of choosing* is judged as a whole: block after
block is left out, the choice is made anew on the rest, and the rows left out are predicted. The way
with the smallest plain root mean square of those errors is then followed on all rows; and that
figure, which has paid for the choice, is the error that is stated.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.choice.blocks import blocks, prune_by_held_out_error
from matstd.diagnosis.choice.bodies import bodies
from matstd.diagnosis.choice.field import sized_field
from matstd.diagnosis.choice.noise_memory import memory_of
from matstd.diagnosis.evidence import Progress, ResidualSpace, ScaledEffect, quiet
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors, Memory
from matstd.diagnosis.search import (
    Budget,
    DiagnosisTask,
    Library,
    SearchState,
    best_set,
    clearly_best,
)
from matstd.twin.effects import repeat
from matstd.twin.frames import Array
from matstd.twin.library import proposals
from matstd.twin.model import Effect, traits
from matstd.twin.numbers import rms
from matstd.twin.record import IntArray, Touches
from matstd.twin.thermal import drives, field

MIN_ROWS_PER_INDEPENDENT = 4.0
"""Touches for one independent observation from which a residual is no longer nearly white."""

MAX_SETS_PER_BLOCK = 300.0
"""Sets that the search of one block may try: a fifth of what a whole diagnosis may."""

UNRECORDED = "unrecorded driver"
"""The way that follows no sensor: a smooth course in time, as the search found it."""

MAX_ROWS = 4000
"""Most rows used to judge ways of choosing, since each block needs a search of its own."""


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceRule:
    """A way of choosing effects, judged.

    Attributes:
        name: `nothing`, `unrecorded driver`, `two time constants`, `single effects`,
            `thermal field`.
        errors: Plain root mean square error of every block left out, the choice made anew each
            time, (B,), mm.
        rows: Of every block, (B,).
    """

    name: str
    effects: tuple[ScaledEffect, ...]
    errors: Array
    rows: Array

    @property
    def error(self) -> float:
        """Of all rows together, mm."""
        return float(np.sqrt(self.rows @ self.errors**2 / self.rows.sum()))


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """The result of a choice by prediction.

    Attributes:
        rules: All that were judged, the simplest first.
        blocks: Number of blocks that were left out, one after the other.
        memory: Of what is left with it; None where it is white.
        is_ended: Whether a search for single effects was ended by its limit, `MAX_SETS_PER_BLOCK`.
    """

    rules: tuple[ChoiceRule, ...]
    best: ChoiceRule
    blocks: int
    memory: Memory | None
    is_ended: bool = False


Chooser = Callable[[DiagnosisTask, GrossErrors], tuple[ScaledEffect, ...]]


def chosen_by_prediction(
    task: DiagnosisTask,
    added: tuple[ScaledEffect, ...],
    final: SearchState,
    candidates: Sequence[Effect],
    progress: Progress = quiet,
) -> Choice | None:
    """The way that predicts best, or None where there is nothing to choose.

    There is where structure is left, or noise with memory that is larger than stated, what is left
    is slow, and the run recorded something that may drive it.
    """
    remembers = task.memory is not None
    is_open = bool(final.remains)
    if remembers:
        is_open = (
            task.fit((*added, *final.effects), final.base.gross).noise.factor
            > POLICY.memory_loud_noise
        )
    if not is_open or not drives(task.run.touches):
        return None
    # ways are compared in white noise: a memory would absorb what they are to explain
    task = replace(task, memory=None)
    fit = task.fit((*added, *final.effects), final.base.gross)
    memory, gain = memory_of(fit)
    if gain < POLICY.memory_gain or memory.per_independent < MIN_ROWS_PER_INDEPENDENT:
        return None
    task = thinned(task, fit)
    fit = task.fit((*added, *final.effects), final.base.gross)
    groups = blocks(fit, memory_of(fit)[0])
    budgets: list[Budget] = []
    choosers = _choosers(added, final.drifts, candidates, groups, budgets)
    gross = final.base.gross
    rules = []
    for done, (name, chooser) in enumerate(choosers.items()):
        progress(done / len(choosers), "choice by prediction")
        errors = _errors(task, added, gross, groups, chooser)
        counts = np.array([len(g) for g in groups])
        # the choice is made anew without each block, so that its error pays for the choice
        rules.append(ChoiceRule(name, chooser(task, gross), errors, counts))
    best = clearly_best(rules, lambda rule: rule.error)
    if best.name == UNRECORDED:
        return None
    if remembers:
        errors = _errors(task, added, gross, groups, lambda task, gross: final.effects)
        if best.error > POLICY.error_share_beside_memory * replace(best, errors=errors).error:
            return None
    left = memory_of(task.fit((*added, *best.effects), gross))
    return Choice(
        rules=tuple(rules),
        best=best,
        blocks=len(groups),
        memory=left[0] if left[1] >= POLICY.memory_gain else None,
        is_ended=any(b.is_spent for b in budgets),
    )


def candidate_effects(touches: Touches) -> list[Effect]:
    """All effects that a diagnosis may find in a run: proposals of the library, field of drives."""
    warm = field(touches)
    return [*proposals(touches), *([warm] if warm is not None else [])]


def _choosers(
    added: tuple[ScaledEffect, ...],
    drifts: tuple[ScaledEffect, ...],
    candidates: Sequence[Effect],
    groups: Sequence[IntArray],
    budgets: list[Budget],
) -> dict[str, Chooser]:
    """The ways that the candidates leave open, the simplest first; budgets of searches are kept."""
    single = [e for e in candidates if not traits(e).is_shrunk]
    warm = next((e for e in candidates if traits(e).is_shrunk), None)
    out: dict[str, Chooser] = {"nothing": lambda task, gross: ()}
    if drifts:
        out[UNRECORDED] = lambda task, gross: drifts
    if {"thermal-lag", "thermal-static"} <= {e.kind for e in single}:
        out["two time constants"] = lambda task, gross: bodies(task, added, gross)
    if single:
        out["single effects"] = lambda task, gross: single_effects(
            task, added, gross, single, groups, budgets
        )
    if warm is not None:
        out["thermal field"] = lambda task, gross: (sized_field(task, added, gross, warm, groups),)
    return out


def _errors(
    task: DiagnosisTask,
    added: tuple[ScaledEffect, ...],
    gross: GrossErrors,
    groups: Sequence[IntArray],
    chooser: Chooser,
) -> Array:
    """Error of every block, predicted by a choice made without it, (B,), mm."""
    out = []
    for group in groups:
        part = without(task, group)
        effects = chooser(part, gross)
        out.append(rms(part.fit((*added, *effects), gross).residual[group]))
    return np.array(out)


def thinned(task: DiagnosisTask, fit: Fit) -> DiagnosisTask:
    """The task of a long run reduced to an even choice of its instants; each is kept whole."""
    rows = np.flatnonzero(fit.used)
    time = task.run.touches.time
    instants = np.unique(time[rows])
    every = -(-len(rows) // MAX_ROWS)
    if every == 1 or len(instants) < len(blocks(fit, None)) * every:
        return task
    return without(task, rows[~np.isin(time[rows], instants[::every])])


def without(task: DiagnosisTask, rows: IntArray) -> DiagnosisTask:
    """The task with some rows held out; effects still know what happened there."""
    split = np.array(task.run.split, dtype="U5")
    split[rows] = "test"
    return replace(task, run=replace(task.run, split=split))


def single_effects(
    task: DiagnosisTask,
    added: tuple[ScaledEffect, ...],
    gross: GrossErrors,
    candidates: Sequence[Effect],
    groups: Sequence[IntArray],
    budgets: list[Budget],
) -> tuple[ScaledEffect, ...]:
    """Single effects by search, then those with inner parameters once more beside themselves.

    Args:
        groups: Rows of the run in every block; each effect must lower the error of blocks left out.
        budgets: Those of its searches join them, so that a limit that was met is reported.
    """
    complement = ResidualSpace.of(task.fit(added, gross))
    found: list[ScaledEffect] = []
    more: list[Effect] = []
    for _ in range(2):
        library = Library.of(complement, [*candidates, *more])
        budgets.append(Budget(MAX_SETS_PER_BLOCK))
        found = list(best_set(library, found, budgets[-1])[1].sized)
        more = [a for s in found if (a := repeat(s.effect)) is not None]
        if not more:
            break
    return prune_by_held_out_error(complement, found, groups)
