"""`Kind`: one word of the library of effects, with all that a user reads about it."""

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar

from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import Argument, check_count, refusal
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
        signature = _Signature.of(effect)

        def offered(touches: Touches) -> Iterable[Effect]:
            is_wanted = when is None or when(touches)
            return (propose or signature.proposed)(touches) if is_wanted else ()

        return cls(
            word=signature.word,
            arguments=signature.usage,
            formula=formula,
            units=units,
            typical=typical,
            source=source,
            make=signature.make,
            propose=offered,
            classes=(effect,) if isinstance(effect, type) else (),
            title=title,
            synonyms=synonyms,
            belongs_to=belongs_to,
        )

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


@dataclass(frozen=True)
class _Signature:
    """How an effect is written, from the fields of its class."""

    word: str  # first word of its name
    effect: Callable[..., Effect]  # makes it from the values of its arguments by name
    arguments: Mapping[str, Argument]  # what stands in the brackets, by the name of the field
    required: int  # how many of them cannot be left out

    @classmethod
    def of(cls, effect: Callable[..., Effect]) -> "_Signature":
        """The kind of a class with declared fields, or of a class made without arguments."""
        declared = effect if isinstance(effect, type) and issubclass(effect, Declared) else None
        if declared is None:
            return cls(effect().kind, effect, {}, 0)
        layout = layout_of(declared)
        required = len(layout.arguments) - len(layout.usual)
        return cls(declared.kind, effect, layout.arguments, required)

    @property
    def usage(self) -> str:
        """`symbol,axis[,degree]`."""
        words = [a.word for a in self.arguments.values()]
        left_out = "".join(f"[,{word}]" for word in words[self.required :])
        return ",".join(words[: self.required]) + left_out

    def make(self, chain: Chain, found: Sequence[str]) -> Effect:
        """Effect from the texts in the brackets."""
        usage = f"{self.word}({self.usage})" if self.arguments else self.word
        check_count(usage, found, self.required, len(self.arguments))

        def refuse(expected: str) -> UnknownEffect:
            return refusal(usage, found, expected)

        given = zip(self.arguments.items(), found, strict=False)
        effect = self.effect(**{name: a.read(text, chain, refuse) for (name, a), text in given})
        return effect.on(chain, refuse) if isinstance(effect, Declared) else effect

    def proposed(self, touches: Touches) -> Iterable[Effect]:
        """One with every combination of what its required fields are offered."""
        wanted = list(self.arguments.items())[: self.required]
        names = [name for name, _ in wanted]
        for values in product(*(list(a.offered(touches)) for _, a in wanted)):
            effect = self.effect(**dict(zip(names, values, strict=True)))
            yield effect.on(touches.chain, _refused) if isinstance(effect, Declared) else effect
