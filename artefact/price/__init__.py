"""Estimates of what a body costs to make: hours, bought parts, mass of stock, lead time.

In: a `Standard`. Out: a `Price` of each construction, every figure with its uncertainty. A rate is
changed in `rates`, a material added in `stocks`.
"""

from matstd.artefact.price.price import Construction, Price, construction_to_make, prices_of
from matstd.artefact.price.rates import Estimate

__all__ = ["Construction", "Estimate", "Price", "construction_to_make", "prices_of"]
