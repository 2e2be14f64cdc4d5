"""The way that predicts best, applied to all rows: the judged set is the set reported and saved."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import stdtr

from matstd.diagnosis.choice.noise_memory import max_noise
from matstd.diagnosis.choice.prediction import Choice
from matstd.diagnosis.evidence import EffectSet, Progress, ScaledEffect, projected, quiet
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import Memory
from matstd.diagnosis.remarks import Noticed, Remark, What, noticed
from matstd.diagnosis.residual import PatternTests, find_structure
from matstd.diagnosis.search import DiagnosisTask, Library, Search, SearchState
from matstd.twin.model import Effect, columns, traits

MAX_LISTED_DRIVES = 6  # most drives of a field that are reported

MIN_INDEPENDENT = 30.0
"""Least number of independent observations assumed for a run with a slow residual. A memory as long
as the run cannot be estimated from it."""


def with_chosen_set(
    task: DiagnosisTask,
    final: SearchState,
    choice: Choice,
    candidates: Sequence[Effect],
    progress: Progress = quiet,
) -> tuple[DiagnosisTask, SearchState]:
    """The task with rows that count as independent observations, and the chosen set in it."""
    gross, best = final.base.gross, choice.best
    task = replace(task, memory=None)
    plain = task.fit_found(best.effects, gross)
    task = replace(task, memory=_slow(choice.memory, int(plain.used.sum())))
    base = task.fit_found((), gross)
    # rows count for less, so a prior that was chosen beside whole rows must be wider by as much
    effects = tuple(_wider(s, base.weight) for s in best.effects)
    complement = task.space(base)
    library = Library.of(complement, candidates, progress)
    shortlist = library.shortlist(effects, EffectSet(complement, projected(complement, effects)))
    search = Search(library.pool(shortlist), None, progress)
    chosen = search.evaluate(map(search.placed, effects))
    smooth = PatternTests(complement)
    left = find_structure(chosen.effects, progress, smooth)
    if not left and plain.noise.factor > max_noise(best.effects):
        left = list(final.left or final.nameless)
    shrunk = {s.effect.name: _chance(choice) for s in effects if _is_shrunk(s)}
    nothing = find_structure(search.evaluate(()).effects, progress, smooth)
    return task, SearchState(
        base=base,
        library=library,
        search=search,
        chosen=chosen,
        smooth=smooth,
        at_start=tuple(nothing) or final.at_start,
        left=tuple(left),
        nameless=(),
        chances=shrunk,
        is_weighed=True,
        is_ended=final.is_ended,
    )


def _slow(memory: Memory | None, rows: int) -> Memory | None:
    """A memory by which rows count, not by which they are filtered."""
    if memory is None:
        return None
    most = max(rows / MIN_INDEPENDENT, 1.0)
    correlation = min(memory.correlation, (most - 1.0) / (most + 1.0))
    return replace(memory, correlation=correlation, is_filtered=False) if correlation > 0 else None


def _is_shrunk(sized: ScaledEffect) -> bool:
    return traits(sized.effect).is_shrunk


def _wider(sized: ScaledEffect, weight: float) -> ScaledEffect:
    return replace(sized, scale=sized.scale * weight) if _is_shrunk(sized) else sized


def _chance(choice: Choice) -> float:
    """Probability by chance that left-out blocks are predicted so much better than by nothing.

    Student's test of the logarithms of the errors, block by block: of few blocks it can never be
    small, and that is honest.
    """
    gain = np.log(choice.nothing.errors / choice.best.errors)
    count = len(gain)
    return float(stdtr(count - 1, -gain.mean() / (gain.std(ddof=1) / np.sqrt(count))))


def choice_remarks(choice: Choice | None, fit: Fit) -> tuple[Remark, ...]:
    """Every way of a choice with its plain error of blocks left out, and the drives of a field.

    Args:
        fit: With what the choice led to.
    """
    if choice is None:
        return ()
    names = {s.effect.name for s in choice.best.effects}
    found = [e for e in fit.model.effects if e.name in names]
    chosen = noticed(
        What.CHOSEN_BY_PREDICTION,
        chosen=choice.best.name,
        blocks=choice.blocks,
        tried=tuple((rule.name, rule.error) for rule in choice.rules),
        is_empty=not found,
    )
    return (chosen, *(_field_shares(fit, e) for e in found if traits(e).parameter_drives))


def _field_shares(fit: Fit, effect: Effect) -> Noticed:
    """What every drive of a field explains of the deviations, the most first."""
    theta = fit.theta[fit.of_effect(effect.name)]
    C = columns([effect], fit.run.touches)[fit.used] * theta
    own = traits(effect)
    places = np.array(own.parameter_drives)
    drives = dict.fromkeys(own.parameter_drives)
    sizes = {d: float(np.std(C[:, places == d].sum(axis=1))) for d in drives}
    ranked = sorted(sizes.items(), key=lambda item: -item[1])
    return noticed(What.FIELD_SHARES, axis=own.axis, sizes=tuple(ranked[:MAX_LISTED_DRIVES]))
