"""`determined` of a model file: what its run determines, as console and page report it.

An estimate of a single parameter shares with set-up and other parameters what the run cannot
separate; these quantities share nothing, so every command states them with the same figures.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from matstd.diagnosis.files.geometry_table import UNITS
from matstd.diagnosis.geometry import Estimate, GeometryRow, Quantity
from matstd.twin.files import Table
from matstd.twin.numbers import significant


@dataclass(frozen=True, slots=True)
class Determined:
    """A quantity of the geometry with its value; attributes as of `GeometryRow`."""

    quantity: Quantity
    symbol: str
    axes: tuple[str, ...]
    unit: str
    estimate: Estimate


class DeterminedEntry(Table):
    """One entry of `determined`: a quantity of the geometry, in the unit that it states."""

    symbol: str
    quantity: Quantity = Field(strict=False)
    axes: list[str]
    unit: Literal["um", "urad", "ppm"]
    value: float
    u: float = Field(ge=0.0)

    def determined(self) -> Determined:
        """The quantity in base units."""
        unit, factor = next((u, f) for u, (suffix, f) in UNITS.items() if suffix == self.unit)
        estimate = Estimate(self.value * factor, self.u * factor)
        return Determined(
            quantity=self.quantity,
            symbol=self.symbol,
            axes=tuple(self.axes),
            unit=unit,
            estimate=estimate,
        )


def determined_text(rows: Iterable[GeometryRow | Determined]) -> str:
    """Quantities as a TOML array, an entry a line; nothing where there are none."""
    lines = []
    for row in rows:
        suffix, factor = UNITS[row.unit]
        axes = ", ".join(f'"{axis}"' for axis in row.axes)
        value, u = (significant(v / factor) for v in (row.estimate.value, row.estimate.u))
        lines.append(
            f'  {{ symbol = "{row.symbol}", quantity = "{row.quantity.value}", axes = [{axes}], '
            f'unit = "{suffix}", value = {value!r}, u = {u!r} }},'
        )
    if not lines:
        return ""
    note = "# what the run determines, as reported; the estimates below are single parameters\n"
    return note + "\n".join(["determined = [", *lines, "]"]) + "\n"
