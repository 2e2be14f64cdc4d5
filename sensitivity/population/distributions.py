"""Shapes of the errors of random machines over the readings of their axes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import get_args

from matstd.twin.errors import BadValue, DesignError
from matstd.twin.machine import Chain, Family, ShapeName, Symbol, error_class

CLASSES = ("linear_translation", "linear_rotation", "rotary_translation", "rotary_rotation")
"""Classes of errors that vary with a reading; all others are constants."""


@dataclass(frozen=True)
class Mix:
    """Shapes that one error may have; every machine has one of them."""

    shapes: tuple[ShapeName, ...]
    # numbers of periods of a sinusoidal error, drawn with equal chance; over the range of a linear
    # axis, over a turn of a rotary one
    periods: tuple[int, ...] = (1,)
    weights: tuple[float, ...] = ()  # chance of each shape, in any unit; none for equal chances

    def __post_init__(self) -> None:
        if not self.shapes or not set(self.shapes) <= set(get_args(ShapeName)):
            known = ", ".join(get_args(ShapeName))
            raise BadValue("shapes", list(self.shapes), f"at least one of {known}")
        if len(set(self.shapes)) < len(self.shapes):
            raise BadValue("shapes", list(self.shapes), "each once, with a weight")
        if not self.periods or min(self.periods) < 1 or len(set(self.periods)) < len(self.periods):
            raise BadValue("periods", list(self.periods), "whole numbers from 1 up, each once")
        if self.weights and (
            len(self.weights) != len(self.shapes)
            or not all(0.0 <= w < float("inf") for w in self.weights)
            or not sum(self.weights) > 0.0
        ):
            found = f"{list(self.weights)} for shapes {list(self.shapes)}"
            raise BadValue("weights", found, "a number from zero up for each, not all zero")

    @property
    def chances(self) -> tuple[float, ...]:
        """Probability of each shape."""
        each = self.weights or (1.0,) * len(self.shapes)
        return tuple(w / sum(each) for w in each)


CONSTANT = Mix(("constant",))


@dataclass(frozen=True)
class Distributions:
    """Shapes of all errors: by name before by class before by kind of axis."""

    # drawn with equal chance for every component error of a linear axis
    shapes: tuple[ShapeName, ...] = ("linear", "parabolic", "sinusoidal")
    # the same for a rotary axis, whose errors repeat every turn
    rotary_shapes: tuple[ShapeName, ...] = ("sinusoidal",)
    # numbers of periods of a sinusoidal error, where no mix says otherwise
    periods: tuple[int, ...] = (1,)
    # mixes of whole classes, keys as in `CLASSES`
    by_class: Mapping[str, Mix] = field(default_factory=dict)
    by_name: Mapping[str, Mix] = field(default_factory=dict)  # mixes of single component errors

    def __post_init__(self) -> None:
        for shapes in (self.shapes, self.rotary_shapes):
            Mix(shapes, self.periods)
        for name in self.by_class:
            if name not in CLASSES:
                raise DesignError(
                    f"shapes of class '{name}': expected one of {', '.join(CLASSES)}; all other "
                    "errors are constants"
                )

    def of(self, chain: Chain, symbol: Symbol) -> Mix:
        """Mix of one error.

        Location and set-up errors are constants, and so are the errors of a spindle that stays at
        one angle.
        """
        link = chain.link(symbol.link)
        if symbol.family is not Family.COMPONENT or not link.programmed:
            return CONSTANT
        named = self.by_name.get(symbol.name) or self.by_class.get(error_class(chain, symbol))
        if named:
            return named
        return Mix(self.rotary_shapes if link.kind == "rotary" else self.shapes, self.periods)

    def check(self, chain: Chain) -> None:
        """Every name must be that of an error with a shape.

        Raises:
            UnknownSymbol: A name that the machine does not have.
            DesignError: A constant.
        """
        for name in self.by_name:
            symbol = chain.symbol(name)
            if symbol.family is not Family.COMPONENT or not chain.link(symbol.link).programmed:
                raise DesignError(f"shapes of {name}: it is a constant and has none")
