"""A user's own physics: a hose that lifts the ram where X is near one place and Y beyond another.

    matstd diagnose RUN.csv --effects examples/my_effects.py --add hose

One class with a formula, one `Kind` that tells its name; every command then knows the effect.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.model import Inner, Kind, Parameter, Term, Where
from matstd.twin.units import UM


@dataclass(frozen=True)
class Hose:
    """EZZ = a exp(-((X - x)/width)^2) where Y > y; x, width and y are scanned, a is fitted."""

    x: float = 0.0  # mm
    width: float = 50.0  # mm
    y: float = 0.0  # mm

    name = kind = "hose"
    parameters = (Parameter("lift", "mm", 10 * UM),)

    def terms(self, touches):
        push = np.exp(-(((touches.reading("X") - self.x) / self.width) ** 2))
        push = push * (touches.reading("Y") > self.y)
        return (Term(0, Where("twist", touches.chain.link_index("Z"), 2), push),)

    def inner(self, touches):
        return (
            Inner("x", "mm", np.linspace(-150.0, 150.0, 13)),
            Inner("width", "mm", np.array([15.0, 30.0, 60.0, 120.0])),
            Inner("y", "mm", np.linspace(-100.0, 100.0, 7)),
        )

    def tuned(self, *values):
        return replace(self, **dict(zip(("x", "width", "y"), map(float, values), strict=True)))

    @property
    def tuning(self):
        return {"x": self.x, "width": self.width, "y": self.y}


HOSE = Kind.of(
    Hose,
    formula="EZZ = a exp(-((X - x)/width)^2) for Y > y",
    units="a: µm; x, width, y: mm",
    typical="some µm",
    source="seen behind the ram",
    title="lift of the ram by its hose",
)
