"""Any component error in proportion to a column of the user's own."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.frames import Array
from twin.machine import Chain, Family, Symbol
from twin.model import (
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    component_symbol,
    moving_axes,
)
from twin.record import Touches
from twin.thermal.drive_columns import own_column, own_columns
from twin.units import UM, URAD

USAGE = "follows(symbol,column)"


@dataclass(frozen=True)
class Follows:
    """A component error that follows a column `V_name_unit` at once.

    ``E = a v / s``. The column is in a unit that only its user knows, so the amplitude a, mm or
    rad, is that of a step s, a round number near the spread of the column, which stays with the
    effect: the same model means the same on another run.

    Attributes:
        column: Name of the column without `V_`, its unit included.
        step: s, in the unit of the column.
    """

    symbol: Symbol
    column: str
    step: float = 1.0

    kind = "follows"

    @property
    def name(self) -> str:
        """`follows(EZZ,coolant_l_min)`."""
        return f"follows({self.symbol.name},{self.column})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"{self.symbol.title} that follows {self.column}", self.symbol.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The amplitude of a step."""
        sd = 20 * URAD if self.symbol.is_angular else 6 * UM
        return (Parameter("amplitude", self.symbol.unit, sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        i = touches.chain.link_index(self.symbol.link)
        amount = own_column(touches, self.column) / self.step
        return (Term(0, Where("twist", i, self.symbol.component), amount),)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The step, a single value: it is chosen and not found."""
        values = own_column(touches, self.column)
        return (Inner("step", "1", np.array([round_step(values)]), continuous=False),)

    def tuned(self, *values: float) -> "Follows":
        """With this step."""
        return replace(self, step=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The step."""
        return {"step": self.step}


def round_step(values: Array) -> float:
    """Power of ten next to the standard deviation of a column; 1 of a constant one.

    Example:
        >>> round_step(np.array([0.0, 30.0]))
        10.0
    """
    spread = float(np.std(values))
    return float(10.0 ** np.round(np.log10(spread))) if spread > 0.0 else 1.0


def make(chain: Chain, arguments: Sequence[str]) -> Follows:
    """From the component error and the column, with or without its `V_`."""
    check_count(USAGE, arguments, 2, 2)
    return Follows(component_symbol(chain, arguments[0]), arguments[1].removeprefix("V_"))


def propose(touches: Touches) -> Iterable[Follows]:
    """Every component of every axis that moved, else of the one next to the tool, with every
    column of the user's own that varies.
    """  # noqa: D205
    axes = moving_axes(touches) or touches.chain.axes[-1:]
    for column in own_columns(touches):
        for symbol in touches.chain.symbols:
            if symbol.family is Family.COMPONENT and symbol.link in axes:
                yield Follows(symbol, column, round_step(own_column(touches, column)))


KIND = Kind(
    word="follows",
    arguments="symbol,column of the user's own",
    title="what follows a column of your own",
    synonyms="coolant, pressure, load, own sensor, own column",
    formula="E = a v / s, v a column V_name_unit, s a round step of it",
    units="a: µm or µrad a step; step: unit of the column",
    typical="whatever the column knows",
    source="the user",
    make=make,
    propose=propose,
    classes=(Follows,),
)
