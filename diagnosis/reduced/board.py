"""A run with effects to switch: what was found, what could have been, and the error of any set."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.diagnosis.answer import Comparison, Diagnosis
from matstd.diagnosis.choice import candidate_effects
from matstd.diagnosis.evidence import (
    EffectSet,
    ResidualSpace,
    ScaledEffect,
    ranked,
    scanned_grids,
    score_all,
    signatures,
)
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws import Learning
from matstd.diagnosis.reduced.base import Base
from matstd.diagnosis.reduced.matrices import Errors, Reduced, reduced
from matstd.diagnosis.reduced.switches import Switch, fixed, switch
from matstd.diagnosis.search import FOUND_PRIOR_FACTOR
from matstd.twin.compute import one_blas_thread
from matstd.twin.frames import Array
from matstd.twin.library import ordinary_model
from matstd.twin.model import Effect, traits

MOST_SWITCHES = 15  # effects on one board: found ones, their look-alikes, the best others
MOST_ALIKE = 3  # look-alikes of one found effect that are offered
MOST_OF_A_KIND = 3  # other effects of one kind: the next ones differ in the axis alone
MOST_PARAMETERS = 12  # parameters of an effect above which it is offered only where it was found

MOST_TOUCHES = 3000
"""Touches from which others are ranked by an even choice of them, at a few points of their grids
and without the many periods that waves may have."""

POINTS_OF_LONG_RUN = 3  # points of a grid, of a long run

MOST_COLUMNS, FEW_COLUMNS = 20, 8
"""Stored columns above which no further inner parameter is moved: their number counts squared; of a
long run."""


@dataclass(frozen=True, eq=False)
class Board:
    """A run, what is always refitted, and the effects that can be switched."""

    fit: Fit  # the fit whose gross errors, prior and memory of the noise hold throughout
    base: Base
    switches: tuple[Switch, ...]  # the effects, those found first
    estimate: Array  # of every stored column in `fit`, zero for others, (K,), in units of the prior
    # figures of the fits that were made, by the names of their effects: fitted and held out, mm
    known: Mapping[frozenset[str], tuple[float, float]]
    # the matrices of all stored columns; the last column is y less what `estimate` explains
    reduced: Reduced

    @property
    def found(self) -> frozenset[str]:
        """Names of the effects of the fit."""
        return frozenset(s.effect.name for s in self.switches if s.is_found)

    @cached_property
    def stored(self) -> Array:
        """All stored columns and the last one, all rows, (N, K + 1)."""
        A = np.hstack([s.columns for s in self.switches] or [np.zeros((len(self.base.y), 0))])
        return np.column_stack([A, self.base.y - A @ self.estimate])

    def errors(self, names: Iterable[str]) -> Errors:
        """Fitted and held-out error with a set of effects."""
        return self.reduced.errors(mix(self.switches, self.estimate, set(names)))

    def residuals(self, s: float) -> Array:
        """Residual of every stored column at a size of the noise, all rows, mm, (N, K + 1)."""
        return self.base.residuals(self.stored, s * self.fit.weight)


def mix(switches: Sequence[Switch], estimate: Array, on: Collection[str]) -> Array:
    """A set of effects as `Reduced.errors` takes it, (K + 1, k + 1)."""
    columns, last = np.eye(len(estimate) + 1), np.append(estimate, 1.0)
    first, places = 0, []
    for one in switches:
        own = [first + k for k in range(len(one.sd)) if one.effect.name in on]
        if one.is_fixed:
            last[own] -= 1.0
        else:
            places += own
        first += one.columns.shape[1]
    return np.column_stack([columns[:, places], last])


@one_blas_thread()
def diagnosed_board(result: Diagnosis) -> Board:
    """The board of a diagnosis: what was found, its look-alikes, the best others."""
    found = [step.effect for step in result.steps if step.effect is not None]
    alike: dict[str, list[ScaledEffect]] = {}
    for step in result.steps:
        if step.effect is not None and step.confusion is not None:
            alike[step.effect.name] = [r.sized for r in step.confusion.rivals[:MOST_ALIKE]]
    names = [*(o.effect for o in result.nearest), *(c.effect for c in result.candidates)]
    taken = {e.name for e in found} | {s.effect.name for a in alike.values() for s in a}
    by_name = {e.name: e for e in candidate_effects(result.run.touches)}
    library = [by_name[n] for n in dict.fromkeys(names) if n in by_name and n not in taken]
    known = {}
    on: set[str] = set()
    for step in result.steps:
        on |= {step.effect.name} if step.effect is not None else set()
        known[frozenset(on)] = (step.fit.rms, step.fit.test_rms)
    return _board(result.fit, found, alike, library, result.start, known)


@one_blas_thread()
def learnt_board(learning: Learning, found: Sequence[Effect] = ()) -> Board:
    """The board of laws that were learnt: they are on; others are effects with a cause.

    Args:
        found: Effects that a diagnosis found before; those in the model are switches, too.
    """
    fit, names = learning.after, {e.name for e in learning.after.model.effects}
    named = [e for e in fit.model.effects if e.name in {one.name for one in found}]
    laws: list[Effect] = [one.law for one in learning.laws]
    before = frozenset(e.name for e in named)
    known = {
        before: (learning.before.rms, learning.before.test_rms),
        before | {law.name for law in laws}: (fit.rms, fit.test_rms),
    }
    library = [e for e in candidate_effects(fit.run.touches) if e.name not in names]
    return _board(fit, [*named, *laws], {}, library, learning.before, known)


@one_blas_thread()
def compared_board(found: Comparison) -> Board:
    """The board of a comparison: effects of the model on; those that suit the residual best.

    What is not known beyond the domain of a law has no size, and is no switch.

    What a model predicts is no unknown of the run: such an effect is there, whole, or not.
    """
    fit = found.fit
    names = {e.name for e in fit.model.effects}
    geometry = {e.name for e in ordinary_model(fit.model.chain).effects}
    own = [e for e in fit.model.effects if e.name not in geometry and not traits(e).is_margin]
    library = [e for e in candidate_effects(found.run.touches) if e.name not in names]
    known = {frozenset(e.name for e in own): (fit.rms, fit.test_rms)}
    return _board(fit, own, {}, library, fit, known, found.is_prediction)


def _board(
    fit: Fit,
    found: Sequence[Effect],
    alike: Mapping[str, Sequence[ScaledEffect]],
    library: Sequence[Effect],
    start: Fit,
    known: Mapping[frozenset[str], tuple[float, float]],
    is_prediction: bool = False,
) -> Board:
    """Switches and matrices; `library` are other effects that may be offered, best first."""
    base = Base.of(fit, frozenset(e.name for e in found))
    switches: list[Switch] = []
    for effect in found:
        place = fit.of_effect(effect.name)
        if is_prediction:
            switches.append(fixed(base, effect, fit.prior.mean[place]))
            continue
        sd = np.sqrt(np.diag(fit.prior.root[place, place] @ fit.prior.root[place, place].T))
        names = [s.effect.name for s in alike.get(effect.name, ())]
        switches.append(switch(base, effect, sd, is_found=True, alike=names))
    if is_prediction:  # the base has nothing of them
        base = replace(base, y=base.y + sum(one.columns[:, 0] for one in switches))
    is_short = len(fit.run) <= MOST_TOUCHES
    others = [
        (s, (name, *(o.effect.name for o in group if o is not s)))
        for name, group in alike.items()
        for s in group
    ]
    others = others[: max(MOST_SWITCHES - len(switches), 0)]
    room = max(MOST_SWITCHES - len(switches) - len(others), 0)
    others += [(s, ()) for s in _best(ResidualSpace.of(start), library, room)]
    for sized, same in others:
        sd = np.array([p.sd for p in sized.effect.parameters]) * FOUND_PRIOR_FACTOR * sized.scale
        width = sum(s.columns.shape[1] for s in switches)
        is_movable = width < (MOST_COLUMNS if is_short else FEW_COLUMNS)
        made = switch(base, sized.effect, sd, is_found=False, alike=same, is_movable=is_movable)
        if np.isfinite(made.columns).all():
            switches.append(made)
    estimate = np.concatenate([_estimate(fit, s) for s in switches] or [np.zeros(0)])
    A = np.hstack([s.columns for s in switches] or [np.zeros((len(base.y), 0))])
    every = {s.effect.name for s in switches}
    sets = [mix(switches, estimate, on) for on in (set(), {e.name for e in found}, every)]
    return Board(
        fit=fit,
        base=base,
        switches=tuple(switches),
        estimate=estimate,
        known=known,
        reduced=reduced(base, np.column_stack([A, base.y - A @ estimate]), sets),
    )


def _estimate(fit: Fit, one: Switch) -> Array:
    """Of the stored columns of a switch, in units of the prior."""
    out = np.zeros(one.columns.shape[1])
    if one.is_fixed:
        out[0] = 1.0
    elif one.is_found:
        place = fit.of_effect(one.effect.name)
        out[: len(one.sd)] = fit.theta[place] / one.sd
    return out


def _best(space: ResidualSpace, library: Sequence[Effect], count: int) -> list[ScaledEffect]:
    """Effects that explain the residual of a fit best, each by itself, at the best of its grid."""
    offered = [
        e for e in library if not traits(e).is_shrunk and len(e.parameters) <= MOST_PARAMETERS
    ]
    if not offered or not count:
        return []
    is_long = len(space.u) > MOST_TOUCHES
    if is_long:
        space = space.thinned(MOST_TOUCHES)
        offered = [e for e in offered if traits(e).wave is None]
    grids = scanned_grids(offered, space)
    if is_long:
        grids = [
            replace(g, variants=g.variants[:: -(-len(g.variants) // POINTS_OF_LONG_RUN)])
            for g in grids
        ]
    pool = signatures(space, grids, len(offered))
    scores = score_all(EffectSet(space, np.zeros((len(space.residual), 0))), pool)
    out: list[ScaledEffect] = []
    kinds: dict[str, int] = {}
    for variant in pool.first_of_each(ranked(scores.evidence)):
        effect = pool.variants[variant]
        is_full = kinds.get(effect.kind, 0) >= MOST_OF_A_KIND
        if is_full or not np.isfinite(scores.evidence[variant]):
            continue
        kinds[effect.kind] = kinds.get(effect.kind, 0) + 1
        out.append(ScaledEffect(effect, float(scores.scale[variant])))
        if len(out) == count:
            break
    return out
