"""Servo lag of an axis on a path: a moving axis stands where its command was a moment before."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from matstd.twin.fields import AxisName, moving_linear_axes
from matstd.twin.frames import Array, IntArray
from matstd.twin.model import Amounts, Declared, Kind, Parameter
from matstd.twin.record import Labels, Touches

SPEED_COLUMN = "v{axis}_mm_s"
"""Column of the user's own (`V_vX_mm_s`) that states the speed of an axis, mm/s."""
MAX_STEP_SHARE = 0.02
"""Readings were taken in motion if they differ by less than this share of the travel: 120 points a
circle; targets of a positioning test stand ten times farther apart."""
PAUSE_RATIO = 3.0  # a pause of more than this many median time steps separates two motions


@dataclass(frozen=True)
class ServoLag(Declared):
    """An axis that follows its command with a delay: ``E = -T v``, v its speed.

    On a circle at feed F, two axes that lag alike only fall behind along the path; a difference T
    of their delays makes it an ellipse at 45 degrees, ``dr = -(F T / 2) sin 2 theta`` with the
    other sign the other way round: the mismatch of a ball bar test.

    Reference:
        Kakino, Ihara and Shinohara, Accuracy Inspection of NC Machine Tools by Double Ball Bar
        Method (1993); ISO 230-4 (circular tests).
    """

    axis: AxisName

    kind, called = "servo-lag", "servo lag of {axis} beside the other axes"
    parameters = (Parameter("lag", "s", 3e-4),)

    def amounts(self, touches: Touches) -> Amounts:
        return (-speed(touches, self.axis),)


def speed(touches: Touches, axis: str) -> Array:
    """Speed of an axis at every row, (N,), mm/s: as a column states it, else by its readings.

    Differences are taken over rows that follow one another in time on one feature; where a motion
    has less than three rows, or all have one time, the speed is 0.
    """
    stated = touches.value.get(SPEED_COLUMN.format(axis=axis))
    if stated is not None:
        return stated
    q, out = touches.reading(axis), np.zeros(len(touches))
    for rows in _motions(touches):
        if len(rows) > 2:
            out[rows] = np.gradient(q[rows], touches.time[rows])
    return out


def _motions(touches: Touches) -> list[IntArray]:
    """Rows of every motion without a stop, in the order of time."""
    groups = np.unique(np.column_stack([touches.setup, _numbers(touches.feature)]), axis=0)
    out: list[IntArray] = []
    for setup, feature in groups:
        rows = np.flatnonzero((touches.setup == setup) & (_numbers(touches.feature) == feature))
        rows = rows[np.argsort(touches.time[rows], kind="stable")]
        step = np.diff(touches.time[rows])
        usual = float(np.median(step)) if len(step) else 0.0
        if usual > 0.0:
            out += np.split(rows, np.flatnonzero((step > PAUSE_RATIO * usual) | (step <= 0.0)) + 1)
    return out


def _numbers(feature: Labels) -> IntArray:
    return np.unique(feature, return_inverse=True)[1].reshape(-1).astype(np.int64)


def propose(touches: Touches) -> Iterable[ServoLag]:
    """Linear axes that an instrument beside the machine saw moving together on a path.

    A single axis that runs at one speed lags as it reverses: that is `backlash`.
    """
    on_path = [axis for axis in moving_linear_axes(touches) if _on_the_way(touches, axis)]
    return [ServoLag(axis) for axis in on_path] if len(on_path) > 1 else ()


def _on_the_way(touches: Touches, axis: str) -> bool:
    """Whether rows were taken while the axis moved."""
    if SPEED_COLUMN.format(axis=axis) in touches.value:
        return True
    q = touches.reading(axis)
    steps = [np.abs(np.diff(q[rows])) for rows in _motions(touches) if len(rows) > 2]
    return bool(steps) and float(np.median(np.concatenate(steps))) < MAX_STEP_SHARE * float(
        np.ptp(q)
    )


KIND = Kind.of(
    ServoLag,
    title="servo lag on a path",
    synonyms="servo mismatch, following error, gain mismatch, Kv, velocity error, ball bar "
    "ellipse, circularity at feed, contouring error",
    formula="E = -T v, v the speed of the axis; on a circle dr = -(F (T_X - T_Y)/2) sin 2 theta",
    units="T: ms",
    typical="differences of 0.05 to 1 ms between axes",
    source="Kakino et al. 1993; ISO 230-4 (circular tests, both directions)",
    propose=propose,
    when=lambda touches: not touches.instrument.is_ball_on_standard,
)
