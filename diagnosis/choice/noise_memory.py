"""Is what is left noise that remembers? Then the search is done again with that noise.

A residual that wanders from touch to touch looks like structure in time to every test made for
white noise. It is called noise with memory only where that explains the run better than effects and
patterns in white noise do, where the run holds many times its memory, and where it is not much
larger than what is stated; else it is a cause without a name yet.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.evidence import Progress, RawColumns, ScaledEffect, quiet
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws import memory_score
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors, Memory, likely_memory
from matstd.diagnosis.search import WHOLE_BELOW, DiagnosisTask, SearchState, searched
from matstd.twin.model import Effect, inner_values
from matstd.twin.record import Run

CHOSEN_ROWS = 3000  # rows of the choice: a wave of an eighth of the noise is found in so many


def memory_of(fit: Fit) -> tuple[Memory, float]:
    """Memory of what a fit in white noise leaves, and its gain of log likelihood over none."""
    return likely_memory(fit.run.touches, fit.u, fit.used, fit.X, fit.y)


def is_noise(memory: Memory, rows: int) -> bool:
    """Whether a run of so many rows holds enough of a memory to call it one of the noise."""
    return rows >= POLICY.memory_independent * memory.per_independent


def memory_beside(
    task: DiagnosisTask, effects: Sequence[ScaledEffect], gross: GrossErrors | None = None
) -> Memory | None:
    """Memory of the noise beside found effects; None where the run does not determine one."""
    fit = replace(task, memory=None).fit_found(effects, gross)
    memory, gain = memory_of(fit)
    is_determined = gain >= POLICY.memory_gain and is_noise(memory, int(fit.used.sum()))
    return memory if is_determined and fit.noise.factor <= POLICY.memory_noise else None


def max_noise(effects: Sequence[ScaledEffect]) -> float:
    """Largest noise over stated noise that counts as noise beside the found effects."""
    return POLICY.memory_noise if effects else POLICY.memory_noise_alone


def _evidence(final: SearchState) -> float:
    """Log evidence of a run with everything that was put in, whatever its noise."""
    base, chosen = final.base, final.chosen.effects
    rows = int(base.used.sum())
    whole = chosen.evidence - rows * float(np.log(base.noise.factor))
    whole -= float(np.log(np.abs(np.diag(base.solution.R))).sum())
    return whole + (0.0 if base.whitener is None else base.whitener.log_det)


def search_with_memory(
    task: DiagnosisTask,
    candidates: Sequence[Effect],
    progress: Progress = quiet,
) -> tuple[DiagnosisTask, SearchState]:
    """The search's result, and the task with the memory found in the noise.

    A run of ordinary length is searched in white noise, and once more beside the memory that this
    search leaves, if it leaves one: the likelier result stands. A long run is searched once, beside
    the memory that such a search of a choice of its rows leaves.
    """
    if len(task.run) > WHOLE_BELOW:
        run = chosen_rows(task.run)
        small = replace(task, run=run, raw=RawColumns(run.touches))
        start = search_with_memory(small, candidates, progress)[1].effects
        task = replace(task, memory=memory_beside(task, start))
        return task, searched(task, candidates, progress, start)
    final = searched(task, candidates, progress)
    if (name := _wandering(task, final)) is not None:
        others = [effect for effect in candidates if effect.name != name]
        return search_with_memory(task, others, progress)
    memory = memory_beside(task, final.effects, final.base.gross)
    if memory is not None:
        beside = replace(task, memory=memory)
        found = searched(beside, candidates, progress)
        is_noise = found.base.noise.factor <= max_noise(found.effects)
        if is_noise and _evidence(found) > _evidence(final):
            return beside, found
    return task, final


def _wandering(task: DiagnosisTask, final: SearchState) -> str | None:
    """Name of a found effect that begins at an instant where a memory explains about as much.

    Noise that wanders is elsewhere after almost any instant. The memory is charged as beside a law,
    the effect for its instants.
    """
    for member in final.chosen.members:
        inner = [i for i, _ in inner_values(member.effect, task.run.touches)]
        instants = [len(i.grid) for i in inner if i.acts == "at an instant"]
        if not instants:
            continue
        others = final.search.evaluate(final.chosen.others(member))
        gained = final.chosen.effects.evidence - others.effects.evidence
        fit = task.fit_found(others.sized, final.base.gross)
        if gained - float(np.log(instants).sum()) < memory_score(fit) + POLICY.log_odds_alike:
            return member.effect.name
    return None


def chosen_rows(run: Run) -> Run:
    """`CHOSEN_ROWS` rows of a run, one at random of every stretch: even steps alias short waves."""
    edges = np.linspace(0, len(run), CHOSEN_ROWS + 1).astype(np.int64)
    rows = np.random.default_rng(0).integers(edges[:-1], edges[1:])
    order = np.argsort(run.touches.time, kind="stable")
    return run[np.sort(order[rows])]
