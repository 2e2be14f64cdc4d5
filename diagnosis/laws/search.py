"""One law: screened by curves, made a formula, refined, beside its rivals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.laws.curves import Curves
from matstd.diagnosis.laws.formulas import (
    Candidate,
    Part,
    candidate,
    columns_of,
    part_of,
    product_formulas,
    refined,
    scan,
    sharpened,
    single_formulas,
    spread,
)
from matstd.diagnosis.laws.policy import LawPolicy
from matstd.diagnosis.laws.screening import (
    PER_DRIVER,
    Field,
    Found,
    Grids,
    Scanned,
    by_evidence,
    curves_of,
    field_of,
    modulations,
    rough_grids,
    rough_shapes,
    surfaces_of,
)
from matstd.diagnosis.laws.smooth import curve_laws, surface_laws
from matstd.diagnosis.laws.space import Space
from matstd.twin.laws import SHAPES, WORDS, Driver, Factor, Law
from matstd.twin.record import Run, Touches

TOP_SINGLES, TOP_PAIRS, TOP_SQUARES = 14, 6, 2
"""Carriers with one variable, with two, and with one twice, for which formulas are looked for."""

SQUARES = 4  # products of two shapes of one variable that are refined

MIN_SHARE_SINGLE, MIN_SHARE_PAIR = 0.4, 0.6
"""Share of the best evidence of a curve from which a formula is looked for."""

MIN_GAIN_PAIR = 3.0  # log evidence that a second variable must add to a curve

HOPE_OF_PRODUCT = 0.5
"""Share of what a product of two shapes must gain, all charges included, that the curve of its
variables gains at least: where curves gained less than 9, no product on a grid gained 10 of 19."""

CLEAR_EVIDENCE = 5.0
"""Log evidence by which a formula of one shape is so much better than the curve that no product of
two shapes of that variable is looked for."""

UNUSUAL = ("power", "saturation", "dead-band", "pulse", "saw", "quad-about", "play-quad")
"""Shapes that are charged for being met seldom."""

DRIFT = "time"  # variable of an unrecorded driver, of which only smoothness in time is assumed
QUICK_PERIODS = 8.0  # periods within the range from which a sine is quick

ROUGH, MODULATED = 24, 2
"""Shapes of either kind that no curve shows, and those of which a second variable is looked for."""

REFINED, FAR = 24, 20.0
"""Candidates whose parameters are refined beside the best of every other variable, and the log
evidence by which one, or the curve of its carrier and variable, may be behind the best (or half of
it). No curve shows a loop: on the grid one was behind three temperatures, and 123 before them
between its points. Where a law is clear, points of a grid
lose more: a plateau gained 206 on the grid and 582 between its points, its curve 316."""

REFINING = 0.5
"""Share of what a candidate gains that refinement may add: of 200 candidates the most was 0.5 and
nine in ten gained less than 0.05. What could not be kept even so is not refined."""


MOST_UNSEEN = 3.0
"""Most that a product reaches where its variables have values that no touch had together, as a
multiple of its largest amount at a touch. Right laws reached 1.04 times, products for a late
temperature 2.2 times. Two exponentials that imitated a ridge across two axes reached 16 times, and
predicted a second run with 1.60 µm instead of 0.86 without a law."""

CORNER_PHASES = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
"""Phases of a wave with corners that are tried at the period of a sine."""

_Place = tuple[str, tuple[Driver, ...]]
"""Name of a carrier, with variables."""


@dataclass(frozen=True, eq=False)
class Searched:
    """What a search for one law found."""

    space: Space
    # laws with refined parameters, the best first; the first is the choice
    candidates: tuple[Candidate, ...]
    curve: float  # best log evidence of a law without a formula, charged as the candidates are
    # the same of a curve over time alone: a driver that is smooth and was not recorded
    drift: float
    smooth: tuple[Candidate, ...]  # laws without a formula, where the first candidate has one

    def with_first(self, smooth: Candidate, odds: float) -> "Searched":
        """The same with a law without a formula as the first choice.

        Candidates of a higher score follow it, the first of them by the log odds of a prediction.
        """
        behind = self.candidates[0].score - smooth.score + odds
        ranked = [
            replace(c, score=c.score - behind) if c.score > smooth.score else c
            for c in (*self.smooth, *self.candidates)
        ]
        ranked.sort(key=lambda c: -c.score)
        return replace(self, candidates=tuple(ranked), smooth=())


@dataclass(frozen=True, eq=False)
class Ground:
    """What all searches in one run share, whatever the model is and the rows that it uses."""

    field: Field  # carriers and variables
    grids: Grids  # columns of all shapes
    rough: list[Scanned]  # columns of shapes that no curve shows
    curves: Curves  # inner products of curves over every variable
    surfaces: Curves  # of surfaces over every two

    @classmethod
    def of(cls, run: Run) -> "Ground":
        """Of a run."""
        field = field_of(run.touches, run.u)
        return cls(field, Grids(field), rough_grids(field), curves_of(field), surfaces_of(field))


def search_law(space: Space, ground: Ground, policy: LawPolicy) -> Searched:
    """The laws that explain most of what a model leaves, beside one another."""
    grids = ground.grids
    field = grids.field
    one = by_evidence(space, ground.curves)
    has_products = policy.most_factors > 1
    least = MIN_SHARE_SINGLE * one[0].evidence
    two = by_evidence(space, ground.surfaces, least) if has_products else []
    found: list[Candidate] = []
    for f in _worth(one, two, MIN_SHARE_SINGLE, TOP_SINGLES):
        found += single_formulas(space, grids, f.bearer, f.drivers[0], 4)
    rough = _rough(space, ground)
    if has_products:
        found += [*_modulated(space, grids, rough), *_modulated(space, grids, found)]
    found += rough
    best = max((c.score for c in found), default=-np.inf)
    least = HOPE_OF_PRODUCT * (policy.tried_products + policy.min_score)
    if has_products and best < one[0].evidence + CLEAR_EVIDENCE:
        for f in _worth(one, two, MIN_SHARE_SINGLE, TOP_SQUARES, least):
            found += product_formulas(space, grids, f.bearer, (f.drivers[0], f.drivers[0]), SQUARES)
    for f in _worth(_gaining(two, one), one, MIN_SHARE_PAIR, TOP_PAIRS, least):
        found += product_formulas(space, grids, f.bearer, f.drivers, 6)
    scored = [(_charged(c, field, policy).score, c) for c in _distinct(found)]
    near = _promising(scored, {(f.bearer.carrier.name, f.drivers): f.evidence for f in one})
    hopeful = [c for score, c in near if score + REFINING * _gain(c, space) > policy.min_score]
    polished = [refined(space, field, c) for c in hopeful] or [c for _, c in near[:1]]
    polished += _beside_best(space, field, polished)
    polished = _at_best_places(space, field, polished)
    polished += _with_edges(space, field, polished)
    polished += _with_corners(space, field, polished)
    used = space.touches[space.used]
    polished = [_charged(c, field, policy) for c in _distinct(polished) if _is_seen(c.law, used)]
    drifts = [f for f in one if f.drivers[0].name == DRIFT][:1]
    beside = [f for f in drifts if all(f is not other for other in one[:3])]
    curves = curve_laws(space, field, [*one[:3], *beside], polished, policy)
    curves += surface_laws(space, field, _gaining(two, one), polished, policy)
    ranked, curves = (sorted(own, key=lambda c: -c.score) for own in (polished, curves))
    best_curve = curves[0].score if curves else -np.inf
    curves = _shorter_first(curves, policy)
    if not ranked or best_curve > ranked[0].score:
        ranked, curves = sorted([*curves, *ranked], key=lambda c: -c.score), []
    ranked = _shorter_first(ranked, policy)
    return Searched(
        space=space,
        candidates=tuple(ranked),
        curve=best_curve,
        smooth=tuple(curves),
        drift=drifts[0].evidence - policy.tried_singles if drifts else -np.inf,
    )


def _promising(
    scored: Sequence[tuple[float, Candidate]],
    curved: Mapping[tuple[str, tuple[Driver, ...]], float],
) -> list[tuple[float, Candidate]]:
    """Candidates that refinement may make the best, with their scores.

    The best hope comes first, and the best of every other set of variables after them.

    Between points of its grid the best formula of a carrier and a variable reaches about what the
    curve over them gains, and the others gain as much: a pulse over time lost 100 of 540 on the
    grid, and a plateau over a temperature that followed the time was taken for it.

    Args:
        scored: Candidates with their scores on the grid, charges taken off.
        curved: What the curve over a variable gains at a carrier.
    """
    best: dict[_Place, float] = {}
    for score, one in scored:
        key = _place(one)
        best[key] = max(best.get(key, score), score)
    lost = {key: max(curved.get(key, score) - score, 0.0) for key, score in best.items()}
    hoped = [(score + lost[_place(one)], score, one) for score, one in scored]
    hoped = sorted(hoped, key=lambda h: -h[0])
    near, others = hoped[:REFINED], sorted(hoped[REFINED:], key=lambda h: -h[1])
    shown = {one.law.drivers for *_, one in near}
    for other in others:
        if other[2].law.drivers not in shown:
            shown.add(other[2].law.drivers)
            near.append(other)
    top = max((score for score, _ in scored), default=0.0)
    least = min(0.5 * top, top - FAR)
    return [(score, one) for hope, score, one in near if hope > least]


def _place(one: Candidate) -> _Place:
    return one.bearer.carrier.name, one.law.drivers


def _at_best_places(space: Space, field: Field, found: Sequence[Candidate]) -> list[Candidate]:
    """Laws of one shape at the places of the best of them, where they are better there.

    The sum of squares of a saw-tooth or a window has many minima, and carriers are compared at the
    same one.
    """
    best = {one.law.factors: one for one in sorted(found, key=lambda c: c.score)}
    out = []
    for one in found:
        places = best[one.law.factors].law.places
        parts = [Part(f, places[own]) for f, own in one.law.parts]
        there = candidate(space, field, one.bearer, parts)
        out.append(one if one.score >= there.score else refined(space, field, there))
    return out


def _with_edges(space: Space, field: Field, found: Sequence[Candidate]) -> list[Candidate]:
    """The best law with edges for flanks, if it was not tried: a flank finds its place sooner."""
    best = max(found, key=lambda c: c.score, default=None)
    if best is None:
        return []
    parts = [sharpened(part_of(best.law, i)) for i in range(len(best.law.factors))]
    there = candidate(space, field, best.bearer, parts)
    is_tried = any(c.law.name == there.law.name for c in found)
    return [] if is_tried else [refined(space, field, there)]


def _with_corners(space: Space, field: Field, found: Sequence[Candidate]) -> list[Candidate]:
    """The best sine over a variable as a square wave and as a saw-tooth of its period.

    Both lose so much between the points of their grid that refinement misses the best place: the
    saw-tooth of a cooler, which gains 121, was taken for a square wave that gains 102.
    """
    sines = [c for c in found if [f.shape.word for f in c.law.factors] == ["sine"]]
    best = max(sines, key=lambda c: c.score, default=None)
    if best is None:
        return []
    ((factor, _),), (period,) = best.law.parts, best.law.places
    out = list[Candidate]()
    for word in ("square", "saw"):
        if word in WORDS[factor.driver.nature]:
            wave = Factor(SHAPES[word], factor.driver)
            parts = [Part(wave, (period, float(phase))) for phase in CORNER_PHASES]
            each = [candidate(space, field, best.bearer, [part]) for part in parts]
            out.append(refined(space, field, max(each, key=lambda c: c.score)))
    return out


def _is_seen(law: Law, touches: Touches) -> bool:
    """Whether touches show a law about as large as it may be within the ranges of its variables."""
    if len(law.drivers) < 2:
        return True
    first, second = (
        np.linalg.norm(f.shape.values(f.driver.values(touches), *law.places[own]), axis=0)
        for f, own in law.parts
    )
    return bool(first.max() * second.max() < MOST_UNSEEN * (first * second).max())


def _gain(one: Candidate, space: Space) -> float:
    """Log evidence of what a candidate explains, nothing charged."""
    return float(space.gained(np.array(one.explained)))


def _worth(
    found: Sequence[Found],
    beside: Sequence[Found],
    share: float,
    most: int,
    least: float = 0.0,
) -> list[Found]:
    """Those whose curve comes near the best of all, of every variable a few carriers."""
    top = max([f.evidence for f in (*found[:1], *beside[:1])], default=0.0)
    count: dict[tuple[str, ...], int] = {}
    out: list[Found] = []
    for f in found:
        names = tuple(d.name for d in f.drivers)
        if len(out) >= most or f.evidence < share * top or f.evidence <= least:
            break
        count[names] = count.get(names, 0) + 1
        if count[names] <= PER_DRIVER:
            out.append(f)
    return out


def _gaining(two: Sequence[Found], one: Sequence[Found]) -> list[Found]:
    """Pairs of variables that say more than either of the two at the same carrier."""
    alone = {(f.bearer.carrier.name, f.drivers[0].name): f.evidence for f in one}
    return [
        f
        for f in two
        if f.evidence > MIN_GAIN_PAIR + max(alone[f.bearer.carrier.name, d.name] for d in f.drivers)
    ]


def _rough(space: Space, ground: Ground) -> list[Candidate]:
    """Shapes that no curve shows."""
    field = ground.field
    return [
        candidate(space, field, r.bearer, [Part(Factor(SHAPES[r.word], r.driver), r.places)])
        for r in rough_shapes(space, field, ground.rough, ROUGH)
    ]


def _modulated(space: Space, grids: Grids, found: Sequence[Candidate]) -> list[Candidate]:
    """The best laws of one shape, with a size that depends on a second variable."""
    field, out = grids.field, list[Candidate]()
    for one in sorted(found, key=lambda c: -c.score)[:MODULATED]:
        part = part_of(one.law, 0)
        C = spread(one.bearer.C, columns_of(field, space, [part]))
        driver, gain = modulations(space, field, C, part.factor.driver)[0]
        if gain > MIN_GAIN_PAIR:
            ranked = sorted(
                scan(space, grids, C, driver),
                key=lambda s: space.charge(s[2]) - float(space.gained(np.array(s[1]))),
            )
            out += [
                candidate(space, field, one.bearer, [part, other]) for other, _, _ in ranked[:4]
            ]
    return out


def _beside_best(space: Space, field: Field, found: Sequence[Candidate]) -> list[Candidate]:
    """The best law at the carriers that come next, of which not each had its formulas.

    Of a product each factor alone besides: a saw-tooth over time was found only times an
    exponential that hardly changed.
    """
    best = max(found, key=lambda c: c.score, default=None)
    if best is None:
        return []
    parts = [part_of(best.law, i) for i in range(len(best.law.factors))]
    out = list[Candidate]()
    for own in (parts, *([part] for part in parts if len(parts) > 1)):
        others = [candidate(space, field, bearer, own) for bearer in field.bearers]
        out += sorted(others, key=lambda c: -c.score)[: PER_DRIVER + 1]
    return [refined(space, field, c) if c.score > best.score - FAR else c for c in out]


def _distinct(found: Sequence[Candidate]) -> list[Candidate]:
    """Every law once, at its best place."""
    return list({c.law.name: c for c in sorted(found, key=lambda c: c.score)}.values())


def _charged(one: Candidate, field: Field, policy: LawPolicy) -> Candidate:
    """The candidate with what trying so many costs."""
    charge = policy.tried_singles if len(one.law.factors) == 1 else policy.tried_products
    for factor in one.law.factors:
        is_corner = factor.shape.jumps or factor.shape.word == "ramp"
        if is_corner and factor.driver.nature == "level":
            charge += policy.switch_of_level
        if factor.shape.word in UNUSUAL:
            charge += policy.unusual
        if factor.shape.word == "hysteresis" and factor.driver.nature != "level":
            charge += policy.quick
        if factor.shape.word == "sine":
            period = one.law.tuning["period"]
            charge += policy.quick * (np.ptp(field.x[factor.driver.name]) > QUICK_PERIODS * period)
    return replace(one, score=one.score - float(charge))


def _shorter_first(ranked: Sequence[Candidate], policy: LawPolicy) -> list[Candidate]:
    """Of formulas that predict alike the one with fewest parameters comes first."""
    if not ranked:
        return []
    near = [c for c in ranked if c.score > ranked[0].score - policy.shorter]
    first = min(near, key=lambda c: (len(c.law.factors), c.parameters, -c.score))
    return [first, *(c for c in ranked if c is not first)]
