"""`Kind`: one word of the library of effects, with all that a user is told about it."""

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.model.effect import Effect
from matstd.twin.record import Touches
from matstd.twin.words import did_you_mean


@dataclass(frozen=True)
class Kind:
    """A family of effects under one word of the trade.

    Attributes:
        word: First word of the names of its effects, `backlash`.
        arguments: What stands in the brackets, for help: "axis"; empty where there are none.
        formula: The closed formula, one line.
        units: Of its parameters and inner parameters, as a user sees them.
        typical: Size that is met in practice.
        source: Where the formula and the size are from.
        make: Effect from the arguments of its name; raises a child of DesignError.
        propose: Every effect of the kind that makes sense for some touches.
        classes: Classes of its effects, whose docstrings tell the whole story.
        about: What the family is, in one line; empty for the first line of its first class.
        title: What those who run machines call it.
        synonyms: Other words for it, commas between them.
        belongs_to: One of OWNERS, which says where it is to be expected again: in every run of the
            machine, in those with the same probe, or in no other run, as a slip on a certain day.
    """

    OWNERS: ClassVar[tuple[str, ...]] = ("machine", "probe", "run")

    word: str
    arguments: str
    formula: str
    units: str
    typical: str
    source: str
    make: Callable[[Chain, Sequence[str]], Effect]
    propose: Callable[[Touches], Iterable[Effect]]
    classes: tuple[type, ...] = ()
    about: str = ""
    title: str = ""
    synonyms: str = ""
    belongs_to: str = "machine"

    @classmethod
    def of(
        cls,
        effect: Callable[[], Effect],
        formula: str,
        units: str = "",
        typical: str = "",
        source: str = "",
        propose: Callable[[Touches], Iterable[Effect]] | None = None,
        title: str = "",
        synonyms: str = "",
        belongs_to: str = "machine",
    ) -> "Kind":
        """The kind of an effect that takes no arguments, which is all that most users need.

        Args:
            effect: Its class, made without arguments; its `kind` is the word.
            formula: The closed formula, one line.
            units: Of its parameters and inner parameters, as a user sees them.
            typical: Size that is met in practice.
            source: Where the formula and the size are from.
            propose: The effect where it makes sense for some touches; None for always.
            title: What those who run machines call it.
            synonyms: Other words for it, commas between them.
            belongs_to: As of the attribute.
        """
        word = effect().kind

        def make(chain: Chain, arguments: Sequence[str]) -> Effect:
            check_count(word, arguments, 0, 0)
            return effect()

        return cls(
            word=word,
            arguments="",
            formula=formula,
            units=units,
            typical=typical,
            source=source,
            make=make,
            propose=propose or (lambda touches: (effect(),)),
            classes=(effect,) if isinstance(effect, type) else (),
            title=title,
            synonyms=synonyms,
            belongs_to=belongs_to,
        )

    def matches(self, query: str) -> bool:
        """Whether every word of a query stands in the name, title, synonyms, formula or summary."""
        told = (self.word, self.title, self.synonyms, self.formula, self.summary, self.typical)
        text = " ".join(told).lower().replace("-", " ")
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


def refusal(usage: str, found: Sequence[str], expected: str) -> UnknownEffect:
    """Exception for arguments that an effect does not take.

    Args:
        usage: How the effect is written.
        found: The arguments that were given.
        expected: What should stand there, with what is available.
    """
    word = usage.partition("(")[0]
    given = f"{word}({','.join(found)})" if found else word
    return UnknownEffect(f"effect '{given}': expected {usage}, {expected}")


def check_count(usage: str, arguments: Sequence[str], low: int, high: int) -> None:
    """Check the number of arguments; raises UnknownEffect."""
    if not low <= len(arguments) <= high:
        number = f"{low or 'no'}" if low == high else f"{low} to {high}"
        raise refusal(usage, arguments, f"{number} argument{'' if high == 1 else 's'}")


def component_symbol(chain: Chain, name: str) -> Symbol:
    """Component error of an axis by its name; raises UnknownSymbol or UnknownEffect."""
    symbol = chain.symbol(name)
    if symbol.family is not Family.COMPONENT:
        raise UnknownEffect(
            f"'{name}' is a constant ({symbol.family.value}); expected a component error of an "
            "axis, such as EXX"
        )
    return symbol


def moving_axes(touches: Touches) -> list[str]:
    """Programmed axes that stood at more than one reading, in chain order."""
    return [axis for axis in touches.chain.programmed_axes if np.ptp(touches.reading(axis)) > 1e-6]


def moved_components(touches: Touches) -> Iterator[Symbol]:
    """Component errors of the axes that moved, in the order of the machine's symbols.

    Where nothing moved, as in front of a nest of displacement probes, the axis next to the tool
    stands for the machine.
    """
    axes = moving_axes(touches) or touches.chain.axes[-1:]
    for symbol in touches.chain.symbols:
        if symbol.family is Family.COMPONENT and symbol.link in axes:
            yield symbol


def varies(values: Array) -> bool:
    """Whether a record says more than one thing, and says it everywhere."""
    return bool(np.all(np.isfinite(values)) and np.ptp(values) > 1e-6)


def sensors(touches: Touches) -> list[str]:
    """Sensors whose record varies and has no gap."""
    return [name for name, values in touches.temperature.items() if varies(values)]


def sensor_record(touches: Touches, sensor: str) -> Array:
    """Temperatures of one sensor, (N,), degC; raises UnknownEffect where there is none."""
    if sensor not in touches.temperature:
        known = ", ".join(touches.temperature) or "none"
        meant = did_you_mean(sensor, touches.temperature)
        raise UnknownEffect(
            f"no temperature sensor '{sensor}' in these touches{meant}; there is {known}"
        )
    return touches.temperature[sensor]


def checked_axis(usage: str, arguments: Sequence[str], axis: str, chain: Chain) -> str:
    """A programmed axis of the machine; raises UnknownEffect."""
    if axis not in chain.programmed_axes:
        raise refusal(usage, arguments, f"an axis of {', '.join(chain.programmed_axes)}")
    return axis


def checked_linear(usage: str, arguments: Sequence[str], axis: str, chain: Chain) -> str:
    """A linear axis of the machine; raises UnknownEffect."""
    if axis not in chain.linear_axes:
        raise refusal(usage, arguments, f"a linear axis of {', '.join(chain.linear_axes)}")
    return axis
