"""A body that warms: one source of heat, one time constant, and every direction follows.

    matstd diagnose RUN.csv --effects examples/fl_thermal/warm_body.py --auto -o OUT

The library's `thermal-lag` moves one component. A spindle head that takes up heat moves in all
directions at once, each by an amount of its own, but all at the same pace.
"""

from dataclasses import dataclass, replace

from matstd.twin.model import Kind, Parameter, Term, Where, sensors
from matstd.twin.thermal import SPINDLE, ThermalLag
from matstd.twin.units import UM


@dataclass(frozen=True)
class WarmBody:
    """EX, EY and EZ of one axis follow one drive with one time constant."""

    axis: str
    lag: ThermalLag
    kind = "warm-body"

    @property
    def name(self):
        return f"warm-body({self.axis},{self.lag.drive})"

    @property
    def parameters(self):
        per, share = ("", 1.0) if self.lag.drive == SPINDLE else ("/K", 0.2)
        return tuple(Parameter(f"E{c}", f"mm{per}", share * 30 * UM) for c in "XYZ")

    def terms(self, touches):
        link, response = touches.chain.link_index(self.axis), self.lag.response(touches)
        return tuple(Term(i, Where("twist", link, i), response) for i in range(3))

    def inner(self, touches):
        return self.lag.inner(touches)

    def tuned(self, *values):
        return replace(self, lag=self.lag.tuned(*values))

    @property
    def tuning(self):
        return self.lag.tuning


def make(chain, arguments):
    axis, drive = arguments
    return WarmBody(axis, ThermalLag(chain.symbol(f"EX{axis}"), drive))


def propose(touches):
    drives = [SPINDLE] if touches.spindle_rpm is not None else []
    for drive in [*drives, *sensors(touches)]:
        yield make(touches.chain, [touches.chain.axes[-1], drive])


WARM_BODY = Kind(
    word="warm-body",
    arguments="axis,sensor or spindle_rpm",
    formula="tau dE/dt = a d - E for EX, EY and EZ with one tau",
    units="a: µm/K after a sensor, µm at 10 000 rpm after the spindle; tau: min",
    typical="spindle heads: 10 to 100 µm, tau 10 min to 4 h",
    source="ISO 230-3 (five-probe nest)",
    make=make,
    propose=propose,
    classes=(WarmBody,),
)
