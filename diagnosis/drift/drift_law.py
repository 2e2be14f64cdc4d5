"""An effect that replays a saved law of a drift on the temperatures and speeds of touches.

The outputs of the law, columns of the log that it was learnt from, are bound to component errors of
the machine. What the law does not know of itself are parameters too, so that its uncertainty grows
where drives leave what was trained, and probing a standard improves it.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from matstd.diagnosis.drift.drift_file import SavedLaw, read_law
from matstd.diagnosis.drift.linear import LinearLaw
from matstd.diagnosis.drift.record import DriftRecord, is_speed
from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import component_symbol
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import Parameter, Term, Title, refusal
from matstd.twin.record import Touches
from matstd.twin.units import DEG
from matstd.twin.words import did_you_mean

USAGE = "drift-law(thermal.json,column:EZZ,...)"

_BOUND = re.compile(r"\s*([^:@]+?)\s*:\s*(-?)\s*([A-Z0-9]+)\s*(?:@([^:]+):([^:]+))?\Z")


@dataclass(frozen=True)
class Bound:
    """One output of a law as a component error: the same everywhere, or growing along the axis."""

    column: str
    symbol: Symbol
    sign: float = 1.0  # -1 where the column has the opposite sense
    zero: float = 0.0  # reading at which nothing of it is felt, mm or rad
    # reading at which all of it is felt; equal to `zero` for the same everywhere
    whole: float = 0.0

    @property
    def name(self) -> str:
        """`Z1:EZZ`, `X1:-EXX`, `screw:EYY@-110:35`."""
        unit = DEG if self.symbol.link[0] in "ABC" else 1.0
        ends = f"@{self.zero / unit:g}:{self.whole / unit:g}" if self.zero != self.whole else ""
        return f"{self.column}:{'-' if self.sign < 0.0 else ''}{self.symbol.name}{ends}"

    def share(self, touches: Touches) -> Array:
        """How much of the column is felt at every touch, with its sign, (N,)."""
        if self.zero == self.whole:
            return np.full(len(touches), self.sign)
        reading = touches.reading(self.symbol.link)
        return self.sign * (reading - self.zero) / (self.whole - self.zero)


@dataclass(frozen=True, eq=False)
class Replay:
    """A law at some touches."""

    predicted: Array  # every column, (N, K), base units
    # by how much each unknown of the law changes a column, in units of the standard deviation of
    # what it leaves, (N, M); the unknowns are independent, of variance one
    rows: Array
    elapsed: Array  # since the record began, (N,), s


@dataclass(frozen=True, eq=False)
class DriftLaw:
    """A saved law of a drift (`matstd thermal`), replayed on temperatures and speeds.

    ``E = s (law(T, n, t) + w (root . u + e))``: s the share that a component error has of a column
    (1, -1, or rising along its axis), w the standard deviation of what the law leaves, u its
    unknown coefficients in units of their uncertainty, e what passes: of variance one, forgetting
    itself in the memory m of the law, ``e(t) = exp(-t/m) e(0) + sqrt(1 - exp(-2t/m)) e'``. The
    touches must be the whole run: a machine settled at the temperatures of its first record, cold
    where speeds are concerned at time zero.

    Reference:
        D-MT paper, eq. (4), and 2.3; uncertainty as of `matstd thermal`.
    """

    path: str  # of the law, as it was written
    saved: SavedLaw
    bound: tuple[Bound, ...]
    # whether what is not known of the law are parameters too. A model that is estimated from
    # touches has only the law, 1 if it is right
    has_unknowns: bool = False
    _known: WeakKeyDictionary[Touches, Replay] = field(default_factory=WeakKeyDictionary)

    kind = "drift-law"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, DriftLaw) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    @property
    def name(self) -> str:
        """`drift-law(out/thermal.json,Z1:EZZ)`."""
        return f"drift-law({','.join([self.path, *(b.name for b in self.bound)])})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        moved = ", ".join(dict.fromkeys(b.symbol.name for b in self.bound))
        return Title(f"thermal drift of {moved} by its saved law")

    @property
    def columns(self) -> tuple[int, ...]:
        """Numbers of the outputs that are bound, each once."""
        names = self.saved.components
        return tuple(dict.fromkeys(names.index(b.column) for b in self.bound))

    @property
    def spread(self) -> Array:
        """Standard deviation of what the law leaves, of every output, (K,), base units."""
        return np.asarray(self.saved.factor * self.saved.law.residual)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The law itself, which is one, and where wanted what is not known of every column."""
        out = [Parameter("law", "1", 1.0)]
        for k in self.columns if self.has_unknowns else ():
            name = self.saved.components[k]
            count = self._root.shape[1]
            out += [Parameter(f"{name} coefficient {j + 1}", "1", 1.0) for j in range(count)]
            out += [Parameter(f"{name} {what}", "1", 1.0) for what in ("at first", "later")]
        return out

    @cached_property
    def whole(self) -> "DriftLaw":
        """The same with its unknowns."""
        return replace(self, has_unknowns=True)

    @property
    def known(self) -> tuple[Array, Array]:
        """Parameters of the law as it was saved, (P,), and the root of their covariance, (P, P)."""
        count = len(self.parameters)
        theta, root = np.zeros(count), np.eye(count)
        theta[0], root[0, 0] = 1.0, 0.0
        return theta, root

    def later(self, column: int) -> int:
        """Number of the parameter of what passes in one of `columns`."""
        each = self._root.shape[1] + 2
        return 1 + each * self.columns.index(column) + each - 1

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axes."""
        replay = self.replay(touches)
        fades = np.exp(-replay.elapsed / self.saved.law.memory)
        passing = np.column_stack([fades, np.sqrt(np.maximum(1.0 - fades**2, 0.0))])
        unknown = np.hstack([replay.rows, passing])
        out = []
        for bound in self.bound:
            where, share = touches.chain.twist_of(bound.symbol), bound.share(touches)
            k = self.saved.components.index(bound.column)
            out.append(Term(0, where, share * replay.predicted[:, k]))
            if not self.has_unknowns:
                continue
            first = 1 + unknown.shape[1] * self.columns.index(k)
            size = share * self.spread[k]
            out += [Term(first + j, where, size * row) for j, row in enumerate(unknown.T)]
        return out

    @property
    def _linear(self) -> LinearLaw | None:
        """The part of the law whose coefficients have a covariance."""
        law = self.saved.law
        return law if isinstance(law, LinearLaw) else None

    @cached_property
    def _root(self) -> Array:
        """Root of the covariance of its coefficients per unit of what it leaves, (M, R)."""
        if self._linear is None:
            return np.zeros((0, 0))
        values, vectors = np.linalg.eigh(self._linear.covariance)
        some = values > 1e-12 * values[-1]
        return np.asarray(vectors[:, some] * np.sqrt(values[some]))

    def replay(self, touches: Touches) -> Replay:
        """The law at every touch; every run by itself.

        Raises:
            UnknownEffect: A drive of the law that these touches do not have.
        """
        if touches not in self._known:
            drive = np.column_stack([self._drive(touches, name) for name in self.saved.drives])
            count = len(touches)
            predicted = np.zeros((count, len(self.saved.components)))
            rows, elapsed = np.zeros((count, self._root.shape[1])), np.zeros(count)
            for i in range(len(touches.runs)):
                own = touches.run == i
                if own.any():
                    at = self._of_run(touches.since_start[own], drive[own])
                    predicted[own], rows[own], elapsed[own] = at
            self._known[touches] = Replay(predicted, rows, elapsed)
        return self._known[touches]

    def _of_run(self, time: Array, drive: Array) -> tuple[Array, Array, Array]:
        """Columns, unknowns and time since the begin, for times of one run in any order."""
        order = np.unique(time, return_index=True)[1]
        record = self._record(time[order], drive[order])
        predicted = self.saved.law.predicted(record)
        linear = self._linear
        rows = np.zeros((len(record), 0)) if linear is None else linear.basis(record) @ self._root
        at = np.array([np.interp(time, record.time, c) for c in (*predicted.T, *rows.T)]).T
        count = predicted.shape[1]
        return at[:, :count], at[:, count:], time - min(0.0, float(time.min()))

    def _record(self, time: Array, drive: Array) -> DriftRecord:
        """Drives at equal steps which end at the last time, (rising) times given.

        Temperatures are straight between two records; a speed holds until the next one, and is the
        mean of each step; before time zero the spindle stood.
        """
        step, begin = self.saved.step, min(0.0, float(time[0]))
        count = int(np.ceil((time[-1] - begin) / step - 1e-9)) + 1
        grid = time[-1] - step * np.arange(count)[::-1]
        out = np.empty((count, drive.shape[1]))
        for k, name in enumerate(self.saved.drives):
            if is_speed(name):
                at = np.concatenate([[begin], time])
                set_to = np.concatenate([drive[:1, k], drive[:-1, k]])
                run = np.concatenate([[0.0], np.cumsum(set_to * np.diff(at))])
                turned = np.interp(np.append(grid[0] - step, grid), at, run)
                out[:, k] = np.diff(turned) / step
            else:
                out[:, k] = np.interp(grid, time, drive[:, k])
        return DriftRecord(
            time=grid,
            stretch=np.zeros(count, dtype=np.int64),
            step=step,
            drives=self.saved.drives,
            drive=out,
            components=self.saved.components,
            units=self.saved.units,
            displacement=np.zeros((count, len(self.saved.components))),
        )

    def _drive(self, touches: Touches, name: str) -> Array:
        """One drive of the law at every touch, (N,)."""
        own = name.removeprefix("V_")
        if name in touches.temperature and not is_speed(name):
            return touches.temperature[name]
        if own in touches.value:
            return touches.value[own]
        speeds = [d for d in self.saved.drives if is_speed(d)]
        is_spindle = name in (["spindle_rpm"] if len(speeds) > 1 else speeds)
        if is_spindle and touches.spindle_rpm is not None:
            return np.asarray(touches.spindle_rpm)
        there = [*touches.temperature, *(f"V_{v}" for v in touches.value)]
        there += ["spindle_rpm"] if touches.spindle_rpm is not None else []
        raise UnknownEffect(
            f"{self.path}: its law follows {name}{did_you_mean(name, there)}; there is "
            f"{', '.join(there) or 'none'}"
        )


def bound_of(chain: Chain, saved: SavedLaw, arguments: Sequence[str], text: str) -> Bound:
    """One output that is bound; raises UnknownEffect, UnknownSymbol.

    Args:
        arguments: Of the effect, for messages.
        text: `column:EZZ`, `column:-EXX`, `column:EYY@-110:35`.
    """
    match = _BOUND.match(text)
    example = f"such as {saved.components[0]}:EZZ, or :EYY@-110:35 for one that grows along Y"
    if match is None:
        raise refusal(USAGE, arguments, f"a column and a component error for '{text}', {example}")
    column, sign, name, low, high = match.groups()
    if column not in saved.components:
        known, meant = ", ".join(saved.components), did_you_mean(column, saved.components)
        raise refusal(USAGE, arguments, f"a column of the law for '{column}'{meant}: {known}")
    symbol = component_symbol(chain, name)
    unit = saved.units[saved.components.index(column)]
    if unit != symbol.unit:
        raise refusal(USAGE, arguments, f"a component error in {unit} for '{text}'")
    try:
        ends = (0.0, 0.0) if low is None else (float(low), float(high))
    except ValueError:
        ends = (np.inf, np.inf)
    if not np.isfinite(ends).all() or (low is not None and ends[0] == ends[1]):
        raise refusal(USAGE, arguments, f"two readings after @ for '{text}'")
    # readings in the text are in degrees for a rotary axis, as in all files
    one = DEG if chain.link(symbol.link).kind == "rotary" else 1.0
    return Bound(
        column=column,
        symbol=symbol,
        sign=-1.0 if sign else 1.0,
        zero=ends[0] * one,
        whole=ends[1] * one,
    )


def drift_law_of(chain: Chain, arguments: Sequence[str]) -> DriftLaw:
    """From the file of the law and what its columns move.

    Raises:
        BadFile: No law is in the file.
        UnknownEffect: A column that the law does not have, or another unit.
    """
    if len(arguments) < 2:
        raise refusal(USAGE, arguments, "the file of matstd thermal and what its columns move")
    saved = read_law(arguments[0])
    bound = tuple(bound_of(chain, saved, arguments, text) for text in arguments[1:])
    return DriftLaw(arguments[0], saved, bound)
