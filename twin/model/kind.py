"""`Kind`: one word of the library of effects, with all that a user reads about it."""

import inspect
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import ClassVar

from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import Refuse, check_count, refusal
from matstd.twin.machine import Chain
from matstd.twin.model.declared import Declared, layout_of
from matstd.twin.model.effect import Effect
from matstd.twin.record import Touches


@dataclass(frozen=True)
class Kind:
    """A family of effects under one word of the trade."""

    OWNERS: ClassVar[tuple[str, ...]] = ("machine", "probe", "run")

    word: str  # first word of the names of its effects, `backlash`
    arguments: str  # what stands in the brackets, for help: "axis"; empty where there are none
    formula: str  # the closed formula, one line
    units: str  # units of its parameters and inner parameters, as a user sees them
    typical: str  # size that is met in practice
    source: str  # where the formula and the size are from
    # effect from the arguments of its name; raises a child of DesignError
    make: Callable[[Chain, Sequence[str]], Effect]
    # every effect of the kind that makes sense for some touches
    propose: Callable[[Touches], Iterable[Effect]]
    classes: tuple[type, ...] = ()  # classes of its effects, whose docstrings describe them
    about: str = ""  # what the family is, in one line; empty for the first line of its first class
    title: str = ""  # its name on the shop floor
    synonyms: str = ""  # other words for it, commas between them
    # one of OWNERS, where it is to be expected again: in every run of the machine, in those with
    # the same probe, or in no other run, as a slip on a certain day
    belongs_to: str = "machine"

    @classmethod
    def of(
        cls,
        effect: Callable[..., Effect],
        formula: str,
        units: str = "",
        typical: str = "",
        source: str = "",
        propose: Callable[[Touches], Iterable[Effect]] | None = None,
        title: str = "",
        synonyms: str = "",
        belongs_to: str = "machine",
        when: Callable[[Touches], bool] | None = None,
    ) -> "Kind":
        """The kind of one class: its usage, parser and proposals follow from its fields.

        Args:
            effect: The class, a `Declared` one or one that takes no arguments; its `kind` is the
                word, and its first line of documentation the summary.
            propose: Every effect that makes sense for some touches; None for one with every value
                that its fields are offered, and the usual values of those that may be left out.
            when: Whether it is proposed for some touches at all; None for always.
        """
        declared = effect if isinstance(effect, type) and issubclass(effect, Declared) else None
        word = effect().kind if declared is None else declared.kind
        arguments, usual, _ = ({}, {}, {}) if declared is None else layout_of(declared)
        least = len(arguments) - len(usual)
        words = [a.word for a in arguments.values()]

        def make(chain: Chain, found: Sequence[str]) -> Effect:
            """Effect from the texts in the brackets."""
            check_count(kind.usage, found, least, len(arguments))
            refuse = partial(refusal, kind.usage, found)
            given = zip(arguments.items(), found, strict=False)
            values = {name: a.read(text, chain, refuse) for (name, a), text in given}
            return _on_machine(effect(**values), chain, refuse)

        def every(touches: Touches) -> Iterable[Effect]:
            """One with every combination of what its required fields are offered."""
            names = list(arguments)[:least]
            for values in product(*(list(arguments[name].offered(touches)) for name in names)):
                made = effect(**dict(zip(names, values, strict=True)))
                yield _on_machine(made, touches.chain, _refused)

        kind = cls(
            word=word,
            arguments=",".join(words[:least]) + "".join(f"[,{w}]" for w in words[least:]),
            formula=formula,
            units=units,
            typical=typical,
            source=source,
            make=make,
            propose=lambda touches: (
                (propose or every)(touches) if when is None or when(touches) else ()
            ),
            classes=(effect,) if isinstance(effect, type) else (),
            title=title,
            synonyms=synonyms,
            belongs_to=belongs_to,
        )
        return kind

    def matches(self, query: str) -> bool:
        """Whether every word of a query stands in the name, title, synonyms, formula or summary."""
        card = (self.word, self.title, self.synonyms, self.formula, self.summary, self.typical)
        text = " ".join(card).lower().replace("-", " ")
        return all(word in text for word in query.lower().replace("-", " ").split())

    @property
    def usage(self) -> str:
        """`backlash(axis)`."""
        return f"{self.word}({self.arguments})" if self.arguments else self.word

    @property
    def summary(self) -> str:
        """What the effects of the kind are, in one line."""
        text = inspect.getdoc(self.classes[0]) if self.classes and not self.about else None
        return text.partition("\n")[0] if text else self.about


def _refused(expected: str) -> UnknownEffect:
    return UnknownEffect(f"an effect that was proposed: expected {expected}")


def _on_machine(effect: Effect, chain: Chain, refuse: Refuse) -> Effect:
    return effect.on(chain, refuse) if isinstance(effect, Declared) else effect
