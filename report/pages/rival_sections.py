"""Sections of a diagnosis on effects: tried, indistinguishable, detectable, to be measured."""

import math
from collections.abc import Sequence

from matstd.diagnosis.answer import Detectable, Diagnosis, Plan, Step, Verdict
from matstd.diagnosis.fit import file_unit
from matstd.report.effects import effect_title, plan_words
from matstd.report.layout import Picture, Section, Table
from matstd.report.numbers import digits, noun, odds_words, p_value, percent, unit_words
from matstd.report.plots import draw_candidates, draw_rivals
from matstd.report.style import series
from matstd.report.words import scanned_sentence, structure_words
from matstd.twin.files import reading_columns
from matstd.twin.library import kinds, parse_effect
from matstd.twin.model import Effect
from matstd.twin.units import UM
from matstd.twin.words import listed

NEXT = 3  # distinguished effects that are listed below those that are not
SAME = 0.1  # log odds below which a picture shows no difference between two effects
OPEN = 12  # rows up to which a table of rivals is unfolded
_PLANNED = 24  # touches of a plan that the page lists

_EVIDENCE = (
    "Evidence for single effects. It charges each effect for its freedom, so that a flexible "
    "effect must explain more. Coloured: found, or not distinguished from what was found."
)
_LIMITS = (
    "Smallest size of each effect that would be found in four of five such runs, all corrections "
    'included. "At most" is the largest deviation of a touch that an effect of this size causes.'
)


def named(effect: Effect) -> str:
    """`reversal of X`, with the name of the effect behind it."""
    title = effect_title(effect)
    return f"`{effect.name}`" if title == effect.name else f"{title} `{effect.name}`"


def tried_sections(result: Diagnosis) -> list[Section]:
    """Ways of choosing the effects, and every candidate by itself."""
    out = [_choice(result)]
    if not result.candidates:
        return [*out, Section(sentences=["No effect of the library applies to these touches."])]
    chain, count = result.run.touches.chain, len(result.detectable)
    table = Table.of(
        result.candidates,
        {
            "effect": lambda c: named(parse_effect(c.effect, chain)),
            "probability by chance": lambda c: p_value(c.p_value),
            "fitted, µm": lambda c: f"{c.rms / UM:.3f}",
            "held out, µm": lambda c: f"{c.test_rms / UM:.3f}",
            "log10 of the odds": lambda c: f"{c.log_odds / math.log(10.0):.1f}",
        },
    )
    words = f"{count} effects of the library apply to these touches. Each was added alone to the "
    picture = Picture("pictures/candidates.png", _EVIDENCE, draw_candidates(result))
    return [
        *out,
        Section(sentences=[f"{words}starting model:"], pictures=[picture]),
        Section(fold=f"The {len(table.rows)} best in numbers", table=table),
    ]


def _choice(result: Diagnosis) -> Section:
    """Ways of choosing a set of effects, tested by prediction."""
    title, choice = "Effects tried", result.choice
    if choice is None:
        return Section(title)
    words = (
        f"Ways of choosing the effects. Each was tested on {choice.blocks} blocks of touches, "
        "left out in turn; the choice was repeated without each block:"
    )
    table = Table.of(
        choice.rules,
        {
            "way": lambda r: r.name,
            "its choice from all touches": lambda r: (
                ", ".join(named(s.effect) for s in r.effects) or "none"
            ),
            "rms error of the blocks left out, µm": lambda r: f"{r.error / UM:.3f}",
        },
        is_best=lambda r: r is choice.best,
    )
    return Section(title, sentences=[words], table=table)


def rival_sections(result: Diagnosis) -> list[Section]:
    """For each effect that was found, those that explain the same touches."""
    title = "Indistinguishable effects"
    found = [(i, s) for i, s in enumerate(result.steps) if s.effect is not None and not s.is_named]
    if found:
        return [Section(title), *(one for i, step in found for one in _rivals(step, i))]
    words = (
        "Effects that were added by name are not compared with others."
        if len(result.steps) > 1
        else "No effect was found."
    )
    return [Section(title, sentences=[words])]


def _rivals(step: Step, i: int) -> list[Section]:
    assert step.effect is not None
    confusion = step.confusion
    alike = confusion.rivals if confusion else ()
    apart = confusion.distinguished if confusion else ()
    # signatures that coincide make a picture of nothing
    has_picture = any(abs(r.log_odds) >= SAME for r in (*alike, *apart))
    pictures = []
    if confusion is not None and has_picture:
        caption = f"Rivals of {effect_title(step.effect)}."
        drawn = draw_rivals(confusion, series(i - 1))
        pictures.append(Picture(f"pictures/rivals_{i}.png", caption, drawn))
    if not alike:
        return [Section(sentences=[_single(step)], pictures=pictures)]
    others = "one of these" if len(alike) > 1 else "this effect"
    why = "" if has_picture else ": their signatures coincide"
    words = (
        f"{named(step.effect)} may instead be {others}; the evidence against "
        f"{'them' if len(alike) > 1 else 'it'} is below 100 : 1{why}. The predictions for these "
        "touches are the same; those for other touches differ."
    )
    shown = [(r, "not distinguished") for r in alike]
    shown += [(r, "distinguished") for r in apart[:NEXT]]
    rows = [
        [named(r.effect), odds_words(r.log_odds), f"{100 * r.overlap:.1f} %", state]
        for r, state in shown
    ]
    return [
        Section(sentences=[words]),
        Section(
            fold=f"Evidence against the {len(rows)} rivals of {effect_title(step.effect)}",
            is_unfolded=len(rows) < OPEN,
            table=Table(("effect", "odds against it", "signature in common", ""), rows),
        ),
        Section(pictures=pictures),
    ]


