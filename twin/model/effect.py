"""Effects: where in the machine they act, and how much per unit of their parameters."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import Literal, NamedTuple, Protocol, TypeGuard

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import Contribution, Where
from matstd.twin.record import Touches

Acts = Literal["smoothly", "with a period", "at an instant"]
"""How deviations depend on an inner parameter."""


class Term(NamedTuple):
    """How much one parameter of an effect adds at one place, per unit, at every touch."""

    parameter: int  # index into the effect's parameters
    where: Where  # entry of the contribution that it adds to
    amount: Array  # per unit of the parameter, shape (N,)


class Parameter(NamedTuple):
    """A number that an effect leaves open and that it depends on linearly."""

    name: str  # word of the trade, unique within its effect
    unit: str  # base unit, "mm", "rad", "1/K", "mm/K"; `units.shown` is what a user sees
    sd: float  # standard deviation that is expected before any measurement, base unit


class Title(NamedTuple):
    """What an effect is called in reports."""

    text: str  # without the body that carries it where another could as well: `growth along Z`
    carrier: str = ""  # axis, `t`, `w`, or "standard", "probe" ...; empty where the text names it


class Effect(Protocol):
    """A physical cause of deviations: thirty lines, one closed formula.

    Attributes:
        name: `kind(arguments)`, as written in files and reports.
        kind: The first word of the name.
        parameters: What it depends on linearly.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def kind(self) -> str: ...  # noqa: D102

    @property
    def parameters(self) -> Sequence[Parameter]: ...  # noqa: D102

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Where and how much it acts, per unit of each parameter, at every touch."""
        ...


def numbered_terms(effects: Iterable[Effect], touches: Touches) -> Iterator[tuple[int, Term]]:
    """Terms of effects with the place of their parameter in the vector of all parameters."""
    start = 0
    for effect in effects:
        for term in effect.terms(touches):
            yield start + term.parameter, term
        start += len(effect.parameters)


def contribution(
    effects: Mapping[Effect, Array] | Sequence[tuple[Effect, Array]], touches: Touches
) -> Contribution:
    """Sum of what effects with known parameters (P,), base units, add at every touch."""
    total = Contribution.zeros(len(touches), len(touches.chain.links))
    pairs = effects.items() if isinstance(effects, Mapping) else effects
    for effect, theta in pairs:
        for term in effect.terms(touches):
            total.add(term.where, np.asarray(theta, dtype=float)[term.parameter] * term.amount)
    return total


class Inner(NamedTuple):
    """A parameter that an effect depends on non-linearly: scanned on a grid, then refined."""

    name: str  # any word, unique within its effect
    unit: str  # base unit: "s", "mm", "rad", "1"
    grid: Array  # values to scan, ascending, (G,), base units
    continuous: bool = True  # whether values between those of the grid make sense
    # "smoothly", such as a time constant or a width; "with a period", the reading in which the
    # effect repeats; "at an instant", a time at which something jumps, so that every instant
    # between two touches is as good as another
    acts: Acts = "smoothly"
    # of a period, or of the waves of a turn, whose unit is "1", the axis over whose reading it
    # repeats; empty where it repeats over something else
    over: str = ""
    clock: str = ""  # own column without `V_` of which an instant is a value; empty for the time

    @property
    def is_harmonic(self) -> bool:
        """Whether it counts the waves of a turn; else it is a length."""
        return bool(self.over) and self.unit == "1"

    def clocked(self, touches: Touches) -> Array:
        """What an instant is compared with at every touch, (N,)."""
        return touches.value[self.clock] if self.clock else touches.time

    def frequency(self, value: Array) -> Array:
        """Spatial frequency of a periodic effect at values of it, 1/mm or 1/rad."""
        return value / (2.0 * np.pi) if self.is_harmonic else 1.0 / value


def own_title(effect: Effect) -> Title | None:
    """The title that an effect gives itself (attribute or property `title`); None without one."""
    return getattr(effect, "title", None)


class Tunable(Effect, Protocol):
    """An effect with inner parameters."""

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """Its inner parameters, with the grids that these touches can support."""
        ...

    def tuned(self, *values: float) -> "Tunable":
        """The same effect with these values of its inner parameters."""
        ...

    @property
    def tuning(self) -> Mapping[str, float]:
        """Present values of the inner parameters, base units."""
        ...


class Saved(Effect, Protocol):
    """An effect whose law was learnt before and saved, with what is not known of it.

    Attributes:
        path: File of the law, as it was written.
        has_unknowns: Whether what is not known of the law are parameters too.
        whole: The same with its unknowns.
        known: Parameters of the law as it was saved, (P,), and the root of their covariance.
    """

    @property
    def path(self) -> str: ...  # noqa: D102

    @property
    def has_unknowns(self) -> bool: ...  # noqa: D102

    @property
    def whole(self) -> "Saved": ...  # noqa: D102

    @property
    def known(self) -> tuple[Array, Array]: ...  # noqa: D102


def is_saved(effect: Effect) -> TypeGuard[Saved]:
    """Whether an effect replays a law with its uncertainty."""
    return hasattr(type(effect), "has_unknowns")


def is_tunable(effect: Effect) -> TypeGuard[Tunable]:
    """Whether an effect has inner parameters.

    Cached by class: checking the protocol by attributes took a twentieth of a diagnosis.
    """
    return _is_tunable(type(effect))


@cache
def _is_tunable(cls: type) -> bool:
    return hasattr(cls, "tuned") and getattr(cls, "has_inner", lambda: True)()


def with_inner(effect: Tunable, index: int, value: float) -> Tunable:
    """The effect with one inner parameter at another value."""
    values = list(effect.tuning.values())
    values[index] = value
    return effect.tuned(*values)


def inner_values(effect: Effect, touches: Touches) -> list[tuple[Inner, float]]:
    """Inner parameters of an effect with their present values, base units; none for most."""
    if not is_tunable(effect):
        return []
    return list(zip(effect.inner(touches), effect.tuning.values(), strict=True))
