"""Component errors of a machine as tables over the readings that each depends on.

At one moment nearly every error is a function of one reading, or of two, and of the direction in
which an axis arrived. On which ones is found out by trying: an effect is asked at random poses with
one reading changed. Tables are made finer until straight lines between their points leave less than
a stated amount; a table that follows temperatures is made again on the same points.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from matstd.compensation.field import MachineErrors, State
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, contribution
from matstd.twin.record import Touches, at_poses
from matstd.twin.units import HOUR, NM

MAX_MOMENTS = 4000
"""Moments that are kept; then every other one goes, so that old ones stand wider apart."""


@dataclass(frozen=True, eq=False)
class History:
    """States of a machine in their order, the present one last."""

    states: tuple[State, ...]

    def __len__(self) -> int:
        return len(self.states)

    @property
    def now(self) -> State:
        """The present state."""
        return self.states[-1]

    def then(self, state: State) -> "History":
        """The history with one more moment; raises DesignError."""
        last = self.now
        if not state.time > last.time:
            raise DesignError(f"time {state.time:g} s, expected later than {last.time:g} s")
        own, before = (", ".join(sorted(s.temperature)) or "none" for s in (state, last))
        if own != before:
            raise DesignError(f"sensors {own}, expected {before}")
        states = (*self.states, state)
        return History(states if len(states) <= MAX_MOMENTS else (*states[:-1:2], state))

    def touches(
        self, chain: Chain, q: Array, length: Array | float, approach: Array | None = None
    ) -> Touches:
        """Poses at the present moment, behind a pose at every moment before and now.

        Returns:
            As many touches as there are moments, then the N.
        """
        n, before = len(q), len(self)
        states = (*self.states, *(self.now,) * n)
        at = at_poses(chain, np.concatenate([np.tile(q[:1], (before, 1)), q]), length)
        ways = np.zeros_like(at.approach)
        if approach is not None:
            ways[before:] = approach
        speeds = [s.spindle_rpm for s in states]
        return replace(
            at,
            time=np.array([s.time for s in states]),
            approach=ways,
            temperature=_columns([s.temperature for s in states]),
            value=_columns([s.value for s in states]),
            spindle_rpm=None if None in speeds else np.array(speeds, dtype=float),
        )


def _columns(rows: list[Mapping[str, float]]) -> dict[str, Array]:
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


MAX_INTERPOLATION = 2.0 * NM
"""What straight lines between the points of one table may leave at its middles, mm at the tip."""

_POSES = 12  # random ones at which an effect is asked on what it depends
_FEWEST_PLACES = 17  # points of a table along a reading
_MOST = {1: 4097, 2: 513}  # most points, by the number of readings
_INDEPENDENT = 1e-15  # mm or rad: by which an error differs that does not depend on a reading

Terms = list[tuple[Effect, Array]]


@dataclass(frozen=True, eq=False)
class ErrorTable:
    """Errors of links over the same readings, in the same direction."""

    errors: MachineErrors
    terms: Terms  # effects that are in it, with their parameters
    length: float  # length of the tool, mm
    axes: tuple[int, ...]  # numbers of the readings, none to two
    # direction of some axes in which it holds, -1, 0 or 1 by the axis's number
    turns: dict[int, int]
    # whether it changes with time, temperatures, speed or columns of the user's own
    is_driven: bool = False
    counts: tuple[int, ...] = ()  # points along each reading
    # component errors of the links, (*points, L, 6), mm and rad
    rows: Array = field(default_factory=lambda: np.zeros((0, 6)))
    # what straight lines leave at the middles between the points, mm at the tip
    left: float = np.inf

    @property
    def ends(self) -> Array:
        """Smallest and largest reading along each axis, (D, 2), mm or rad."""
        chain = self.errors.chain
        return np.array([chain.link(chain.axes[k]).range for k in self.axes]).reshape(-1, 2)

    @property
    def step(self) -> Array:
        """Between two points along each reading, (D,); all of an axis without travel is one."""
        width = self.ends[:, 1] - self.ends[:, 0]
        return np.where(width > 0.0, width, 1.0) / (np.array(self.counts) - 1)

    def refined(self, close: float) -> "ErrorTable":
        """Twice as fine until the middles between the points are close; raises DesignError."""
        counts, table = np.full(len(self.axes), _FEWEST_PLACES), self
        while True:
            table = replace(table, counts=tuple(map(int, counts))).following(None)
            left = np.array([table._at_middles(k) for k in range(len(counts))])
            if left.sum() <= close:
                return replace(table, left=float(left.sum()))
            if counts.max() >= _MOST[len(counts)]:
                named = ", ".join(effect.name for effect, _ in self.terms[:3])
                found = (
                    f"{named}: {counts.max()} points leave {left.sum() / NM:.3g} nm between them"
                )
                raise DesignError(
                    f"{found} and {close / NM:g} nm are wanted: too steep for a table"
                )
            counts = np.where(left > 0.5 * close / len(counts), 2 * counts - 1, counts)

    def following(
        self, history: History | None, learnt: Mapping[str, Array] | None = None
    ) -> "ErrorTable":
        """The same points at the end of a history; None for the state of the errors.

        Args:
            learnt: Parameters that are other ones by now, by the name of their effect.
        """
        if learnt:
            terms = [(effect, learnt.get(effect.name, theta)) for effect, theta in self.terms]
            return replace(self, terms=terms).following(history)
        rows = self._at(self._lines, history)
        return replace(self, rows=rows.reshape(*self.counts, *rows.shape[1:]))

    @property
    def _lines(self) -> list[Array]:
        """Points along each reading."""
        return [np.linspace(a, b, n) for (a, b), n in zip(self.ends, self.counts, strict=True)]

    def _at_middles(self, along: int) -> float:
        """Largest difference to straight lines at the middles along one reading, mm at the tip."""
        lines = self._lines
        lines[along] = 0.5 * (lines[along][1:] + lines[along][:-1])
        exact, rows = self._at(lines, None), np.moveaxis(self.rows, along, 0)
        middle = np.moveaxis(0.5 * (rows[1:] + rows[:-1]), 0, along).reshape(exact.shape)
        levers = np.r_[np.ones(3), np.full(3, _lever(self.errors, self.length))]
        return float((np.abs(exact - middle) * levers).sum(axis=(1, 2)).max(initial=0.0))

    def _at(self, lines: list[Array], history: History | None) -> Array:
        """Errors of the links at a grid of readings, (N, L, 6); other axes in their middle."""
        chain, count = self.errors.chain, int(np.prod([len(line) for line in lines]))
        points = np.stack(np.meshgrid(*lines, indexing="ij"), -1) if lines else np.zeros(0)
        q = np.tile(chain.travels.mean(axis=1), (count, 1))
        q[:, list(self.axes)] = points.reshape(count, len(lines))
        approach = np.zeros_like(q)
        for axis, sign in self.turns.items():
            approach[:, axis] = sign
        return _twist(self.errors, self.terms, q, approach, self.length, history)


def error_tables(
    errors: MachineErrors, length: float, close: float = MAX_INTERPOLATION
) -> list[ErrorTable]:
    """Tables of everything that twists a link; displaced lines of axes are not in them.

    Args:
        close: What straight lines between the points of one table may leave, mm at the tip.

    Raises:
        DesignError: An error depends on more than two readings or on the directions of several
            axes, or is too steep for a table.
    """
    groups: dict[tuple[tuple[int, ...], tuple[int, ...], bool], Terms] = {}
    for effect, theta in zip(errors.effects, errors.theta, strict=True):
        if theta.any():
            key = _dependence(errors, effect, theta, length)
            groups.setdefault(key, []).append((effect, theta))
    out = []
    for (axes, turns, is_driven), terms in groups.items():
        for signs in product((-1, 0, 1), repeat=len(turns)):
            way = dict(zip(turns, signs, strict=True))
            table = ErrorTable(
                errors=errors, terms=terms, length=length, axes=axes, turns=way, is_driven=is_driven
            )
            table = table.refined(close)
            if table.rows.any() or is_driven:
                out.append(table)
    return out


def _dependence(
    errors: MachineErrors, effect: Effect, theta: Array, length: float
) -> tuple[tuple[int, ...], tuple[int, ...], bool]:
    """Readings and directions on which an effect depends, and whether it changes with the state."""
    chain, rng, terms = errors.chain, np.random.default_rng(0), [(effect, theta)]
    low, high = chain.travels.T
    # found by trial, as for a user's own effect: each reading is changed alone at random poses
    q, other = rng.uniform(low, high, (2, _POSES, len(low)))
    still = np.zeros_like(q)
    at = _twist(errors, terms, q, still, length)
    axes, turns = [], []
    for k in range(len(low)):
        changed, ways = q.copy(), still.copy()
        changed[:, k], ways[:, k] = other[:, k], 1.0
        if _differs(at, _twist(errors, terms, changed, still, length)):
            axes.append(k)
        if _differs(at, _twist(errors, terms, q, ways, length)):
            turns.append(k)
    if len(axes) > max(_MOST) or len(turns) > 1:
        named = ", ".join(chain.axes[k] for k in (axes if len(axes) > max(_MOST) else turns))
        raise DesignError(
            f"{effect.name} depends on {named}: what corrects while the machine moves has tables "
            "over two readings and one direction at most; --switch leaves the effect out"
        )
    later = replace(errors, state=_later(errors))
    is_driven = _differs(at, _twist(later, terms, q, still, length))
    return tuple(axes), tuple(turns), is_driven


def _later(errors: MachineErrors) -> State:
    """Another state: an hour later, everything warmer and faster."""
    state = errors.state
    return replace(
        state,
        time=state.time + HOUR,
        temperature={name: value + 1.0 for name, value in state.temperature.items()},
        value={name: value + 1.0 for name, value in state.value.items()},
        spindle_rpm=None if state.spindle_rpm is None else state.spindle_rpm + 1000.0,
    )


def _differs(a: Array, b: Array) -> bool:
    return bool(np.abs(a - b).max() > _INDEPENDENT)


def _twist(
    errors: MachineErrors,
    terms: Terms,
    q: Array,
    approach: Array,
    length: float,
    history: History | None = None,
) -> Array:
    """Component errors of the links at some poses, (N, L, 6); none of workpiece and tool."""
    if history is None:
        touches, before = errors.touches(q, length, approach), 0
    else:
        touches, before = history.touches(errors.chain, q, length, approach), len(history)
    twist = contribution(terms, touches).twist[before:]
    twist[:, [i for i, link in enumerate(errors.chain.links) if link.kind == "fixed"]] = 0.0
    return np.asarray(twist)


def _lever(errors: MachineErrors, length: float) -> float:
    """Longest way from a point that angular errors turn about to the tip, mm."""
    chain = errors.chain
    travels = [np.ptp(chain.link(a).range) for a in chain.linear_axes]
    points = [float(np.linalg.norm(link.point)) for link in chain.links]
    return float(np.linalg.norm(travels)) + max(points) + length
