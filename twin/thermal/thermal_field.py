"""A body of the machine after every drive, at once and through a few lags, shrunk together.

Sensors of one machine share what they know. Picked one by one they stand in for each other, and
which one is picked is chance; fitted together with one common prior each tells a little, and the
sum predicts. Time constants need not be searched: a lag between two of the fixed ones is nearly a
mean of both.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from twin.machine import Chain
from twin.model import Kind, Parameter, Term, Title, Where, moving_axes, refusal
from twin.record import Touches
from twin.thermal.drive_columns import PER_KELVIN, driven, drives, is_speed
from twin.units import MINUTE, UM, URAD

USAGE = "thermal-field(axis,drive,...)"

LETTERS = "XYZABC"

LAGS = (4.0 * MINUTE, 16.0 * MINUTE, 64.0 * MINUTE, 256.0 * MINUTE)
"""Time constants, s, over the range of `thermal-lag`. A lag between two neighbours is
a weighted mean of both to 7 % of a step."""


@dataclass(frozen=True)
class ThermalField:
    """All six component errors of an axis after several drives, each at once and through lags.

    ``E = sum_d [a_d0 d(t) + sum_k a_dk y_dk(t)]``, ``tau_k dy_dk/dt = d - y_dk``, with
    d = T - 20 degC of a sensor or n/(10 000 rpm); the speed, which is no state of a body, through
    lags alone. Holds for small errors of a machine that leads heat linearly. All amplitudes share
    one prior, whose size is chosen by what it predicts: the data decide how many of them count.

    Attributes:
        axis: Whose body warms.
        drives: Names of sensors, or `spindle_rpm`.

    Reference:
        ISO 230-3; ridge regression of thermal errors on many sensors.
    """

    axis: str
    drives: tuple[str, ...]

    kind = "thermal-field"
    is_shrunk = True

    @property
    def name(self) -> str:
        """`thermal-field(Z,frame,bed)`."""
        return f"thermal-field({','.join((self.axis, *self.drives))})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"warming of the body of {self.axis}", self.axis)

    @property
    def places(self) -> Sequence[tuple[str, float]]:
        """Drive and time constant (s, zero for at once) of the amplitudes of one component."""
        at_once = [(d, 0.0) for d in self.drives if not is_speed(d)]
        return (*at_once, *((d, tau) for d in self.drives for tau in LAGS))

    @property
    def parameters(self) -> Sequence[Parameter]:
        """An amplitude for every component, drive and lag, one component after the other."""
        out = []
        for letter in LETTERS:
            unit, sd = ("mm", 30 * UM) if letter in "XYZ" else ("rad", 100 * URAD)
            for drive, tau in self.places:
                lag = f"{tau / MINUTE:g} min" if tau else "at once"
                own = (unit, sd) if is_speed(drive) else (f"{unit}/K", PER_KELVIN * sd)
                out.append(Parameter(f"E{letter} {drive} {lag}", *own))
        return tuple(out)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis, one for every parameter."""
        link = touches.chain.link_index(self.axis)
        amounts = [driven(touches, drive, tau, self.name) for drive, tau in self.places]
        return tuple(
            Term(c * len(amounts) + k, Where("twist", link, c), amount)
            for c in range(len(LETTERS))
            for k, amount in enumerate(amounts)
        )


def make(chain: Chain, arguments: Sequence[str]) -> ThermalField:
    """From the axis and the drives."""
    if len(arguments) < 2 or not all(arguments):
        raise refusal(USAGE, arguments, "an axis, then sensors or spindle_rpm")
    if len(set(arguments)) < len(arguments):
        raise refusal(USAGE, arguments, "every drive once")
    if arguments[0] not in chain.axes:
        raise refusal(USAGE, arguments, f"an axis of {', '.join(chain.axes)}")
    return ThermalField(arguments[0], tuple(arguments[1:]))


def propose(touches: Touches) -> Iterable[ThermalField]:
    """None: a field is weighed against single effects by what it predicts, not found among them."""
    return ()


def field(touches: Touches) -> ThermalField | None:
    """The axis next to the tool among those that moved, else among all, after every drive that was
    recorded; None where none was.
    """  # noqa: D205
    names = tuple(drives(touches))
    axes = moving_axes(touches) or touches.chain.axes
    return ThermalField(axes[-1], names) if names else None


KIND = Kind(
    word="thermal-field",
    arguments="axis,sensor or spindle_rpm,...",
    title="warming of a body after several drives",
    synonyms="thermal error field, thermal deformation, many sensors, regression, warm-up",
    formula="E = sum of a d + a_k y_k over drives d; tau_k dy_k/dt = d - y_k, tau 4 16 64 256 min",
    units="a: µm or µrad, per K after a sensor, at 10 000 rpm after the spindle",
    typical="where many sensors know something: 10 to 100 µm in all",
    source="ISO 230-3; ridge regression on many sensors",
    make=make,
    propose=propose,
    classes=(ThermalField,),
)
