"""The diagnosis of a run: which effect the model lacks, how sure that is, what stays open."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.accuracy import promise, repeatability
from matstd.diagnosis.answer.alike import period_value
from matstd.diagnosis.answer.ambiguity import ConfusionClass
from matstd.diagnosis.answer.averaged import averaged
from matstd.diagnosis.answer.detectable import detectable
from matstd.diagnosis.answer.next_measurement import Plan, plan
from matstd.diagnosis.answer.parts import VerdictParts, verdict_parts
from matstd.diagnosis.answer.remainder import (
    dependences,
    nearest,
    structures,
    to_repeat,
)
from matstd.diagnosis.answer.reported_set import ReportedSet
from matstd.diagnosis.answer.steps import (
    Step,
    check_distinct,
    not_significant,
    significant_effects,
)
from matstd.diagnosis.answer.trend import (
    changing_since,
    possible_changes,
    shown_changes,
    trend,
)
from matstd.diagnosis.answer.verdict import Candidate, Diagnosis, Verdict
from matstd.diagnosis.choice import (
    candidate_effects,
    choice_remarks,
    chosen_by_prediction,
    field_shares,
    search_with_memory,
    with_chosen_set,
)
from matstd.diagnosis.evidence import Progress, RawColumns, ScaledEffect, quiet
from matstd.diagnosis.faults import description_faults
from matstd.diagnosis.fit import Fit, Prior, prior_for
from matstd.diagnosis.geometry import learnt_geometry
from matstd.diagnosis.next_visit import candidate_targets, candidate_touches
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.remarks import Remark, What, noticed, remarks
from matstd.diagnosis.residual import Structure, regions
from matstd.diagnosis.search import (
    MOST_SETS,
    DiagnosisTask,
    Search,
    SearchState,
    refined_named,
)
from matstd.twin.compute import one_blas_thread
from matstd.twin.fields import moved_components
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Effect, Model, traits
from matstd.twin.numbers import rms
from matstd.twin.record import Run, Touches, with_commanded, without_copies

MAX_LISTED = 25  # most candidates that are listed, best first
MAX_PERIODS_PLANNED = 8  # most periods that a plan of touches distinguishes, the longest ones


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


def plain_curves(touches: Touches) -> list[Effect]:
    """Scale and low degrees of every axis that moved, which a model without geometry lacks."""
    out = []
    for symbol in moved_components(touches):
        degree = 1 if touches.chain.link(symbol.link).kind == "rotary" else 2
        out.append(parse_effect(f"geometric({symbol.name},{degree})", touches.chain))
    return out


def _diagnosed(
    task: DiagnosisTask,
    named: Sequence[Effect],
    candidates: Sequence[Effect] | None,
    progress: Progress,
    rng: np.random.Generator | None,
) -> Diagnosis:
    """What a task lacks; arguments as of `diagnose`."""
    touches = task.run.touches
    library = candidate_effects(touches) if candidates is None else list(candidates)
    if candidates is None and not task.model.effects:
        library += plain_curves(touches)
    added = refined_named(task, named, progress)
    if len(added) > 1:
        check_distinct(task.space(task.fit()), added)
    known = {e.name for e in (*task.model.effects, *(a.effect for a in added))}
    library = [e for e in library if e.name not in known]
    single = [e for e in library if not traits(e).is_shrunk]
    task, final = search_with_memory(task, added, single, progress)
    if task.model.chain.joints:  # errors of their lines bend like effects that are missing
        task = task.suited((*added, *final.effects))
    progress(0.5, "what cannot be distinguished")
    tested, steps = significant_effects(task, added, final)
    choice = chosen_by_prediction(task, added, tested.state, library, progress)
    if choice is not None:
        task, final = with_chosen_set(task, added, tested.state, choice, single, progress)
        tested, steps = significant_effects(task, added, final)
    result = _result(task, added, tested, steps, progress, rng)
    if choice is None:
        return result
    fields = [e for e in result.found if traits(e).parameter_drives]
    added_remarks: tuple[Remark, ...] = (
        *choice_remarks(choice, result.found),
        *(field_shares(result.fit, e) for e in fields),
    )
    return replace(result, choice=choice, remarks=(*added_remarks, *result.remarks))


def _result(
    task: DiagnosisTask,
    added: tuple[ScaledEffect, ...],
    tested: ReportedSet,
    steps: tuple[Step, ...],
    progress: Progress,
    rng: np.random.Generator | None,
) -> Diagnosis:
    """The full report of the last round."""
    final, classes, gross = tested.state, tested.classes, tested.state.base.gross
    left = _beyond_doubt(final.remains, steps[-1].fit)
    last, predicting = steps[-1].fit, averaged(task, steps, added, classes, gross)
    # a residual well below the stated uncertainty is allowed for, whatever pattern it has
    scatter = float(np.std(last.residual[last.used] / last.run.u[last.used]))
    counted = () if scatter < POLICY.noise_ratio_covered else left
    repeats = repeatability(last)
    repeat = to_repeat(last, repeats)
    named = [s.effect for s in steps[1:] if s.effect is not None]
    faults = description_faults(steps[0].fit, progress, named, last)
    geometry = learnt_geometry(
        last, task.prior if task.is_known else None, steps[0].fit if len(steps) > 1 else None
    )
    parts = verdict_parts(steps, counted, geometry, faults, repeats, tested.against_drift)
    verdict = _verdict(parts, len(steps) > 1 + len(added), len(repeat) > 0)
    start = structures(final, progress)
    candidates, depends_on = (
        _candidates(final),
        dependences(left if parts.remains.is_real else start),
    )
    beside = (*added, *final.effects)
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
        promise=promise(predicting),
        promise_before=promise(steps[0].fit),
        candidates=candidates,
        structure=start,
        left=left,
        depends_on=depends_on,
        where=regions(steps[0].fit, last) if is_cured else regions(last),
        detectable=detectable(seen, final.effects, len(final.library.complement.u)),
        plans=_plans(task, added, classes, gross, rng),
        geometry=geometry,
        faults=faults,
        remarks=(*not_significant(steps), *remarks(last, steps[0].fit), *ended),
        nearest=nearest(task, beside, gross, last, candidates, depends_on, bool(final.drifts))
        if parts.remains.is_real
        else (),
        repeat=repeat if verdict is Verdict.UNDECIDED else repeat[:0],
    )


def _verdict(parts: VerdictParts, is_found: bool, is_doubtful: bool) -> Verdict:
    """The word of the file.

    Args:
        is_found: Whether the diagnosis itself added an effect.
        is_doubtful: Whether the noise would have to be incredibly large.
    """
    if parts.is_unexplained:
        return Verdict.UNEXPLAINED
    if is_found and parts.headline:
        return Verdict.MISSING
    return Verdict.UNDECIDED if is_doubtful or is_found else Verdict.NONE


def _beyond_doubt(left: Sequence[Structure], fit: Fit) -> tuple[Structure, ...]:
    """Patterns that stand however the noise remembers."""
    is_modelled = fit.memory is not None and fit.memory.is_filtered
    return tuple(s for s in left if not is_modelled or s.p_value < POLICY.p_beside_memory)


def _candidates(final: SearchState) -> tuple[Candidate, ...]:
    """Library effects by themselves, best first, with their held-out errors."""
    search = Search(final.pool)
    nothing = search.evaluate(())
    scores = search.scores(nothing)
    n = len(final.pool.complement.u)
    out = []
    for variant in search.ranking(nothing)[:MAX_LISTED]:
        member = search.member(nothing, variant)
        effects = search.evaluate((member,)).effects
        u = final.pool.complement.u
        out.append(
            Candidate(
                effect=member.effect.name,
                kind=member.effect.kind,
                p_value=search.corrected(member, float(scores.p[variant])),
                rms=rms(effects.residual[:n] * u),
                test_rms=rms(effects.held_out.error * u),
                log_odds=float(effects.evidence - nothing.effects.evidence),
            )
        )
    return tuple(out)


def _plans(
    task: DiagnosisTask,
    added: tuple[ScaledEffect, ...],
    classes: Sequence[ConfusionClass],
    gross: GrossErrors,
    rng: np.random.Generator | None,
) -> tuple[Plan, ...]:
    """For every found effect the touches that would distinguish it from its likeliest rival."""
    if rng is None:
        return ()
    heads = [c.sized for c in classes]
    out = []
    for i, confusion in enumerate(classes):

        def instead(rival: ScaledEffect, i: int = i) -> Fit:
            return task.fit((*added, *heads[:i], rival, *heads[i + 1 :]), gross)

        name, alike = heads[i].effect.name, confusion.alike
        if alike is not None:
            fits = [instead(other) for other in alike.others[:MAX_PERIODS_PLANNED]]
            periods = [f"{p:.4g}" for p in alike.periods[:MAX_PERIODS_PLANNED]]
            own = period_value(heads[i].effect)
            names = (f"{name}@{own:.4g}", f"{name}@{','.join(periods)}")
            offers = candidate_targets(task.run, alike.axis, rng)
            found = plan(instead(heads[i]), fits, names, offers)
            out += [replace(found, periods_of=name)] if found is not None else []
        # the likeliest rival may be inseparable by any offer; then the next one is tried
        for rival in confusion.rivals:
            offers = candidate_touches(task.run, rng)
            names = (name, rival.effect.name)
            found = plan(instead(heads[i]), [instead(rival.sized)], names, offers)
            if found is not None:
                out.append(found)
                break
    return tuple(out)
