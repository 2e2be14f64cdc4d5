"""Price of stock and force of cutting by material, for the materials that are milled."""

from dataclasses import dataclass

from matstd.artefact.price.rates import Estimate


@dataclass(frozen=True, slots=True)
class Stock:
    """A material as it is bought."""

    price: Estimate  # of a sawn block, per kg
    # specific cutting force in roughing, N/mm^2 (kc1 of tables for chips of 0.1 to 0.2 mm, new and
    # worn cutter)
    force: Estimate
    is_hardened: bool = False  # whether it is hardened after roughing


_between = Estimate.between

_STOCKS = {
    "x40cr14": Stock(_between(6.0, 14.0), _between(2000.0, 3000.0), is_hardened=True),
    "cast iron": Stock(_between(3.0, 7.0), _between(1000.0, 1600.0)),
    "aluminium": Stock(_between(7.0, 14.0), _between(600.0, 1000.0)),
    "invar": Stock(_between(40.0, 90.0), _between(2200.0, 3200.0)),
    "steel": Stock(_between(2.0, 6.0), _between(1800.0, 2600.0)),
}

_NOT_MILLED = ("alumina", "zirconia", "granite", "mineral casting")


def stock_of(material: str) -> Stock | None:
    """What is bought of a material by its name; None for one that no cutter mills, or unknown."""
    name = material.lower()
    if any(word in name for word in _NOT_MILLED):
        return None
    return next((stock for word, stock in _STOCKS.items() if word in name), None)
