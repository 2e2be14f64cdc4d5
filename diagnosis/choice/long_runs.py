"""Long runs: searched in a choice of their rows first, then in all of them.

The cost of a search is rows times trials, and ten thousand rows show hardly more of which effects
there are than three thousand do. So the whole search, with everything that has to settle, is made
in an even choice of the rows. All rows then say what the choice was too small for: the memory of
the noise from row to row, inner parameters to the last digit, small effects beside large ones.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.choice.noise_memory import memory_beside, with_noise_memory
from matstd.diagnosis.evidence import Progress, ScaledEffect, quiet
from matstd.diagnosis.search import WHOLE_BELOW, DiagnosisTask, SearchState, search_until_stable
from matstd.twin.model import Effect
from matstd.twin.record import Run

CHOSEN_ROWS = 3000
"""Rows of the choice: a wave of an eighth of the noise is found in so many."""


def search_with_memory(
    task: DiagnosisTask,
    added: tuple[ScaledEffect, ...],
    candidates: Sequence[Effect],
    progress: Progress = quiet,
) -> tuple[DiagnosisTask, SearchState]:
    """The search's result, and the task with the memory found in the noise."""
    if len(task.run) <= WHOLE_BELOW:
        final = search_until_stable(task, added, candidates, progress)
        return with_noise_memory(task, added, final, candidates, progress)
    small = replace(task, run=chosen_rows(task.run))
    start = search_with_memory(small, added, candidates, progress)[1].effects
    whole = replace(task, memory=memory_beside(task, (*added, *start)))
    final = search_until_stable(whole, added, candidates, progress, start)
    return whole, final


def chosen_rows(run: Run) -> Run:
    """`CHOSEN_ROWS` rows of a run, one at random of every stretch: even steps alias short waves."""
    edges = np.linspace(0, len(run), CHOSEN_ROWS + 1).astype(np.int64)
    rows = np.random.default_rng(0).integers(edges[:-1], edges[1:])
    order = np.argsort(run.touches.time, kind="stable")
    return run[np.sort(order[rows])]
