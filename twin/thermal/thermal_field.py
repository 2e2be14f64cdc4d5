"""Response of a body of the machine to all drives, each at once and through lags, with one prior.

Sensors of one machine are correlated, so a choice of single ones is arbitrary. Fitted together with
one common prior (ridge regression), each contributes a little and their sum predicts. Time
constants are fixed: a lag between two of them is nearly a mean of both.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from matstd.twin.fields import moving_axes, refusal
from matstd.twin.machine import LETTERS, Chain
from matstd.twin.model import Declared, Inner, Kind, Parameter, Term, Where
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import (
    OWN,
    amplitude_unit,
    driven,
    drives,
    is_own,
    is_speed,
    step_inner,
    step_of,
)
from matstd.twin.units import MINUTE, UM, URAD

USAGE = "thermal-field(axis,drive,...)"
LAGS = (4.0 * MINUTE, 16.0 * MINUTE, 64.0 * MINUTE, 256.0 * MINUTE)
"""Time constants, s, over the range of `thermal-lag`. A lag between two neighbours is
a weighted mean of both to 7 % of a step."""


@dataclass(frozen=True)
class ThermalField(Declared):
    """All six component errors of an axis after several drives, each at once and through lags.

    ``E = sum_d [a_d0 d(t) + sum_k a_dk y_dk(t)]``, ``tau_k dy_dk/dt = d - y_dk``, with
    d = T - 20 degC of a sensor, n/(10 000 rpm), or an own column in steps; the speed, which is no
    state of a body, through lags alone. Holds for small errors of a machine that leads heat
    linearly. All amplitudes share one prior, whose size is chosen by what it predicts: the data
    decide how many of them count.

    Reference:
        ISO 230-3; ridge regression of thermal errors on many sensors.
    """

    axis: str  # whose body warms
    drives: tuple[str, ...]  # names of sensors, `spindle_rpm`, or own columns `V_name_unit`
    # steps of the user's own columns among them, in their units; empty for 1 each
    steps: tuple[float, ...] = ()

    kind, called = "thermal-field", "warming of the body of {axis}"
    is_shrunk = True
    needs_history = True

    @cached_property
    def name(self) -> str:
        """`thermal-field(Z,frame,bed)`."""
        return f"thermal-field({','.join((self.axis, *self.drives))})"

    @property
    def places(self) -> Sequence[tuple[str, float]]:
        """Drive and time constant (s, zero for at once) of the amplitudes of one component."""
        at_once = [(d, 0.0) for d in self.drives if not is_speed(d)]
        return (*at_once, *((d, tau) for d in self.drives for tau in LAGS))

    @property
    def parameter_drives(self) -> tuple[str, ...]:
        """The drive of every parameter."""
        return tuple(drive for _ in LETTERS for drive, _ in self.places)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """An amplitude for every component, drive and lag, one component after the other."""
        out = []
        for letter in LETTERS:
            unit, sd = ("mm", 30 * UM) if letter in "XYZ" else ("rad", 100 * URAD)
            for drive, tau in self.places:
                lag = f"{tau / MINUTE:g} min" if tau else "at once"
                own = amplitude_unit(drive, unit, sd)
                out.append(Parameter(f"E{letter} {drive} {lag}", *own))
        return tuple(out)

    def terms(self, touches: Touches) -> Sequence[Term]:
        link = touches.chain.link_index(self.axis)
        step = dict(zip(self._own, self.tuning.values(), strict=True))
        amounts = [driven(touches, d, tau, self.name, step.get(d, 1.0)) for d, tau in self.places]
        return tuple(
            Term(c * len(amounts) + k, Where("twist", link, c), amount)
            for c in range(len(LETTERS))
            for k, amount in enumerate(amounts)
        )

    @property
    def _own(self) -> list[str]:
        return [d for d in self.drives if is_own(d)]

    def inner(self, touches: Touches) -> Sequence[Inner]:
        return [step_inner(touches, d, f"step_{d.removeprefix(OWN)}") for d in self._own]

    def tuned(self, *values: float) -> "ThermalField":
        return replace(self, steps=tuple(map(float, values)))

    @property
    def tuning(self) -> Mapping[str, float]:
        names = [f"step_{d.removeprefix(OWN)}" for d in self._own]
        return dict(zip(names, self.steps or [1.0] * len(names), strict=True))


def make(chain: Chain, arguments: Sequence[str]) -> ThermalField:
    """From the axis and the drives."""
    if len(arguments) < 2 or not all(arguments):
        raise refusal(
            USAGE, arguments, "an axis, then sensors, spindle_rpm or own columns V_name_unit"
        )
    if len(set(arguments)) < len(arguments):
        raise refusal(USAGE, arguments, "every drive once")
    if arguments[0] not in chain.axes:
        raise refusal(USAGE, arguments, f"an axis of {', '.join(chain.axes)}")
    own = [d for d in arguments[1:] if is_own(d)]
    return ThermalField(arguments[0], tuple(arguments[1:]), (1.0,) * len(own))


def propose(touches: Touches) -> Iterable[ThermalField]:
    """None: a field competes with single effects by its prediction error."""
    return ()


def field(touches: Touches) -> ThermalField | None:
    """The axis next to the tool among those that moved, else among all, after every drive that was
    recorded; None where none was.
    """  # noqa: D205
    names = tuple(drives(touches))
    axes = moving_axes(touches) or touches.chain.axes
    steps = tuple(step_of(touches, name) for name in names if is_own(name))
    return ThermalField(axes[-1], names, steps) if names else None


KIND = Kind(
    word="thermal-field",
    arguments="axis,sensor, spindle_rpm or V_column,...",
    title="warming of a body after several drives",
    synonyms="thermal error field, thermal deformation, many sensors, regression, warm-up",
    formula="E = sum of a d + a_k y_k over drives d; tau_k dy_k/dt = d - y_k, tau 4 16 64 256 min",
    units="a: µm or µrad, per K after a sensor, at 10 000 rpm after the spindle, per step of an "
    "own column",
    typical="where many sensors know something: 10 to 100 µm in all",
    source="ISO 230-3; ridge regression on many sensors",
    make=make,
    propose=propose,
    classes=(ThermalField,),
)
