"""How surely measurements on a standard show a smooth, unmodelled effect of the machine.

Such an effect displaces the tool along one linear axis. It is a short error of one axis, a bump
over its reading, or a field over the readings of all linear axes, as if such bumps were everywhere:

    f(touch) = n^T a_d g(q),   a_d direction of axis d in the frame of the normal n
    bump     g = A exp(-4 ln 2 (q_i - q_0)^2 / w^2)       w full width at half of the height
    field    cov(g(q), g(q')) = size^2 exp(-2 ln 2 |q - q'|^2 / w^2)

Both are `SIZE` rms over the volume of the standard. Set-up, the errors of the model and the
calibration with the form of the faces explain what they can of it; what is left is tested as one
smooth field (`matstd.information.power`) of which place, direction and width are not known.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth import Criterion
from matstd.information.power import FieldTest, decorrelated, field_test, low_rank
from matstd.sensitivity.first_order import Box
from matstd.twin.frames import Array, IntArray, turn
from matstd.twin.machine import linear_directions
from matstd.twin.units import UM

FIELD_WIDTHS, BUMP_WIDTHS = (40.0, 25.0), (40.0, 20.0)
"""Full widths at half of the height of the effects that are asked for, mm: what a carriage or a
nut of a ball screw averages over."""

SIZE = 2.0 * UM  # root mean square of an effect over the volume of the standard, mm
FALSE_FINDING = 0.05  # probability of finding one where there is none

FORM_LENGTH = 6.0
"""Distance over which form errors of a calibrated face remain alike, mm: pitch of its points."""

_BUMP, _FIELD = 4.0 * np.log(2.0), 2.0 * np.log(2.0)  # in the exponents above
_PLACES = 40  # at which a bump may be, averaged
_LEFT_OUT = 1e-2  # share of the variance of a field that its factor may leave out


@dataclass(frozen=True, eq=False)
class Measurement:
    """Touches and points of scans as they will be measured."""

    touches: Requests
    u: Array  # standard uncertainty of every row by its noise alone, (N,), mm
    memory: Array  # correlation of its noise with that of the row before, (N,); 0 for touches

    def __len__(self) -> int:
        return len(self.touches)


def touched(touches: Requests, noise: float) -> Measurement:
    """Single touches with independent noise, mm."""
    return Measurement(touches, np.full(len(touches), noise), np.zeros(len(touches)))


def measured_together(parts: Sequence[Measurement]) -> Measurement:
    """Several lots as one, in their order."""
    return Measurement(
        joined([part.touches for part in parts]),
        np.concatenate([part.u for part in parts]),
        np.concatenate([part.memory for part in parts]),
    )


@dataclass(frozen=True)
class HiddenEffect:
    """Effects of one kind that a machine may have."""

    # whether it is a short error of one axis, whichever; else a field over all of them
    is_bump: bool
    width: float  # full width at half of the height, mm
    direction: str  # linear axis along which it displaces the tool


@dataclass(frozen=True, eq=False)
class HiddenPower:
    """How surely some measurements show hidden effects."""

    effects: tuple[HiddenEffect, ...]  # kinds of effects, K of them
    # root of the mean noncentrality of each, (K,): in how many standard deviations it would show to
    # a test that knew it
    signal: Array
    # probability of detection by the test of smooth fields, at a risk of `FALSE_FINDING`, (K,)
    power: Array

    @property
    def worst(self) -> int:
        """The kind that shows least."""
        return int(np.argmin(self.signal))

    @property
    def least_signal(self) -> float:
        """Signal of the kind that shows least: what is compared, because powers end at one."""
        return float(self.signal[self.worst])


def hidden_effects(reach: ProbeReach) -> tuple[HiddenEffect, ...]:
    """Every kind of effect of a machine: fields, then bumps, along each of its linear axes."""
    kinds = [(False, width) for width in FIELD_WIDTHS] + [(True, width) for width in BUMP_WIDTHS]
    return tuple(HiddenEffect(*kind, along) for kind in kinds for along in reach.chain.linear_axes)


def possible_places(
    reach: ProbeReach, volume: Box, poses: Array, rng: np.random.Generator
) -> Array:
    """Readings of the linear axes at which bumps may sit, (K, 3), mm.

    At random points of the volume that a standard fills, at random table poses of those at which it
    is measured: the same for every artefact that is compared.
    """
    low, high = np.array(volume)
    point = rng.uniform(low, high, (_PLACES, 3))
    at = poses[rng.integers(0, len(poses), _PLACES)]
    normal = np.tile([0.0, 0.0, 1.0], (_PLACES, 1))
    return _linear(reach, reach.readings(Requests(np.full(_PLACES, ""), point, normal, at)))


def hidden_power(
    criterion: Criterion, measured: Measurement, places: Array, with_power: bool = True
) -> HiddenPower:
    """How surely some measurements show effects that no model has.

    Args:
        criterion: On the standard, whose calibration counts.
        places: Where bumps may be, readings of the linear axes, (K, 3), mm.
        with_power: False for the signals alone, in a fifth of the time.
    """
    effects = hidden_effects(criterion.reach)
    test = _field_test(criterion, _At.of(criterion.reach, measured), with_power)
    F, first = effect_columns(criterion, measured, places)
    signals = np.sqrt(np.add.reduceat(test.signal(F) ** 2, first))
    powers = np.full(len(effects), np.nan)
    for k, effect in enumerate(effects if with_power else ()):
        mine = F[:, first[k] :][:, : np.diff(first, append=F.shape[1])[k]]
        if effect.is_bump:
            powers[k] = test.power(np.sqrt(mine.shape[1]) * mine).mean()
        else:
            powers[k] = test.power_of_field(mine)
    return HiddenPower(effects, signals, powers)


@dataclass(frozen=True, eq=False)
class _At:
    """Readings (N, 3) and directions along the normals (N, 3) of some measurements."""

    measured: Measurement
    axes: tuple[str, ...]
    q: Array
    lever: Array

    @staticmethod
    def of(reach: ProbeReach, measured: Measurement) -> "_At":
        """The measurements on a machine."""
        readings = reach.readings(measured.touches)
        along = linear_directions(reach.chain, readings)
        normal = turn(reach.setup.T_table_artefact, measured.touches.normal)
        return _At(
            measured=measured,
            axes=tuple(reach.chain.linear_axes),
            q=_linear(reach, readings),
            lever=np.einsum("nim,ni->nm", along, normal),
        )

    def decorrelated(self, columns: Array) -> Array:
        """Columns in mm in units of independent noise."""
        return decorrelated(columns, self.measured.u, self.measured.memory)

    def along(self, effect: HiddenEffect) -> Array:
        """Deviation per displacement along the direction of an effect, (N, 1)."""
        return self.lever[:, [self.axes.index(effect.direction)]]

    def bumps(self, effect: HiddenEffect, places: Array) -> Array:
        """Deviations of a bump of each axis at every place, (N, 3 K), mm.

        `SIZE` is its root mean square over the range of the places.
        """
        out = []
        for q, centre in zip(self.q.T, places.T, strict=True):
            span = max(float(np.ptp(centre)), effect.width)
            # the square of the bump has the integral A^2 w sqrt(pi / (8 ln 2))
            peak = SIZE * np.sqrt(span / (effect.width * np.sqrt(np.pi / (2.0 * _BUMP))))
            out.append(peak * np.exp(-_BUMP * (q[:, None] - centre) ** 2 / effect.width**2))
        return np.asarray(self.along(effect) * np.concatenate(out, axis=1))

    def field(self, width: float) -> Array:
        """Factor of the covariance of a field along one direction, (N, M), mm."""
        n = len(self.q)

        def column(i: int) -> Array:
            square = _squares(self.q, self.q[i])
            return np.asarray(SIZE**2 * np.exp(-_FIELD * square / width**2))

        return low_rank(np.full(n, SIZE**2), column, _LEFT_OUT)[0]

    def any_field(self) -> Array:
        """Factor of the covariance of any effect: every kind as probable as every other, (N, M)."""
        widths = [(self.q, w) for w in FIELD_WIDTHS]
        widths += [(self.q[:, [i]], w) for i in range(len(self.axes)) for w in BUMP_WIDTHS]
        size = SIZE**2 / len(widths)

        def column(i: int) -> Array:
            alike = sum(np.exp(-_FIELD * _squares(q, q[i]) / w**2) for q, w in widths)
            return np.asarray(size * alike * (self.lever @ self.lever[i]))

        return low_rank(SIZE**2 * np.sum(self.lever**2, axis=1), column, _LEFT_OUT)[0]


def explained_columns(criterion: Criterion, measured: Measurement) -> Array:
    """Columns of model, set-up and calibration, in units of prior and noise, (N, B)."""
    touches = measured.touches
    explained = [criterion.noise * criterion.whitened(touches)]
    if criterion.body is not None:
        explained.append(criterion.calibration.columns(criterion.body, touches))
    return decorrelated(np.concatenate(explained, axis=1), measured.u, measured.memory)


def effect_columns(
    criterion: Criterion, measured: Measurement, places: Array
) -> tuple[Array, IntArray]:
    """Every effect of `hidden_effects` as columns in units of the noise, (N, M).

    The sum of the squares of the signals of an effect's columns is that of the effect.

    Returns:
        The columns, and the first one of every effect, (E,).
    """
    at, columns, fields = _At.of(criterion.reach, measured), list[Array](), dict[float, Array]()
    for effect in hidden_effects(criterion.reach):
        if effect.is_bump:
            bumps = at.bumps(effect, places)
            columns.append(bumps / np.sqrt(bumps.shape[1]))
            continue
        if effect.width not in fields:
            fields[effect.width] = at.field(effect.width)
        columns.append(at.along(effect) * fields[effect.width])
    first = np.cumsum([0, *(one.shape[1] for one in columns[:-1])])
    return at.decorrelated(np.concatenate(columns, axis=1)), first


def _field_test(criterion: Criterion, at: _At, with_power: bool) -> FieldTest:
    """The test for any effect beside all that the model and the calibration explain."""
    B = explained_columns(criterion, at.measured)
    if criterion.body is not None:
        form = form_columns(criterion.body, at.measured.touches, criterion.calibration.form)
        B = np.concatenate([B, at.decorrelated(form)], axis=1)
    F = at.any_field() if with_power else SIZE * at.lever
    return field_test(B, at.decorrelated(F), FALSE_FINDING)


def form_columns(body: Standard, touches: Requests, u: float) -> Array:
    """Form errors of the calibrated faces as columns of unit priors, (N, Q), mm.

    Points of one face share them at every table pose, as far as they are close to each other.
    """
    out = []
    for patch in body.patches if u > 0.0 else ():
        rows: IntArray = np.flatnonzero(touches.feature == patch.name)
        if not len(rows):
            continue
        point = touches.point[rows]

        def column(i: int, at: Array = point) -> Array:
            square = _squares(at, at[i])
            return np.asarray(u**2 * np.exp(-0.5 * square / FORM_LENGTH**2))

        own = low_rank(np.full(len(rows), u**2), column, _LEFT_OUT)[0]
        columns = np.zeros((len(touches), own.shape[1]))
        columns[rows] = own
        out.append(columns)
    return np.concatenate(out, axis=1) if out else np.zeros((len(touches), 0))


def _linear(reach: ProbeReach, readings: Array) -> Array:
    """Readings of the linear axes alone, (N, 3)."""
    return readings[:, reach.chain.linear_columns]


def _squares(points: Array, place: Array) -> Array:
    """Squares of the distances of points (N, D) from a place (D,), (N,)."""
    return np.asarray(np.sum((points - place) ** 2, axis=-1))
