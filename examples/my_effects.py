"""A user's own physics: a hose that lifts the ram where X is near one place and Y beyond another.

    matstd diagnose RUN.csv --effects examples/my_effects.py --add hose

One class with a formula, one `Kind` with its card; every command then knows the effect.
"""

from dataclasses import dataclass

import numpy as np

from matstd.twin.model import Declared, Kind, scanned


@dataclass(frozen=True)
class Hose(Declared):
    """EZZ = a exp(-((X - x)/width)^2) where Y > y; x, width and y are scanned, a is fitted."""

    x: float = scanned("mm", np.linspace(-150.0, 150.0, 13))
    width: float = scanned("mm", (15.0, 30.0, 60.0, 120.0))
    y: float = scanned("mm", np.linspace(-100.0, 100.0, 7))

    kind, acts_on, amplitudes = "hose", "EZZ", ("lift",)

    def amounts(self, touches):
        push = np.exp(-(((touches.reading("X") - self.x) / self.width) ** 2))
        return (push * (touches.reading("Y") > self.y),)


HOSE = Kind.of(
    Hose,
    formula="EZZ = a exp(-((X - x)/width)^2) for Y > y",
    units="a: µm; x, width, y: mm",
    typical="some µm",
    source="seen behind the ram",
    title="lift of the ram by its hose",
)
