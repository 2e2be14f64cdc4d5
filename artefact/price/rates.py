"""What a workshop is assumed to need and to charge, as ranges.

A figure is a range in which every value is as likely as every other, so that its standard
uncertainty is its width over the root of twelve (JCGM 100:2008, 4.3.7). None is a quotation: they
rank two constructions of one body and place it in a class of price. Prices are net, in euros.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Estimate:
    """A figure with its standard uncertainty; sums are of independent figures."""

    value: float
    u: float = 0.0

    @staticmethod
    def between(low: float, high: float) -> "Estimate":
        """The middle of a range."""
        return Estimate(0.5 * (low + high), (high - low) / np.sqrt(12.0))

    def __add__(self, other: "Estimate") -> "Estimate":
        return Estimate(self.value + other.value, float(np.hypot(self.u, other.u)))

    def __mul__(self, by: float) -> "Estimate":
        return Estimate(by * self.value, abs(by) * self.u)

    def times(self, other: "Estimate") -> "Estimate":
        """The product of two independent figures, to first order."""
        u = np.hypot(self.value * other.u, other.value * self.u)
        return Estimate(self.value * other.value, float(u))

    def over(self, other: "Estimate") -> "Estimate":
        """The quotient of two independent figures, to first order."""
        ratio = self.value / other.value
        u = np.hypot(self.u, ratio * other.u) / other.value
        return Estimate(ratio, float(u))


_between = Estimate.between

MILLING, TURNING, GRINDING, BENCH = (
    _between(70.0, 130.0),
    _between(50.0, 90.0),
    _between(60.0, 110.0),
    _between(45.0, 80.0),
)
"""Rates of five-axis milling, turning, grinding and fitting, with their operator, per h."""

MEASURING = _between(90.0, 160.0)  # rate of a coordinate measuring machine, per h

POWER, IN_CUT = _between(3.0, 6.0), _between(0.3, 0.6)
"""Power at a roughing cutter, kW; share of the time of roughing in which it cuts."""

FINISHING, WALLS, PLANES = _between(3.0, 9.0), _between(2.0, 5.0), _between(15.0, 40.0)
"""Area finished on a freeform face, on walls and posts, on planes, cm^2/min. The first is a
step-over of 0.2 to 0.4 mm at a feed of 1.5 to 2.25 m/min."""

PROGRAMMING, PER_PART, SET_UP = _between(5.0, 11.0), _between(0.5, 1.5), _between(1.0, 2.5)
"""Programs of a body, of each further part; a set-up on the machine, h."""

STUD, TAPPED, JOINT, SEAT = (
    _between(0.4, 0.9),
    _between(0.1, 0.2),
    _between(1.0, 2.0),
    _between(0.2, 0.4),
)
"""A turned stud with its countersink, its tapped hole, the joint of a block on three pads, a
countersink milled on a post, h."""

GLUEING, GROUND = _between(0.2, 0.5), _between(2.0, 4.0)
"""A ball in its seat; both faces of a plate, h."""

BALL, SCREWS = _between(8.0, 20.0), _between(20.0, 50.0)
"""A ball of 100Cr6, grade 5, of 20 to 30 mm; screws and pins of a body."""

HARDENING, PER_KG_HARDENED = _between(150.0, 400.0), _between(3.0, 6.0)
"""Stress relief and hardening in vacuum: a batch, and a kilogramme."""

MEASURED_SET_UP, MEASURED_BALL, MEASURED_FACE = (
    _between(1.5, 3.0),
    _between(0.05, 0.1),
    _between(0.5, 1.5),
)
"""Calibration: alignment and report, a ball, a face with its dense lines, h."""

HOURS_A_WEEK = _between(15.0, 35.0)  # hours of a week in which a workshop works on one piece

MATERIAL_WEEKS, HARDENING_WEEKS, CALIBRATION_WEEKS = (
    _between(1.0, 3.0),
    _between(1.0, 2.0),
    _between(1.0, 3.0),
)
"""Waiting for stock and bought parts, for the hardener, for the measuring room."""