def _single(step: Step) -> str:
    """An effect that no other one can replace."""
    assert step.effect is not None
    apart = step.confusion.distinguished if step.confusion else ()
    if not apart:
        return f"{named(step.effect)} has no rival."
    first = apart[0]
    words = f"{odds_words(first.log_odds)} ({named(first.effect)})"
    return f"{named(step.effect)} has no rival: the odds against the next effect are {words}."


def detection_sections(found: Sequence[Detectable]) -> list[Section]:
    """Smallest detectable sizes, by kind and by effect."""
    by_kind: dict[str, list[Detectable]] = {}
    for d in found:
        by_kind.setdefault(d.effect.kind, []).append(d)
    seen = {
        # as the column shows them: what differs by rounding keeps the order of the library
        kind: sorted((d for d in each if d.largest is not None), key=lambda d: float(_largest(d)))
        for kind, each in by_kind.items()
    }
    titles = {kind.word: kind.title for kind in kinds()}
    rows, every = [], []
    for kind in sorted(by_kind):
        hidden = [d for d in by_kind[kind] if d.largest is None]
        best, worst = seen[kind][:1], seen[kind][1:][-1:]
        title = f"{titles[kind]} `{kind}`" if titles[kind] else f"`{kind}`"
        count = str(len(hidden)) if hidden else ""
        rows.append([title, str(len(by_kind[kind])), *_ends(best), *_ends(worst), count])
        every += [[named(d.effect), _size(d), _largest(d), percent(d.survives)] for d in seen[kind]]
        every += [[named(d.effect), "never: the model can imitate it", "", ""] for d in hidden]
    sizes = "from,\nat most"
    columns = ("kind", "effects", "most visible", sizes, "least visible", sizes, "never visible")
    all_columns = ("effect", "smallest size", "largest deviation, µm")
    share = "share of its signature that the model cannot imitate"
    words = " ".join(filter(None, (_LIMITS, scanned_sentence(found))))
    return [
        Section("Detection limits of this run", sentences=[words], table=Table(columns, rows)),
        Section(fold="Every effect", table=Table((*all_columns, share), every)),
    ]


def _ends(found: Sequence[Detectable]) -> tuple[str, str]:
    """The first of some effects with its size and the deviation that it causes."""
    if not found:
        return "", ""
    return named(found[0].effect), f"{_size(found[0])}\n{_largest(found[0])} µm"


def _largest(d: Detectable) -> str:
    return digits((d.largest or 0.0) / UM, 2)


def _size(d: Detectable) -> str:
    suffix, factor = file_unit(d.unit)
    return f"{digits((d.size or 0.0) / factor, 2)} {unit_words(suffix)}"


def next_sections(result: Diagnosis) -> list[Section]:
    """Touches that would distinguish the effects that compete."""
    title = "Next measurement"
    if result.plans:
        plans = [_plan(plan, k) for k, plan in enumerate(result.plans, start=1)]
        return [Section(title), *(one for plan in plans for one in plan)]
    return [Section(title, sentences=[_without_plan(result)])]


def _without_plan(result: Diagnosis) -> str:
    """What to measure where no effects compete, or no touch distinguishes them."""
    steps = result.steps[1:]
    if result.withdrawn:
        return "Touches that would distinguish the learnt law from its rivals."
    if result.verdict is Verdict.UNDECIDED and not result.found:
        return "Repeat the touches that the verdict names."
    if result.verdict is Verdict.UNEXPLAINED and result.depends_on:
        found = result.depends_on[0].structure
        names = listed([noun(name) for name in found.variables])
        return (
            f"The residual {structure_words(found)}. Probe more touches that differ in {names}, "
            "with all other readings unchanged."
        )
    if any(s.confusion and s.confusion.rivals for s in steps):
        return "No touch at the points and poses of this run would distinguish the rivals."
    if steps:
        return "The effects found have no rivals; no further touches are needed."
    return (
        "No effect was found; no further touches are needed. The detection limits above state "
        "what this run could not show."
    )


def _plan(plan: Plan, number: int) -> list[Section]:
    """A plan: where the axes go, and what is touched."""
    touches = plan.touches
    columns = reading_columns(touches.chain)
    axes = list(touches.chain.programmed_axes)
    rows = []
    for i in range(min(len(touches), _PLANNED)):
        cells = [f"{touches.reading(axis)[i] / columns[axis][1]:.3f}" for axis in axes]
        where = [str(touches.feature[i]), touches.setups[touches.setup[i]].name]
        rows.append([*where, *cells, *(f"{v:.3f}" for v in touches.point[i])])
    head = ["feature", "set-up", *(columns[a][0] for a in axes), "px_mm", "py_mm", "pz_mm"]
    words = (
        f"These {len(rows)} touches would distinguish {plan_words(plan)}. The expected difference "
        f"is {digits(plan.separation, 2)} standard deviations. The touches are in "
        f"`next_measurement_{number}.csv`, with the columns of a run file."
    )
    return [Section(sentences=[words]), Section(fold="The touches", table=Table(head, rows))]
