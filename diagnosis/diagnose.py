"""The diagnosis of a run: which effect the model lacks, how sure that is, what stays open."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.ambiguity import ConfusionClass, confusion_class
from diagnosis.candidates import (
    Complement,
    Progress,
    Signatures,
    Sized,
    projected,
    quiet,
    signatures,
)
from diagnosis.describe import reported
from diagnosis.detectable import detectable
from diagnosis.evidence import EffectSet
from diagnosis.fit import Fit, fit_run
from diagnosis.gross import GrossErrors
from diagnosis.next_measurement import Plan, plan
from diagnosis.prior import Prior
from diagnosis.refine import refined_set
from diagnosis.regions import regions
from diagnosis.remarks import remarks
from diagnosis.selection import LISTED, Chosen, Member, Search, Verified
from diagnosis.settle import settled
from diagnosis.structure import Structure, find_structure
from diagnosis.verdict import Candidate, Dependence, Diagnosis, Step, Verdict
from twin.effect import Effect
from twin.frames import Array
from twin.library import proposals
from twin.model import Model
from twin.ordinary import ordinary_model
from twin.run import Run

ROUNDS = 3
"""Most rounds of looking for gross errors and effects in turn."""

NAMELESS = 3
"""Most patterns without a name that are put beside the effects of an unexplained run."""

CLEARLY = 15.0
"""Log odds by which one pattern without a name must beat all library effects together to say that
they only imitate it."""

FREEDOM = 3.0
"""Factor on the prior of a found effect in its last fit: being found tells more of its size than
what is usual, and an estimate shall not be drawn to zero."""

DEPENDENCES = 2
"""Patterns, one after the other, of which `depends_on` tells."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What is diagnosed: a run, the model to begin with, and what is believed of it."""

    run: Run
    model: Model
    prior: Prior

    def fit(
        self,
        effects: Sequence[Sized] = (),
        gross: GrossErrors | None = None,
        free_inner: bool = False,
    ) -> Fit:
        """The model with further effects, fitted; twice where inner parameters are set free."""
        model = Model(self.model.chain, (*self.model.effects, *(s.effect for s in effects)))
        prior = self.prior
        for sized in effects:
            usual = Prior.of_effects([sized.effect])
            prior = prior.joined(usual.widened(FREEDOM * sized.scale))
        fit = fit_run(self.run, model, prior, gross=gross)
        if not free_inner or not effects:
            return fit
        theta = fit.theta[: len(model.parameters)]
        return fit_run(self.run, model, prior, free_inner=theta, gross=fit.gross)


