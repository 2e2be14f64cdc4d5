"""How far beside its place a standard may stand that is searched for."""

from dataclasses import dataclass

from matstd.twin.units import DEG


@dataclass(frozen=True)
class Spread:
    """How far beside its believed place the standard may stand, either way in every direction.

    Attributes:
        distance: Along x, y and z of its own frame, mm.
        angle: About each of them, rad.
    """

    distance: float = 20.0
    angle: float = 5.0 * DEG


SPREADS = tuple(Spread(d, a * DEG) for d, a in ((20.0, 5.0), (15.0, 4.0), (10.0, 3.0), (5.0, 2.0)))
"""That a search is made for, the first for which there is one: by eye, by a rule, by a stop. A
standard of tall posts leaves a short stylus no room to come down wherever it may stand."""
