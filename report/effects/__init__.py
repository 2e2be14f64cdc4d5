"""Titles of effects in the words of the workshop, followed by their names in brackets.

An effect that the run cannot distinguish from others is reported as a class: the common title, the
bodies that may carry it, the alternatives, and the names.
"""

from collections.abc import Sequence
from functools import partial

from matstd.diagnosis.answer import Doubt, Plan, Step
from matstd.diagnosis.policy import POLICY
from matstd.report.numbers import percent
from matstd.twin.library import parse_effect, title_of
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, Title, is_tunable
from matstd.twin.words import few

_MAX_WRITTEN_OUT = 4  # bodies, titles or names that are written out; of more, the first ones

_few = partial(few, most=_MAX_WRITTEN_OUT, last="or")

_BODIES = {"t": "the tool", "w": "the workpiece", "standard": "the standard", "probe": "the probe"}

DOUBTS = {
    Doubt.CHANCE: "not certain by itself",
    Doubt.UNCERTAIN: f"less than {POLICY.significant_ratio:g} times its uncertainty",
    Doubt.SMALL: f"less than {percent(POLICY.headline_noise_share)} of the stated noise",
}
"""What an effect is that stands in no headline."""


def effect_title(effect: Effect) -> str:
    """`reversal of X`, `growth along Z after switching on, carried by B`."""
    return _whole(title_of(effect))


def effect_words(effect: Effect) -> str:
    """`reversal of X [backlash(X)]`."""
    title = effect_title(effect)
    return " ".join([title, _bracket([effect], title)]).rstrip()


def words_of_name(name: str, chain: Chain) -> str:
    """The same of a name that stands in a file.

    Raises:
        UnknownEffect, UnknownAxis, UnknownSymbol: It is no name of an effect of this machine.
    """
    return effect_words(parse_effect(name, chain))


def effect_cell(step: Step) -> tuple[str, str]:
    """An added effect in a table: the title of its class, and its name."""
    effects = _members(step)
    text, bodies, _ = _class(effects)
    alone = effect_title(effects[0])
    return text if len(bodies) > 1 else alone, _bracket(effects, alone)


def class_words(step: Step, clauses: Sequence[str] = ()) -> str:
    """An effect in a sentence: `growth along Z after switching on (clauses; ...) [...]`."""
    effects = _members(step)
    text, bodies, others = _class(effects)
    alone = effect_title(effects[0])
    every = list(clauses)
    if len(bodies) > 1:
        every.append(f"carried by {_few(bodies)}, which this run cannot distinguish")
    if others:
        every.append(f"or instead {_few(others)}")
    title = text if len(bodies) > 1 else alone
    bracket = _bracket(effects, alone)
    return " ".join([title, *([f"({'; '.join(every)})"] if every else []), bracket]).rstrip()


def rival_words(step: Step) -> str:
    """`thermal-lag(EZB) cannot be distinguished from thermal-lag(EZX)`; empty without rivals."""
    own, *rivals = [e.name for e in _members(step)]
    return f"{own} cannot be distinguished from {_few(rivals, last='and')}" if rivals else ""


def plan_words(plan: Plan) -> str:
    """What a plan distinguishes: `reversal of X [backlash(X)] from reversal of Y [backlash(Y)]`."""
    chain = plan.touches.chain
    one, other = plan.distinguishes
    if plan.periods_of:
        periods = ", ".join((one.rpartition("@")[2], *other.rpartition("@")[2].split(",")))
        effect = parse_effect(plan.periods_of, chain)
        is_turn = is_tunable(effect) and effect.inner(plan.touches)[0].is_harmonic
        what = f"the harmonics {periods}" if is_turn else f"the periods {periods} mm"
        return f"{what} of {effect_words(effect)}"
    return f"{words_of_name(one, chain)} from {words_of_name(other, chain)}"


def _members(step: Step) -> list[Effect]:
    """The effect of a step with those not distinguished from it, the likeliest first."""
    assert step.effect is not None
    rivals = step.confusion.rivals if step.confusion else ()
    return [step.effect, *(r.effect for r in rivals)]


def _class(effects: Sequence[Effect]) -> tuple[str, list[str], list[str]]:
    """Text of the first title, the bodies of all that share it, and the titles of the rest."""
    titles = [title_of(e) for e in effects]
    text = titles[0].text
    bodies = {other.text: _bodies(titles, other.text) for other in titles}
    others = [
        f"{other} (carried by {_few(bodies[other])})" if len(bodies[other]) > 1 else whole
        for other, whole in {t.text: _whole(t) for t in titles if t.text != text}.items()
    ]
    return text, bodies[text], others


def _bodies(titles: Sequence[Title], text: str) -> list[str]:
    """What carries the effects that share a text, each once."""
    return list(dict.fromkeys(_BODIES.get(t.carrier, t.carrier) for t in titles if t.text == text))


def _whole(title: Title) -> str:
    """A title with the body that carries the effect, where its text does not name it."""
    text, carrier = title
    is_said = not carrier or carrier in _BODIES or f" of {carrier} " in f"{text} ".replace(",", " ")
    return text if is_said else f"{text}, carried by {carrier}"


def _bracket(effects: Sequence[Effect], title: str) -> str:
    """`[thermal-lag(EZB) or one of 3 more]`; empty for an effect that is called by its name."""
    name, more = effects[0].name, len(effects) - 1
    if not more:
        return "" if name == title else f"[{name}]"
    return f"[{name} or {effects[1].name if more == 1 else f'one of {more} more'}]"
