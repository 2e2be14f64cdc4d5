"""The diagnosis of a run: which effect the model lacks, how sure that is, what stays open.

One way through, from top to bottom; every step takes what the one before it gives.

1. **Offer.** Effects of the library that act at these touches, less those of the model and those
   that the user added; what the user added is in every set (`_offered`).
2. **Search** (`search`). One projection of all signatures on what the geometric model leaves. Sets
   grow, exchange and lose members while the evidence rises, and a set stands only if every member
   does. Gross errors and set settle in turns; patterns without a name stand beside the names. Where
   what is left is noise that remembers, the search is made once more beside it (`choice`).
3. **Report** (`reported_set`, `steps`). Of effects that the run cannot distinguish the likeliest is
   named. Sizes rest on the touches alone. A name falls whose size is within its uncertainty, which
   no body can have, or which the run does not decide between sensors; the weakest goes first, and
   what is left is reported anew.
4. **Choose** (`choice`). Where something slow is left that a recorded drive may cause, whole ways
   to explain the run compete: block after block is left out and predicted. A way that predicts far
   better gives the set, which is reported by the same step 3.
5. **Predict** (`averaged`). Members of a class that act differently elsewhere share what they
   explain.
6. **Judge** (`parts`). Geometry, names and remainder, each with its size; the verdict is one word
   of the three.
7. **Look around.** What this run could have shown, where the model fails, what is nearest to the
   remainder, mistakes of the description, touches that would decide, remarks.

Of several runs the geometry may be another in every one. Once the effects are known, runs between
which nothing changed share it, and the diagnosis is made anew (`trend`). Every threshold is in
`Policy`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.accuracy import promise, repeatability
from matstd.diagnosis.answer.averaged import averaged
from matstd.diagnosis.answer.candidates import ranked_candidates
from matstd.diagnosis.answer.detectable import detectable
from matstd.diagnosis.answer.next_measurement import plans
from matstd.diagnosis.answer.parts import verdict_parts
from matstd.diagnosis.answer.remainder import (
    beyond_doubt,
    dependences,
    nearest,
    structures,
    to_repeat,
)
from matstd.diagnosis.answer.reported_set import ReportedSet
from matstd.diagnosis.answer.steps import Step, check_distinct, not_significant, significant_effects
from matstd.diagnosis.answer.trend import changing_since, possible_changes, shown_changes, trend
from matstd.diagnosis.answer.verdict import Diagnosis, Verdict, verdict_of
from matstd.diagnosis.choice import (
    Choice,
    candidate_effects,
    choice_remarks,
    chosen_by_prediction,
    search_with_memory,
    with_chosen_set,
)
from matstd.diagnosis.evidence import Progress, RawColumns, quiet
from matstd.diagnosis.faults import description_faults
from matstd.diagnosis.fit import Prior, evidence_of, prior_for
from matstd.diagnosis.geometry import learnt_geometry
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.remarks import What, noticed, remarks
from matstd.diagnosis.residual import regions
from matstd.diagnosis.search import MOST_SETS, DiagnosisTask, SearchState, refined_named
from matstd.twin.compute import one_blas_thread
from matstd.twin.library import ordinary_model
from matstd.twin.model import Effect, Model, traits
from matstd.twin.record import Run, with_commanded, without_copies

MAX_SUITED = 3
"""Most searches with a wider prior; none is needed where no error was drawn to zero."""


@one_blas_thread()
def diagnose(
    run: Run,
    model: Model | None = None,
    prior: Prior | None = None,
    named: Sequence[Effect] = (),
    candidates: Sequence[Effect] | None = None,
    progress: Progress = quiet,
    rng: np.random.Generator | None = None,
) -> Diagnosis:
    """Find what a model lacks.

    Args:
        model: Starting model; None for the ordinary geometric one.
        prior: Of its parameters, as from a model file; None for what its effects state.
        named: Effects that the user adds, whatever they are worth.
        candidates: Effects that may be found; None for all of the library that make sense here.
        progress: Called with the share done and what is being done.
        rng: Draws the offers of a plan for the next measurement; None makes no plan.

    Raises:
        NotEnoughData: So few touches that nothing can be said.
        DesignError: Named effects that these touches cannot distinguish.

    Example:
        ``diagnose(read_run("run.csv")).verdict`` is one of four phrases.
    """
    run = with_commanded(without_copies(run))
    start = model or ordinary_model(run.touches.chain)
    belief = prior_for(run, start) if prior is None else prior
    raw = RawColumns(run.touches)
    task = DiagnosisTask(run, start, belief, is_known=prior is not None, raw=raw)
    possible = possible_changes(task)
    free = _diagnosed(changing_since(task, possible), named, candidates, progress, rng)
    shown, alone = shown_changes(task, free, possible)
    if shown != possible:  # what does not change is learnt from all runs
        task = changing_since(task, shown)
        free = _diagnosed(task, named, candidates, progress, rng)
    return replace(free, trend=trend(free.fit, shown, alone))


def _diagnosed(
    task: DiagnosisTask,
    named: Sequence[Effect],
    candidates: Sequence[Effect] | None,
    progress: Progress,
    rng: np.random.Generator | None,
) -> Diagnosis:
    """What a task lacks; arguments as of `diagnose`."""
    task, library = _offered(task, named, candidates, progress)
    single = [e for e in library if not traits(e).is_shrunk]
    task, final = _searched(replace(task, prior=task.suited(()).prior), single, progress)
    progress(0.5, "what cannot be distinguished")
    tested, steps = significant_effects(task, final)
    choice = chosen_by_prediction(task, tested.state, library, progress)
    if choice is not None:
        task, final = with_chosen_set(task, tested.state, choice, single, progress)
        tested, steps = significant_effects(task, final)
    return _result(task, tested, steps, choice, progress, rng)


def _searched(
    task: DiagnosisTask, single: Sequence[Effect], progress: Progress
) -> tuple[DiagnosisTask, SearchState]:
    """The search's result with a prior that suits the machine beside what was found.

    A missing effect passes for noise, beside which errors of the machine a sixteenth of what is
    expected may be likeliest. Once the effect is there, they are drawn to zero, and what is left of
    them looks like further effects. So the search is made again with the prior that suits beside
    the clearest effect, or the clearest two and so on, where that is wider. Its result stands
    unless the run is clearly likelier with the one before.
    """
    found, final = search_with_memory(task, single, progress)
    for _ in range(MAX_SUITED):
        clearest = final.search.verify(final.chosen)
        clearest.sort(key=lambda member: member.evidence, reverse=True)
        sets = ([v.member.sized for v in clearest[: k + 1]] for k in range(len(clearest)))
        priors = (found.suited(effects).prior for effects in sets)
        wider = next((p for p in priors if np.any(p.factor > found.prior.factor)), None)
        if wider is None:
            break
        task = replace(task, prior=task.prior.at_least(wider))
        again = search_with_memory(task, single, progress)
        gross = final.base.gross
        before, after = (_evidence(t, s, gross) for t, s in ((found, final), again))
        if before > after + POLICY.log_evidence_gain:
            break
        found, final = again
    # errors of the lines of joints bend like effects that are missing
    return found.suited(final.effects) if task.model.chain.joints else found, final


def _evidence(task: DiagnosisTask, state: SearchState, gross: GrossErrors) -> float:
    """Log evidence of the run with the effects that a search found, at given gross errors."""
    fit = task.fit_found(state.effects, gross)
    return evidence_of(fit.X[fit.used], fit.y[fit.used])


def _offered(
    task: DiagnosisTask,
    named: Sequence[Effect],
    candidates: Sequence[Effect] | None,
    progress: Progress,
) -> tuple[DiagnosisTask, list[Effect]]:
    """The task with what the user adds, and what may be found beside that and the model."""
    added = refined_named(task, named, progress)
    if len(added) > 1:
        check_distinct(task.space(task.fit()), added)
    if candidates is None:
        candidates = candidate_effects(task.run.touches, is_bare=not task.model.effects)
    known = {e.name for e in (*task.model.effects, *(a.effect for a in added))}
    return replace(task, added=added), [e for e in candidates if e.name not in known]


def _result(
    task: DiagnosisTask,
    tested: ReportedSet,
    steps: tuple[Step, ...],
    choice: Choice | None,
    progress: Progress,
    rng: np.random.Generator | None,
) -> Diagnosis:
    """The full report of the last round."""
    final, classes, gross = tested.state, tested.classes, tested.state.base.gross
    last, predicting = steps[-1].fit, averaged(task, steps, classes, gross)
    left = beyond_doubt(final.remains, last)
    repeats = repeatability(last)
    repeat = to_repeat(last, repeats)
    named = [s.effect for s in steps[1:] if s.effect is not None]
    faults = description_faults(steps[0].fit, progress, named, last)
    geometry = learnt_geometry(
        last, task.prior if task.is_known else None, steps[0].fit if len(steps) > 1 else None
    )
    parts = verdict_parts(steps, left, geometry, faults, repeats, tested.against_drift)
    verdict = verdict_of(parts, len(steps) > 1 + len(task.added), len(repeat) > 0)
    start = structures(final, progress)
    candidates = ranked_candidates(final)
    depends_on = dependences(left if parts.remains.is_real else start)
    beside = (*task.added, *final.effects)
    known = {grid.effect.name: grid.effect for grid in final.library.grids}
    progress(0.8, "what the run could have shown")
    seen = final.library.sample
    is_cured = verdict is not Verdict.UNEXPLAINED and len(steps) > 1
    ended = (noticed(What.SEARCH_ENDED, sets=MOST_SETS),) if final.is_ended else ()
    return Diagnosis(
        run=task.run,
        verdict=verdict,
        steps=steps,
        parts=parts,
        predicting=predicting,
        promise=promise(predicting, choice.best.error if choice else None),
        promise_before=promise(steps[0].fit, choice.nothing.error if choice else None),
        candidates=candidates,
        structure=start,
        left=left,
        depends_on=depends_on,
        where=regions(steps[0].fit, last) if is_cured else regions(last),
        detectable=detectable(seen, final.effects, len(final.library.complement.u)),
        plans=plans(task, classes, gross, rng),
        geometry=geometry,
        faults=faults,
        remarks=(
            *choice_remarks(choice, last),
            *not_significant(steps),
            *remarks(last, steps[0].fit),
            *ended,
        ),
        choice=choice,
        nearest=nearest(
            task, beside, gross, last, candidates, known, depends_on, bool(final.drifts)
        )
        if parts.remains.is_real
        else (),
        repeat=repeat if verdict is Verdict.UNDECIDED else repeat[:0],
    )
