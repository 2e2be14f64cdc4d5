"""Choice by prediction: of several ways to explain a run the one that predicts unseen rows best.

A search finds what fits. Where sensors share what they know, or where something is left that no
effect explains, what fits best need not predict best, and the error of held-out rows flatters a set
that was chosen with all rows in sight. So every *way of choosing* is judged as a whole: block after
block is left out, the choice is made anew on the rest, and the rows left out are predicted. The way
with the smallest plain root mean square of those errors is then followed on all rows; and that
figure, which has paid for the choice, is the error that is stated.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.accuracy import blocks
from matstd.diagnosis.choice.bodies import bodies
from matstd.diagnosis.choice.field import sized_field
from matstd.diagnosis.choice.noise_memory import memory_of
from matstd.diagnosis.choice.pruned import prune_by_held_out_error
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

MAX_SETS_PER_BLOCK = 300.0
"""Sets that the search of one block may try: a fifth of what a whole diagnosis may."""

NOTHING, UNRECORDED, TWO_TIMES = "nothing", "unrecorded driver", "two time constants"
SINGLE, FIELD = "single effects", "thermal field"
"""Ways, the simplest first; an unrecorded driver is a smooth course in time, as the search found
it, and follows no sensor."""

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


@dataclass(frozen=True, slots=True, eq=False)
class _Ways:
    """Ways of choosing that the candidates leave open.

    Attributes:
        added: What the user added, which is in every set.
        drifts: Laws of drivers that were not recorded.
        single: Candidates but the field.
        warm: A field of all drives.
        groups: Rows of the run in every block.
        budgets: Of searches, so that a limit that was met is reported.
    """

    added: tuple[ScaledEffect, ...]
    gross: GrossErrors
    drifts: tuple[ScaledEffect, ...]
    single: tuple[Effect, ...]
    warm: Effect | None
    groups: tuple[IntArray, ...]
    budgets: list[Budget]

    @property
    def names(self) -> list[str]:
        """All of them, the simplest first."""
        has_lags = {"thermal-lag", "thermal-static"} <= {e.kind for e in self.single}
        is_open = {
            NOTHING: True,
            UNRECORDED: bool(self.drifts),
            TWO_TIMES: has_lags,
            SINGLE: bool(self.single),
            FIELD: self.warm is not None,
        }
        return [name for name, is_so in is_open.items() if is_so]

    def followed(self, name: str, task: DiagnosisTask) -> tuple[ScaledEffect, ...]:
        """The set to which a way leads in a task."""
        if name == TWO_TIMES:
            return bodies(task, self.added, self.gross)
        if name == SINGLE:
            return self._single_effects(task)
        if name == FIELD and self.warm is not None:
            return (sized_field(task, self.added, self.gross, self.warm, self.groups),)
        return self.drifts if name == UNRECORDED else ()

    def judged(
        self, name: str, task: DiagnosisTask, found: tuple[ScaledEffect, ...] | None = None
    ) -> ChoiceRule:
        """A way with its error of every block, predicted by a choice made without it.

        Args:
            found: A set that stays what it is, in the place of such a choice.
        """
        errors = []
        for group in self.groups:
            part = without(task, group)
            effects = self.followed(name, part) if found is None else found
            left = part.fit((*self.added, *effects), self.gross).residual[group]
            errors.append(rms(left))
        whole = self.followed(name, task) if found is None else found
        return ChoiceRule(name, whole, np.array(errors), np.array([len(g) for g in self.groups]))

    def _single_effects(self, task: DiagnosisTask) -> tuple[ScaledEffect, ...]:
        """Single effects by search, then those with inner parameters once more beside themselves.

        Each must lower the error of blocks left out.
        """
        complement = ResidualSpace.of(task.fit(self.added, self.gross))
        found: tuple[ScaledEffect, ...] = ()
        more: list[Effect] = []
        for _ in range(2):
            library = Library.of(complement, [*self.single, *more])
            self.budgets.append(Budget(MAX_SETS_PER_BLOCK))
            found = best_set(library, found, self.budgets[-1])[1].sized
            more = [a for s in found if (a := repeat(s.effect)) is not None]
            if not more:
                break
        return prune_by_held_out_error(complement, found, self.groups)


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
    remembers, gross = task.memory is not None, final.base.gross
    noise = task.fit((*added, *final.effects), gross).noise.factor
    is_open = noise > POLICY.memory_loud_noise if remembers else bool(final.remains)
    if not is_open or not drives(task.run.touches):
        return None
    # ways are compared in white noise: a memory would absorb what they are to explain
    task = replace(task, memory=None)
    fit = task.fit((*added, *final.effects), gross)
    memory, gain = memory_of(fit)
    if gain < POLICY.memory_gain or memory.per_independent < POLICY.memory_touches:
        return None
    task = thinned(task, fit)
    fit = task.fit((*added, *final.effects), gross)
    ways = _Ways(
        added=added,
        gross=gross,
        drifts=final.drifts,
        single=tuple(e for e in candidates if not traits(e).is_shrunk),
        warm=next((e for e in candidates if traits(e).is_shrunk), None),
        groups=blocks(fit, memory_of(fit)[0]),
        budgets=[],
    )
    rules = []
    for done, name in enumerate(ways.names):
        progress(done / len(ways.names), "choice by prediction")
        rules.append(ways.judged(name, task))
    best = clearly_best(rules, lambda rule: rule.error)
    if best.name == UNRECORDED:
        return None
    if remembers:
        searched = ways.judged(SINGLE, task, final.effects)
        if best.error > POLICY.error_share_beside_memory * searched.error:
            return None
    left = memory_of(task.fit((*added, *best.effects), gross))
    return Choice(
        rules=tuple(rules),
        best=best,
        blocks=len(ways.groups),
        memory=left[0] if left[1] >= POLICY.memory_gain else None,
        is_ended=any(b.is_spent for b in ways.budgets),
    )


def candidate_effects(touches: Touches) -> list[Effect]:
    """All effects that a diagnosis may find in a run: proposals of the library, field of drives."""
    warm = field(touches)
    return [*proposals(touches), *([warm] if warm is not None else [])]


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
