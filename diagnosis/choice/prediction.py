"""Choice by prediction: does a body, or a field of all drives, predict what the search left open?

A search adds one effect after the other and finds what fits. Where sensors share what they know,
two lags of one drive or a field of all drives may predict better. So each of these *ways* is judged
as a whole: block after block is left out, the way is followed anew on the rest, and the rows left
out are predicted. The plain root mean square of those errors has paid for the choice, and is the
error that is stated. In the same comparison stands what the search found, alone and with a driver
that was not recorded, both found in sight of all rows; so another way takes their place only if it
predicts far better.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.accuracy import blocks
from matstd.diagnosis.choice.bodies import bodies
from matstd.diagnosis.choice.field import sized_field
from matstd.diagnosis.choice.noise_memory import memory_of
from matstd.diagnosis.evidence import Progress, ScaledEffect, quiet
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors, Memory
from matstd.diagnosis.search import DiagnosisTask, SearchState, clearly_best, likeliest_drift
from matstd.twin.fields import moved_components
from matstd.twin.frames import Array, IntArray
from matstd.twin.library import parse_effect, proposals
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import Effect, traits
from matstd.twin.numbers import rms
from matstd.twin.record import Touches
from matstd.twin.thermal import drives, field

NOTHING, FOUND, UNRECORDED = "nothing", "single effects", "unrecorded driver"
TWO_TIMES, FIELD = "two time constants", "thermal field"
"""Ways, the simplest first; an unrecorded driver is a smooth course in time beside what was found,
and follows no sensor."""

Way = Callable[[DiagnosisTask], tuple[ScaledEffect, ...]]  # the set to which a way leads in a task

MAX_ROWS = 4000
"""Most rows used to judge ways of choosing, each of which is followed once for every block."""


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceRule:
    """A way of choosing effects, judged."""

    # `nothing`, `single effects`, `unrecorded driver`, `two time constants`, `thermal field`
    name: str
    effects: tuple[ScaledEffect, ...]
    # plain root mean square error of every block left out, the choice made anew each time, (B,), mm
    errors: Array
    rows: Array  # of every block, (B,)

    @property
    def error(self) -> float:
        """Of all rows together, mm."""
        return float(np.sqrt(self.rows @ self.errors**2 / self.rows.sum()))


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """The result of a choice by prediction."""

    rules: tuple[ChoiceRule, ...]  # all that were judged, the simplest first
    best: ChoiceRule
    blocks: int  # number of blocks that were left out, one after the other
    memory: Memory | None  # of what is left with it; None where it is white

    @property
    def nothing(self) -> ChoiceRule:
        """The model without any of the ways, with what the user added, in the same blocks."""
        return self.rules[0]


def chosen_by_prediction(
    task: DiagnosisTask,
    final: SearchState,
    candidates: Sequence[Effect],
    progress: Progress = quiet,
) -> Choice | None:
    """The way that predicts best, or None where that is what the search found.

    There is something to choose where structure is left, or noise with memory that is larger than
    stated, what is left is slow, and the run recorded something that may drive it.

    Args:
        final: What was found, as it would be reported.
    """
    remembers, gross = task.memory is not None, final.base.gross
    noise = task.fit_found(final.effects, gross).noise.factor
    is_open = noise > POLICY.memory_loud_noise if remembers else bool(final.remains)
    if not is_open or not drives(task.run.touches):
        return None
    # ways are compared in white noise: a memory would absorb what they are to explain
    task = replace(task, memory=None)
    fit = task.fit_found(final.effects, gross)
    memory, gain = memory_of(fit)
    if gain < POLICY.memory_gain or memory.per_independent < POLICY.memory_touches:
        return None
    task = thinned(task, fit)
    fit = task.fit_found(final.effects, gross)
    groups = blocks(fit, memory_of(fit)[0])
    found = final.effects
    drift = likeliest_drift(final.named)
    drifts = final.drifts or ([drift[0]] if drift else [])
    ways: dict[str, Way] = {
        NOTHING: lambda _: (),
        FOUND: lambda _: found,
        UNRECORDED: lambda _: (*found, *drifts),
    }
    if {"thermal-lag", "thermal-static"} <= {e.kind for e in candidates}:
        ways[TWO_TIMES] = lambda part: bodies(part, gross)
    if (warm := next((e for e in candidates if traits(e).is_shrunk), None)) is not None:
        ways[FIELD] = lambda part: (sized_field(part, gross, warm, groups),)
    rules = []
    for done, (name, way) in enumerate(ways.items()):
        progress(done / len(ways), "choice by prediction")
        rules.append(_judged(name, way, task, gross, groups))
    best = clearly_best(rules[:3], lambda rule: rule.error)
    other = clearly_best(rules[3:] or rules[:1], lambda rule: rule.error)
    if other.error < POLICY.error_share_in_sight * best.error:
        best = other
    if best.name in (FOUND, UNRECORDED) or (best is rules[0] and not found):
        return None
    left = memory_of(task.fit_found(best.effects, gross))
    return Choice(
        rules=tuple(rules),
        best=best,
        blocks=len(groups),
        memory=left[0] if left[1] >= POLICY.memory_gain else None,
    )


def _judged(
    name: str,
    way: Way,
    task: DiagnosisTask,
    gross: GrossErrors,
    groups: Sequence[IntArray],
) -> ChoiceRule:
    """A way with its error of every block, predicted by what it leads to without that block."""
    errors = []
    for group in groups:
        part = without(task, group)
        errors.append(rms(part.fit_found(way(part), gross).residual[group]))
    return ChoiceRule(name, way(task), np.array(errors), np.array([len(g) for g in groups]))


def candidate_effects(touches: Touches, is_bare: bool = False) -> list[Effect]:
    """All effects that a diagnosis may find in a run: proposals of the library, field of drives.

    Args:
        is_bare: Whether the model has no geometry; then scale and low degrees of every axis that
            moved are missing, too.
    """
    warm = field(touches)
    curves = moved_components(touches) if is_bare else ()
    return [
        *proposals(touches),
        *([warm] if warm is not None else []),
        *(_low_degrees(touches.chain, symbol) for symbol in curves),
    ]


def _low_degrees(chain: Chain, symbol: Symbol) -> Effect:
    degree = 1 if chain.link(symbol.link).kind == "rotary" else 2
    return parse_effect(f"geometric({symbol.name},{degree})", chain)


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