@dataclass(frozen=True, slots=True, eq=False)
class _Round:
    """Search at given gross errors."""

    base: Fit
    pool: Signatures
    search: Search
    chosen: Chosen
    effects: tuple[Sized, ...]
    left: tuple[Structure, ...]
    nameless: tuple[Structure, ...]

    @property
    def fixed(self) -> Array | None:
        """Columns of the patterns without a name."""
        return self.search.fixed


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
        run: The measurements.
        model: To begin with; None for the ordinary geometric one.
        prior: Of its parameters, as from a model file; None for what its effects state.
        named: Effects that the user adds, whatever they are worth.
        candidates: Effects that may be found; None for all of the library that make sense here.
        progress: Called with the share done and what is being done.
        rng: Draws the offers of a plan for the next measurement; None makes no plan.

    Raises:
        NotEnoughData: So few touches that nothing can be said.

    Example:
        ``diagnose(read_run("run.csv")).verdict`` is one of three phrases.
    """
    start = model or ordinary_model(run.touches.chain)
    task = Task(run, start, prior or Prior.of_effects(start.effects))
    library = proposals(run.touches) if candidates is None else list(candidates)
    added = _tuned(task, named, progress)
    known = {e.name for e in (*start.effects, *(a.effect for a in added))}
    library = [e for e in library if e.name not in known]
    final = _rounds(task, added, library, progress)
    return _result(task, added, final, progress, rng)


def _tuned(task: Task, named: Sequence[Effect], progress: Progress) -> tuple[Sized, ...]:
    """Named effects with their inner parameters at the best point of their grids, refined."""
    if not named:
        return ()
    complement = Complement.of(task.fit())
    pool = signatures(complement, named, progress)
    search = Search(pool)
    chosen = search.chosen(())
    for _ in named:
        best = search.ranking(chosen)[0]
        chosen = search.chosen((*chosen.members, search.member(chosen, best)))
    ordered = sorted(search.polished(chosen).members, key=lambda m: m.candidate)
    return tuple(refined_set(complement, [Sized(m.effect, m.scale) for m in ordered]))


def _rounds(
    task: Task, added: tuple[Sized, ...], library: Sequence[Effect], progress: Progress
) -> _Round:
    """Gross errors and effects in turn, until the gross errors stay what they are."""
    base = task.fit(added)
    found: tuple[str, ...] = ()
    for _ in range(ROUNDS):
        result = _round(base, library, found, progress)
        again = task.fit((*added, *result.effects)).gross
        if np.array_equal(again.rows, base.gross.rows):
            break
        base, found = task.fit(added, gross=again), tuple(s.effect.name for s in result.effects)
    return result


def _round(
    base: Fit, library: Sequence[Effect], found: Sequence[str], progress: Progress
) -> _Round:
    """Search for effects, then for structure that they leave."""
    pool = signatures(Complement.of(base), library, progress)
    search = Search(pool, progress=progress)
    nothing = search.chosen(())
    ranked = search.ranking(nothing)
    start = [search.member(nothing, v) for v in ranked if pool.variants[v].name in found]
    search, chosen = settled(search, search.run(start))
    pool = search.pool
    left = find_structure(chosen.effects, progress)
    if not left and chosen.members:
        left = _beaten(find_structure(nothing.effects, progress), nothing, chosen)
    nameless: list[Structure] = []
    while any(s.columns is not None for s in left) and len(nameless) < NAMELESS:
        nameless.append(_strongest(left))
        fixed = np.hstack([s.columns for s in nameless if s.columns is not None])
        search = Search(pool, fixed, progress)
        chosen = search.run(chosen.members)
        left = find_structure(chosen.effects, progress)
    effects = refined_set(pool.complement, [Sized(m.effect, m.scale) for m in chosen.members])
    return _Round(base, pool, search, chosen, tuple(effects), tuple(left), tuple(nameless))


def _strongest(found: Sequence[Structure]) -> Structure:
    """The pattern with most evidence among those that have columns."""
    return max((s for s in found if s.columns is not None), key=lambda s: s.evidence)


def _beaten(at_start: Sequence[Structure], nothing: Chosen, chosen: Chosen) -> list[Structure]:
    """Patterns that explain the run clearly better than all found effects together."""
    gained = chosen.effects.evidence - nothing.effects.evidence
    return [s for s in at_start if s.columns is not None and s.evidence > gained + CLEARLY]


def _result(
    task: Task,
    added: tuple[Sized, ...],
    final: _Round,
    progress: Progress,
    rng: np.random.Generator | None,
) -> Diagnosis:
    """Everything that is told of the last round."""
    classes, verified = _classes(final), {v.member.effect.name: v for v in final_tests(final)}
    gross = final.base.gross
    progress(0.5, "what cannot be told apart")
    steps = _steps(task, added, final, classes, verified, gross)
    unexplained = bool(final.nameless or final.left)
    verdict = (
        Verdict.UNEXPLAINED
        if unexplained
        else Verdict.MISSING
        if len(steps) > 1 + len(added)
        else Verdict.NONE
    )
    start = _structures(Complement.of(task.fit(gross=gross)), progress)
    left = (*final.nameless, *final.left)
    progress(0.8, "what the run could have shown")
    effects = EffectSet(final.pool.complement, projected(final.pool.complement, final.effects))
    return Diagnosis(
        task.run,
        verdict,
        steps,
        _candidates(final),
        start,
        left,
        _dependences(left if unexplained else start),
        regions(steps[-1 if unexplained else 0].fit),
        detectable(effects, final.pool),
        _plans(task, added, classes, gross, rng),
        remarks(steps[-1].fit),
    )


def final_tests(final: _Round) -> list[Verified]:
    """Tests of the chosen members with one another in place."""
    return final.search.verify(final.chosen)


def _classes(final: _Round) -> list[ConfusionClass]:
    """Confusion class of every found effect, in the order found."""
    out = []
    for i, effect in enumerate(final.effects):
        others = final.effects[:i] + final.effects[i + 1 :]
        out.append(confusion_class(final.pool, effect, others, final.fixed))
    return out


def _steps(
    task: Task,
    added: tuple[Sized, ...],
    final: _Round,
    classes: Sequence[ConfusionClass],
    verified: dict[str, Verified],
    gross: GrossErrors,
) -> tuple[Step, ...]:
    """The error falling: the model to begin with, named effects, found effects by their worth."""
    p_values = [verified[m.effect.name].p_value for m in final.chosen.members]
    order = _by_worth(final)
    heads = [classes[i].sized for i in order]
    effects = [*added, *heads]
    last = task.fit(effects, gross, free_inner=True)
    out = [Step(None, task.fit((), gross), 1.0, (), None)]
    for k, sized in enumerate(effects):
        fit = last if k + 1 == len(effects) else task.fit(effects[: k + 1], gross)
        i = order[k - len(added)] if k >= len(added) else -1
        p = p_values[i] if i >= 0 else _named_probability(out[-1].fit, fit)
        confusion = classes[i] if i >= 0 else None
        out.append(Step(sized.effect, fit, p, reported(last, sized.effect), confusion))
    return tuple(out)


def _named_probability(before: Fit, after: Fit) -> float:
    """Probability by chance of the fall that an effect named by the user brings: no scan paid."""
    from diagnosis.evidence import f_probability

    k = max(after.solution.effective_parameters - before.solution.effective_parameters, 0.5)
    scale = (before.noise.factor / after.noise.factor) ** 2
    drop = before.solution.objective * scale - after.solution.objective
    return float(f_probability(drop, k, after.solution.objective, after.solution.dof))


def _by_worth(final: _Round) -> list[int]:
    """Order in which the found effects explain most, one after the other."""
    complement = final.pool.complement
    left = list(range(len(final.effects)))
    order: list[int] = []
    while left:

        def worth(i: int) -> float:
            A = projected(complement, [final.effects[j] for j in (*order, i)])
            return EffectSet(complement, A).evidence

        best = max(left, key=worth)
        order.append(best)
        left.remove(best)
    return order


def _candidates(final: _Round) -> tuple[Candidate, ...]:
    """Library effects by themselves, best first, with their held-out errors."""
    search = Search(final.pool)
    nothing = search.chosen(())
    scores = search.scores(nothing)
    n = len(final.pool.complement.u)
    out = []
    for variant in search.ranking(nothing)[:LISTED]:
        member = search.member(nothing, variant)
        effects = search.chosen((member,)).effects
        u = final.pool.complement.u
        out.append(
            Candidate(
                member.effect.name,
                member.effect.kind,
                search.corrected(member.candidate, float(scores.p[variant])),
                float(np.sqrt(np.mean((effects.residual[:n] * u) ** 2))),
                float(np.sqrt(np.mean((effects.held_out.standardised * u) ** 2))),
                float(effects.evidence - nothing.effects.evidence),
            )
        )
    return tuple(out)


def _structures(complement: Complement, progress: Progress) -> tuple[Structure, ...]:
    """What a residual varies with, one pattern after the other, each freed of those before."""
    out: list[Structure] = []
    A = np.zeros((len(complement.residual), 0))
    for _ in range(DEPENDENCES):
        found = find_structure(EffectSet(complement, A), progress)
        if not found:
            break
        if not any(s.columns is not None for s in found):
            return (*out, found[0])
        best = _strongest(found)
        out.append(best)
        if best.columns is not None:
            A = np.hstack([A, best.columns])
    return tuple(out)


def _dependences(found: Sequence[Structure]) -> tuple[Dependence, ...]:
    """Variables of some structures, each once, with the smallest probability."""
    out: dict[str, Dependence] = {}
    for structure in found:
        for variable in structure.variables:
            known = out.get(variable)
            if known is None or structure.p_value < known.p_value:
                out[variable] = Dependence(variable, structure.p_value, structure.words)
    return tuple(out.values())


def _plans(
    task: Task,
    added: tuple[Sized, ...],
    classes: Sequence[ConfusionClass],
    gross: GrossErrors,
    rng: np.random.Generator | None,
) -> tuple[Plan, ...]:
    """For every found effect the touches that would tell it from its likeliest distinct rival."""
    if rng is None:
        return ()
    heads = [c.sized for c in classes]
    out = []
    for i, confusion in enumerate(classes):
        for rival in confusion.rivals:
            instead = [*heads[:i], rival.sized, *heads[i + 1 :]]
            fits = [task.fit((*added, *effects), gross) for effects in (heads, instead)]
            found = plan(fits[0], fits[1], (heads[i].effect.name, rival.effect.name), rng)
            if found is not None:
                out.append(found)
                break
    return tuple(out)


__all__ = ["Member", "Task", "diagnose"]
