"""Estimates of what a body costs to make: hours, bought parts, mass of stock, lead time.

In: a `Standard`. Out: a `Price` of each construction, every figure with its uncertainty. A rate is
changed in `rates`, a material added in `stocks`.
"""

from matstd.artefact.price.price import Construction as Construction
from matstd.artefact.price.price import Price as Price
from matstd.artefact.price.price import construction_to_make as construction_to_make
from matstd.artefact.price.price import prices_of as prices_of
from matstd.artefact.price.rates import Estimate as Estimate
