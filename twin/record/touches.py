"""`Touches`: all that is known about N contacts; the record that every room takes."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, IntArray, Mask, apply, inverse, turn
from matstd.twin.machine import (
    Chain,
    Reach,
    ShapeName,
    Where,
    checked_readings,
    linear_motion,
    reach,
    shape,
    table_to_tool,
    tip,
)
from matstd.twin.rows import picked
from matstd.twin.units import T_REF


class Instrument(Enum):
    """Instruments of a run file; the value stands in its head."""

    TOUCH_PROBE = "touch-probe"
    LASER = "laser"
    TRACKER = "tracker"
    DIAL_GAUGE = "dial-gauge"
    ENCODER = "encoder"
    CMM = "cmm"
    BALL_BAR = "ball-bar"
    AUTOCOLLIMATOR = "autocollimator"

    @property
    def is_ball_on_standard(self) -> bool:
        """Whether lobes, radius and bending of a probe, and form and growth of a standard matter.

        A machined part that a CMM measured has no ball of this machine on it.
        """
        return self is Instrument.TOUCH_PROBE

    @property
    def reads_by_the_axes(self) -> bool:
        """Whether the axes move until it responds, so that their readings hold what it measured."""
        return self in (Instrument.TOUCH_PROBE, Instrument.DIAL_GAUGE)

    @property
    def reads_angle(self) -> bool:
        """Whether it feels how the tool turns relative to the table, and no displacement.

        A row then is that angle times the arm p, along n: a point seen together with the one
        opposite, behind the origin of its set-up.
        """
        return self is Instrument.AUTOCOLLIMATOR

    @property
    def has_standard(self) -> bool:
        """Whether something stands on the table that may slip."""
        return self not in (Instrument.ENCODER, Instrument.AUTOCOLLIMATOR)


Labels = NDArray[np.str_]


METRE = 1000.0  # arm, mm, at which a deviation in µm equals the angle in µrad


@dataclass(frozen=True, slots=True)
class Body:
    """The standard as a body that expands."""

    alpha: float  # coefficient of linear expansion, 1/K
    u_alpha: float  # its standard uncertainty, 1/K
    u_temperature: float  # that of its temperature, K, the same error at all touches of a run
    is_known: bool  # whether its temperature is stated; else points stay those of 20 degC
    u_scale: float = 0.0  # relative standard uncertainty of its calibrated lengths at 20 degC


@dataclass(frozen=True, eq=False)
class Setup:
    """One placement of the standard on the table."""

    name: str  # label in the run file
    # pose (4, 4), takes artefact coordinates to table coordinates
    T_table_artefact: Array = field(default_factory=lambda: np.eye(4))
    run: str = ""  # name of the run that it belongs to, where several were joined
    start: float = 0.0  # time at which that run started, s
    body: Body | None = None  # the standard as it expands; None where the run does not state it
    # point at which the standard is held, artefact frame, mm; None where the run does not state it
    fixing: tuple[float, float, float] | None = None


def no_labels() -> Labels:
    """Labels that are not stated: a record gives as many empty ones as it has touches."""
    return np.zeros(0, dtype="U1")


def no_numbers() -> IntArray:
    """The same of whole numbers."""
    return np.zeros(0, dtype=np.int64)


def check_rows(
    record: object, n: int, defaults: Mapping[str, NDArray[Any]], names: Iterable[str], like: str
) -> None:
    """Fill the empty fields of a record; refuse columns of other than n rows."""
    for name, default in defaults.items():
        if len(getattr(record, name)) == 0:
            object.__setattr__(record, name, default)
    for name in names:
        value = getattr(record, name)
        if value is not None and len(value) != n:
            raise ShapeMismatch(f"{name} has {len(value)} rows, expected {n} as {like}")


class Signature:
    """Deviation along the normal per unit of every entry of a contribution, first order.

    The ball moves relative to the standard by the tip's deviation minus the standard's shift; a
    controller that believes in the nominal machine sees the surface stand outside by minus the
    normal part of that, plus the bias.
    """

    def __init__(self, reached: Reach, normal: Array) -> None:
        self.twist = -np.einsum("nlci,ni->nlc", reached.twist, normal)
        self.place = -np.einsum("nlci,ni->nlc", reached.place, normal)
        self.shift = normal
        self.bias = np.ones(len(normal))

    def paired(self, opposite: "Signature") -> "Signature":
        """The mean with that of opposite points, whose displacements cancel."""
        self.twist = 0.5 * (self.twist + opposite.twist)
        self.place = 0.5 * (self.place + opposite.place)
        self.shift = 0.5 * (self.shift + opposite.shift)
        return self

    def of(self, where: Where) -> Array:
        """Deviation along the normal per unit of one entry, (N,)."""
        return getattr(self, where.part)[where.entry]


@dataclass(frozen=True, eq=False)
class Touches:
    """N contacts of a probe with a standard (or readings of any instrument along a direction)."""

    chain: Chain
    q: Array  # axis readings at the trigger, (N, A), mm and rad
    length: Array  # probe length to the ball centre, (N,), mm
    radius: Array  # radius of the ball, (N,), mm
    point: Array  # calibrated contact point, artefact frame, (N, 3), mm
    normal: Array  # outward unit normal there, artefact frame, (N, 3)
    setups: tuple[Setup, ...]  # the placements of the standard
    setup: IntArray  # index into `setups`, (N,)
    time: Array  # s since the start of the run, of joined runs of the first one, (N,)
    approach: Array  # sign of the last motion of each axis, (N, A); 0 where unknown
    temperature: Mapping[str, Array] = field(default_factory=dict)  # degC by sensor name, each (N,)
    spindle_rpm: Array | None = None  # (N,), or None where it was not recorded
    force: Array | None = None  # load on the tool in table-frame directions, (N, 3), N
    feature: Labels = field(default_factory=no_labels)  # label of the touched feature, (N,)
    pose: IntArray = field(default_factory=no_numbers)  # label of the table pose, (N,)
    instrument: Instrument = Instrument.TOUCH_PROBE  # what measured them all
    # columns of the user's own by name and unit (`coolant_l_min`), each (N,)
    value: Mapping[str, Array] = field(default_factory=dict)
    # ball centre, or reflector, relative to the tool axis, x and y of the tool frame, (N, 2), mm;
    # on the axis where nothing is given
    offset: Array = field(default_factory=lambda: np.zeros((0, 2)))
    # the same without what was measured, (N, A), which is what errors are functions of; None where
    # `q` is that already (`with_commanded`)
    commanded: Array | None = None
    # of the standard where stated, else 20, (N,), degC
    body_temperature: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        n = len(checked_readings(self.chain, self.q))
        defaults = {
            "feature": np.full(n, "", dtype="U1"),
            "offset": np.zeros((n, 2)),
            "pose": np.zeros(n, dtype=np.int64),
            "body_temperature": np.full(n, T_REF),
        }
        check_rows(self, n, defaults, PER_TOUCH, "in q")
        own = {f"temperature {name}": v for name, v in self.temperature.items()}
        own |= {f"column {name}": v for name, v in self.value.items()}
        for name, value in own.items():
            if len(value) != n:
                raise ShapeMismatch(f"{name} has {len(value)} rows, expected {n}")

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, rows: Mask | IntArray | slice) -> "Touches":
        """The touches of some rows, as a new record."""
        return picked(self, rows)

    def reading(self, axis: str) -> Array:
        """Commanded reading of one axis, (N,), mm or rad; raises UnknownAxis.

        Where readings hold the measured value and its noise, `commanded` is used instead.
        """
        q = self.q if self.commanded is None else self.commanded
        return q[:, self.chain.axis_index(axis)]

    def shape(self, axis: str, name: ShapeName, periods: float, phase: float) -> Array:
        """`matstd.twin.machine.shape` of one axis, made once for its six errors, (N,)."""
        key = axis, name, periods, phase
        if key not in self._shapes:
            made = shape(name, self.reading(axis), self.chain.link(axis), periods, phase)
            made.flags.writeable = False
            self._shapes[key] = made
        return self._shapes[key]

    @cached_property
    def _shapes(self) -> dict[tuple[str, ShapeName, float, float], Array]:
        return {}

    def last_move(self, axis: str) -> Array:
        """Sign of the last motion of one axis, (N,); raises UnknownAxis."""
        return self.approach[:, self.chain.axis_index(axis)]

    @cached_property
    def runs(self) -> tuple[str, ...]:
        """Names of the runs that were joined, in their order; one name for a single run."""
        return tuple(dict.fromkeys(s.run for s in self.setups))

    @cached_property
    def run(self) -> IntArray:
        """Index into `runs`, (N,)."""
        return np.array([self.runs.index(s.run) for s in self.setups], dtype=np.int64)[self.setup]

    @cached_property
    def since_start(self) -> Array:
        """Time since the start of its own run at every touch, (N,), s."""
        return np.asarray(self.time - np.array([s.start for s in self.setups])[self.setup])

    @property
    def target(self) -> Array:
        """Ball centre, or reflector, in the tool frame, (N, 3), mm."""
        return np.column_stack([self.offset, -self.length])

    @cached_property
    def T_table_artefact(self) -> Array:
        """Pose of the standard at every touch, (N, 4, 4)."""
        return np.stack([s.T_table_artefact for s in self.setups])[self.setup]

    @cached_property
    def point_table(self) -> Array:
        """Contact points in the table frame, (N, 3), mm."""
        return apply(self.T_table_artefact, self.point)

    @cached_property
    def fixing_table(self) -> Array:
        """Where the standard is held, table frame, (N, 3), mm; not a number where not stated."""
        unknown = (np.nan, np.nan, np.nan)
        held = np.array([s.fixing or unknown for s in self.setups])[self.setup]
        return apply(self.T_table_artefact, held)

    @cached_property
    def normal_table(self) -> Array:
        """Outward normals in the table frame, (N, 3)."""
        return turn(self.T_table_artefact, self.normal)

    @cached_property
    def growth(self) -> Array:
        """Growth of the surface along its normal from 20 degC, (N,), mm: ``alpha dT n . (p - f)``.

        It grows from the point f at which it is held, or from the origin of its frame.
        """
        alpha = np.array([0.0 if s.body is None else s.body.alpha for s in self.setups])[self.setup]
        held = np.array([s.fixing or (0.0, 0.0, 0.0) for s in self.setups])[self.setup]
        along = np.einsum("ni,ni->n", self.normal, self.point - held)
        return np.asarray(alpha * (self.body_temperature - T_REF) * along)

    @cached_property
    def ball_artefact(self) -> Array:
        """Nominal ball centre in the artefact frame, (N, 3), mm."""
        return apply(inverse(self.T_table_artefact), tip(self.chain, self.q, self.target))

    @cached_property
    def reach(self) -> Reach:
        """First-order deviations of the ball centre per unit of every error."""
        return reach(self.chain, self.q, self.target)

    @cached_property
    def signature(self) -> Signature:
        """First-order deviation along the normal per unit of every entry of a contribution."""
        own = Signature(self.reach, self.normal_table)
        if not self.instrument.reads_angle:
            return own
        other = self.opposite
        return own.paired(Signature(other.reach, other.normal_table))

    @property
    def deviation_unit(self) -> str:
        """Unit in which deviations are reported: µrad for angles at an arm of one metre."""
        is_metre = np.allclose(np.linalg.norm(self.point, axis=1), METRE, atol=1e-6)
        return "µrad" if self.instrument.reads_angle and is_metre else "µm"

    @cached_property
    def opposite(self) -> "Touches":
        """The points opposite each touch, behind the origin of its set-up."""
        point = -self.point
        tool = inverse(table_to_tool(self.chain, self.q))
        at = apply(tool, apply(self.T_table_artefact, point))
        return replace(self, point=point, normal=-self.normal, offset=at[:, :2], length=-at[:, 2])


MAPS = ("temperature", "value")
_COMMON = ("chain", "setups", "instrument", *MAPS)
PER_TOUCH = [f.name for f in fields(Touches) if f.name not in _COMMON]


def at_poses(chain: Chain, q: Array, length: Array | float) -> Touches:
    """Poses without a standard, for maps over the workspace: normals are zero."""
    q = checked_readings(chain, q)
    n = len(q)
    return Touches(
        chain=chain,
        q=q,
        length=np.broadcast_to(np.asarray(length, dtype=float), (n,)).copy(),
        radius=np.zeros(n),
        point=tip(chain, q, length),
        normal=np.zeros((n, 3)),
        setups=(Setup("table"),),
        setup=np.zeros(n, dtype=np.int64),
        time=np.zeros(n),
        approach=np.zeros((n, len(chain.axes))),
    )


def linear_approach(chain: Chain, q: Array, normal_table: Array) -> Array:
    """Signs of the last motion of the linear axes of a touch against the normal, (N, A).

    With the outward normals in the table frame, (N, 3); 0 in the columns of other axes.
    """
    velocity = linear_motion(chain, q, -normal_table)
    return np.where(np.abs(velocity) > 1e-9, np.sign(velocity), 0.0)


def implied_approach(touches: Touches) -> Array:
    """Signs of the last motions where a run does not state them, (N, A).

    Those of touches follow from their normals; an encoder is read while the axes move.
    """
    if touches.instrument is Instrument.ENCODER:
        return motion(touches.q, touches.time)
    return linear_approach(touches.chain, touches.q, touches.normal_table)


def last_signs(moves: Array) -> Array:
    """The last sign of every column up to every row, (N, A): zeros keep the sign before them."""
    moved = np.where(moves != 0.0, np.arange(len(moves))[:, None], 0)
    return np.take_along_axis(moves, np.maximum.accumulate(moved, axis=0), axis=0)


def motion(q: Array, time: Array) -> Array:
    """Signs of the last motion of every axis in a log that was read on the way, (N, A).

    An axis that stands keeps its sign. In the last row before a reversal the axis may have turned
    already, so the sign is 0. Rows of one time, s, are in order.

    Example:
        >>> motion(np.array([0.0, 1.0, 2.0, 2.0, 1.5])[:, None], np.arange(5.0))[:, 0]
        array([ 1.,  1.,  1.,  0., -1.])
    """
    order = np.argsort(time, kind="stable")
    signs = last_signs(np.sign(np.diff(q[order], axis=0, prepend=q[order][:1])))
    signs[0] = signs[min(1, len(q) - 1)]
    signs[:-1][signs[:-1] * signs[1:] < 0.0] = 0.0
    out = np.empty_like(signs)
    out[order] = signs
    return out


def computed_deviation(touches: Touches) -> Array:
    """Measured deviation of every touch from its readings, (N,), mm.

    ``dev = n . (nominal ball centre - p) - radius - growth``: the signed distance along the normal
    by which a controller that believes in the nominal machine sees the surface outside its place,
    at the temperature of the standard.
    """
    offset = touches.ball_artefact - touches.point
    return np.einsum("ni,ni->n", touches.normal, offset) - touches.radius - touches.growth
