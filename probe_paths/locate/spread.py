"""How far beside its place a standard may stand that is searched for."""

from dataclasses import dataclass

from matstd.twin.units import DEG


@dataclass(frozen=True)
class Spread:
    """Largest offset of the standard from its assumed place, either way in every direction."""

    distance: float = 20.0  # along x, y and z of its own frame, mm
    angle: float = 5.0 * DEG  # about each of them, rad


SPREADS = tuple(Spread(d, a * DEG) for d, a in ((20.0, 5.0), (15.0, 4.0), (10.0, 3.0), (5.0, 2.0)))
"""Spreads for which a search is tried, the widest first: placed by eye, by a rule, by a stop. A
standard of tall posts may leave a short stylus no room to come down over a wide spread."""
