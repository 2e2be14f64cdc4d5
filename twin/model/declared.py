"""Effects that declare their fields once: name, title, parameters, terms and grids follow.

    @dataclass(frozen=True)
    class Growth(Declared):
        axis: LinearAxisName             # stands in the brackets: growth(X)
        tau: float = scanned("s", np.geomspace(60.0, 6000.0, 12))   # is searched

        kind, called = "growth", "growth of {axis} while it warms"
        parameters = (Parameter("amplitude", "mm", 10 * UM),)

        def amounts(self, touches):      # per unit of each parameter, at every touch
            return (-np.expm1(-touches.since_start / self.tau),)

Any attribute may be a property instead, and any method written out, where physics asks for more.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self, get_type_hints

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.fields import Argument, Refuse
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Where
from matstd.twin.model.effect import Acts, Inner, Parameter, Term, Title
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

Amounts = Sequence[Array]
"""What every parameter of an effect adds per unit, one number a touch, (N,) each."""

Grid = Sequence[float] | Array | Callable[[Any, Touches], Array]
"""Values to scan, ascending; or what makes them of the effect and the touches."""

_SCANNED = "scanned"


def scanned(
    unit: str,
    grid: Grid,
    default: float | None = None,
    continuous: bool = True,
    acts: Acts = "smoothly",
    over: str = "",
) -> Any:
    """A field that the formula depends on otherwise than as a factor: scanned, then refined.

    Args:
        unit: Base unit: "s", "mm", "rad", "1".
        grid: Values to scan, ascending, base units; or a function of the effect and the touches.
        default: Value before a search; None for the middle of the grid.
        continuous: Whether values between those of the grid make sense.
        acts: As of `Inner`.
        over: As of `Inner`: the axis over whose reading a period repeats.
    """
    if default is None:
        default = 0.0 if callable(grid) else float(grid[len(grid) // 2])
    plain = Inner("", unit, np.zeros(0), continuous, acts=acts, over=over)
    return field(default=default, metadata={_SCANNED: (plain, grid)})


@dataclass(frozen=True)
class Declared:
    """An effect whose name, title, parameters and grids follow from its fields."""

    kind: ClassVar[str]  # first word of the name
    # title, with fields in braces: `sag of {symbol.link} {symbol.motion}`; empty where the title of
    # the kind is enough
    called: ClassVar[str] = ""
    # what carries it where that is no axis of its fields: "standard", "probe"
    carrier: ClassVar[str] = ""
    # component error whose entry the amounts add to, `EZZ`, or `bias`; empty for that of the field
    # `symbol`, or the motion of the field `axis`
    acts_on: ClassVar[str] = ""
    # names of its parameters, where all have the unit of the entry and one size
    amplitudes: ClassVar[Sequence[str]] = ("amplitude",)
    per: ClassVar[str] = ""  # what follows that unit: `/K`
    # expected standard deviations of an amplitude as a length and as an angle, mm and rad
    usual: ClassVar[tuple[float, float]] = (10 * UM, 30 * URAD)

    @cached_property
    def name(self) -> str:
        """`kind(fields)`: those of the brackets, without what is as usual at their end."""
        words, least, layout = [], 0, layout_of(type(self))
        for name, argument in layout.arguments.items():
            value = getattr(self, name)
            words.append(argument.write(value))
            if name not in layout.usual or layout.usual[name] != value:
                least = len(words)
        return f"{self.kind}({','.join(words[:least])})" if least else self.kind

    @cached_property
    def title(self) -> Title | None:
        """What it is called, and what carries it."""
        if not self.called:
            return None
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        symbol, axis = values.get("symbol"), values.get("axis", "")
        carrier = self.carrier or (symbol.link if symbol is not None else axis)
        return Title(self.called.format_map(values), carrier)

    @property
    def is_angular(self) -> bool:
        """Whether the entry is an angle."""
        symbol = getattr(self, "symbol", None)
        return symbol is not None and bool(symbol.is_angular)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """The amplitudes."""
        return tuple(self.sized(name) for name in self.amplitudes)

    def sized(self, name: str, share: float = 1.0) -> Parameter:
        """A parameter of the usual size, or a share of it."""
        unit = "rad" if self.is_angular else "mm"
        return Parameter(name, f"{unit}{self.per}", share * self.usual[self.is_angular])

    def where(self, chain: Chain) -> Where:
        """The entry of the contribution that all amounts add to."""
        if self.acts_on == "bias":
            return Where("bias")
        symbol = chain.symbol(self.acts_on) if self.acts_on else getattr(self, "symbol", None)
        if symbol is not None:
            return chain.twist_of(symbol)
        axis: str = vars(self)["axis"]
        return Where("twist", chain.link_index(axis), chain.link(axis).own_component)

    def amounts(self, touches: Touches) -> Amounts:
        """Per unit of each parameter at every touch, (N,) each."""
        raise DesignError(f"{type(self).__name__} has no method amounts(self, touches)")

    def terms(self, touches: Touches) -> Sequence[Term]:
        """The amounts at their entry."""
        where = self.where(touches.chain)
        return tuple(Term(k, where, amount) for k, amount in enumerate(self.amounts(touches)))

    @property
    def searched(self) -> Sequence[str]:
        """The scanned fields that this effect depends on: all of them."""
        return tuple(layout_of(type(self)).scanned)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The scanned fields, with the grids that these touches can support."""
        out = []
        for name in self.searched:
            plain, grid = layout_of(type(self)).scanned[name]
            made = grid(self, touches) if callable(grid) else np.asarray(grid)
            out.append(plain._replace(name=name, grid=made))
        return tuple(out)

    def tuned(self, *values: float) -> Self:
        """The same effect with these values of its scanned fields."""
        return replace(self, **dict(zip(self.searched, map(float, values), strict=True)))

    @property
    def tuning(self) -> Mapping[str, float]:
        """Present values of the scanned fields, base units."""
        return {name: getattr(self, name) for name in self.searched}

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """The effect on a machine: with the fields that follow from it.

        Raises:
            UnknownEffect: What `refuse` makes: the fields do not fit each other, or the machine.
        """
        return self

    @classmethod
    def has_inner(cls) -> bool:
        """Whether its effects have inner parameters."""
        return bool(layout_of(cls).scanned) or cls.inner is not Declared.inner


class Layout(NamedTuple):
    """What the fields of a class are for."""

    arguments: Mapping[str, Argument]  # those that stand in the brackets of a name, in their order
    usual: Mapping[str, Any]  # values of arguments that may be left out
    # those that are searched: their inner parameters without name and grid, and the grids
    scanned: Mapping[str, tuple[Inner, Grid]]


_LAYOUTS: dict[type, Layout] = {}


def layout_of(cls: type[Declared]) -> Layout:
    """The layout of a class, worked out once: names are asked for in every turn of a search."""
    if cls not in _LAYOUTS:
        types = get_type_hints(cls, include_extras=True)
        notes = {f.name: getattr(types[f.name], "__metadata__", ()) for f in fields(cls)}
        arguments = {n: a for n, every in notes.items() for a in every if isinstance(a, Argument)}
        named = [f for f in fields(cls) if f.name in arguments]
        usual = {f.name: f.default for f in named if f.default is not MISSING}
        scanned = {f.name: f.metadata[_SCANNED] for f in fields(cls) if _SCANNED in f.metadata}
        _LAYOUTS[cls] = Layout(arguments, usual, scanned)
    return _LAYOUTS[cls]
