"""A part program compensated by the inverse of the exact twin, and what that does on the twin."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from matstd.compensation.field import MachineErrors, actual_tip, aligned, shifted
from matstd.compensation.part_programs import Keep, Motion, Program
from matstd.compensation.programs.path import ProgramPath, are_first, shares_of_lines
from matstd.compensation.programs.times import Timed, in_time
from matstd.compensation.tables import Header, point_spacing
from matstd.twin.display import Displayed
from matstd.twin.errors import OutsideTravel
from matstd.twin.frames import Array, IntArray, Mask, unit
from matstd.twin.machine import tip
from matstd.twin.record import Touches
from matstd.twin.sampling import spread_rows
from matstd.twin.units import DEG, MINUTE, UM

CHECKED_SHARES = (0.25, 0.5, 0.75)
"""Shares of a line at which it is checked: the error of a chord is a parabola, largest in its
middle; that of a jump of the error is not."""

LINES_PER_BLOCK = 20_000  # lines that are checked together: bounds the memory


def off_path(path: ProgramPath, which: IntArray, share: Array, written: Array) -> Array:
    """Largest distance of the tool point from the path of the program inside every line, (N,), mm.

    The control moves all axes in proportion from one end of a line to the next; the exact twin says
    where the tool point then is. Its distance is taken square to the nominal path, so that a tool
    which is early or late on the path is not off it. nan for rapid motions, cycles, and lines that
    begin where no place is known.

    Args:
        which: Motion of every line, (N,).
        share: Share of its motion that is done at its end, (N,).
        written: Where it ends, program coordinates as written, (N, A).
    """
    begin = path.begins_at(which, written)
    part = shares_of_lines(which, share)
    seen = ~path.is_whole[which] & ~(are_first(which) & ~path.is_from_known[which])
    out = np.full(len(which), np.nan)
    todo = np.flatnonzero(seen)
    for low in range(0, len(todo), LINES_PER_BLOCK):
        rows = todo[low : low + LINES_PER_BLOCK]
        out[rows] = _largest(
            path, which[rows], (share - part)[rows], part[rows], begin[rows], written[rows]
        )
    return out


def _largest(
    path: ProgramPath, which: IntArray, start: Array, part: Array, begin: Array, end: Array
) -> Array:
    chain = path.errors.chain
    aims = [path.touches(which, start + s * part) for s in (0.0, *CHECKED_SHARES, 1.0)]
    nominal = [tip(chain, touches.q, touches.target) for touches in aims]
    worst = np.zeros(len(which))
    for k, place in enumerate(CHECKED_SHARES, start=1):
        along = nominal[k + 1] - nominal[k - 1]
        length = np.linalg.norm(along, axis=1, keepdims=True)
        along /= np.where(length > 0.0, length, 1.0)
        added = path.readings(which, begin + place * (end - begin)) - aims[k].q
        off = actual_tip(path.errors, shifted(aims[k], added)) - nominal[k] - path.aim
        off -= np.einsum("ni,ni->n", off, along)[:, None] * along
        worst = np.maximum(worst, np.linalg.norm(off, axis=1))
    return worst


TOLERANCE = 1.0 * UM
"""Distance between the wanted path and a straight line, mm: what good machines repeat."""

MAX_LINE = 20.0
"""Longest line of a motion that is checked as one, mm: no guide repeats an error over less."""

MIN_LINE = 0.01  # a line that is shorter is not divided, mm: controls round there


@dataclass(frozen=True, eq=False, repr=False)
class Compensated(Displayed):
    """A program and its compensation, point by point in the order of the motion."""

    program: Program
    text: str  # the compensated program
    motion: IntArray  # index of the motion that every point belongs to, (N,)
    elapsed: Array  # time at every point since the program began, (N,), s
    q: Array  # readings as they were commanded, (N, A)
    added: Array  # what the compensation adds to them, as written, (N, A)
    nominal: Array  # tool point in the table frame as it should be, (N, 3), mm
    before: Array  # deviation of the tool point from there without compensation, (N, 3), mm
    after: Array  # the same with it, rounded as it was written
    # largest distance of the tool point from the nominal path inside the line that ends at every
    # point, (N,), mm; nan where it is not checked (`off_path`)
    between: Array
    tolerance: float  # tolerance to which lines were divided, mm
    u: Array  # standard uncertainty of both from that of the model at some points, (M,), mm
    u_at: IntArray  # those points, (M,)
    u_tool: float  # added to their rms where tools are not set against the probe that measured, mm
    # lines of motions that stay as they are, since no place is known there
    unmoved: tuple[int, ...]

    @cached_property
    def is_stated(self) -> Mask:
        """Points that the program states, (N,): not those over a hole that its cycle goes to."""
        return self._ahead[self.motion] == 0

    @property
    def is_cut(self) -> bool:
        """Whether a motion with a feed is checked between the ends of its lines."""
        return bool(np.isfinite(self.between).any())

    @property
    def worst_between(self) -> float:
        """Largest distance from the path between line ends, mm; zero where none is checked."""
        return float(np.nanmax(self.between)) if self.is_cut else 0.0

    @property
    def leans(self) -> Array:
        """How far the top of every hole lies off the axis through its bottom, (H,), mm."""
        tops = np.flatnonzero(self._ahead[self.motion] == 1)
        along = unit(self.nominal[tops] - self.nominal[tops + 1])
        off = self.after[tops] - self.after[tops + 1]
        return np.linalg.norm(off - np.sum(off * along, axis=1, keepdims=True) * along, axis=1)

    @cached_property
    def _ahead(self) -> IntArray:
        return _aheads(self.program.motions)


def _aheads(motions: Sequence[Motion]) -> IntArray:
    """Motions from each to the one whose correction it has."""
    return np.array([m.cycle.ahead if m.cycle else 0 for m in motions])


def compensated(
    program: Program,
    errors: MachineErrors,
    head: Header,
    tolerance: float = TOLERANCE,
    output: Path | None = None,
) -> Compensated:
    """Compensate a program.

    Every motion is divided until a straight line between two compensated points leaves less than
    the tolerance of what its middle would need: chords of arcs and of the error field alike.

    Args:
        output: The file that it becomes, whose name a Klartext program states; None for its own.

    Raises:
        OutsideTravel: A compensated point beyond the travel of an axis.
    """
    path = ProgramPath(program, errors)
    which, share, at = _divided(path, _begun(path, tolerance), tolerance)
    _shift_cycles(path, which, at)
    done = in_time(path, which, share, path.rounded(which, at), tolerance)
    which, share, written, _ = done
    touches = path.touches(which, share)
    q = path.readings(which, written)
    _check_travel(path, which, q)
    nominal = tip(errors.chain, touches.q, touches.target)
    aim = nominal + path.aim
    # the uncertainty varies slowly along a program, so some points are enough
    some = spread_rows(len(which), MAX_U_POINTS)
    columns = aligned(nominal[some], errors.columns(touches[some]))
    spread, tool = columns @ errors.root, columns @ errors.tool_root
    return Compensated(
        program=program,
        text=_text(path, head, done, output or program.path),
        motion=which,
        elapsed=touches.time - errors.state.time,
        q=touches.q,
        added=q - touches.q,
        nominal=nominal,
        before=actual_tip(errors, touches) - aim,
        after=actual_tip(errors, shifted(touches, q - touches.q)) - aim,
        between=off_path(path, which, share, written),
        tolerance=tolerance,
        u=np.sqrt(np.einsum("nik,nik->n", spread, spread)),
        u_at=some,
        u_tool=float(np.sqrt(np.einsum("nik,nik->", tool, tool) / len(some))),
        unmoved=tuple(k.line for k in program.items if isinstance(k, Keep) and k.moves),
    )


def passed(program: Program, errors: MachineErrors) -> tuple[Touches, IntArray]:
    """Poses that a program passes, as it is, in the order of the motion.

    Returns:
        The poses, and the number of the motion of each, (N,).
    """
    path = ProgramPath(program, errors)
    which, share = _shares(_begun(path, TOLERANCE))
    return path.touches(which, share), which


MAX_U_POINTS = 200  # points at which the uncertainty is taken: it varies slowly along a program


def _begun(path: ProgramPath, tolerance: float) -> IntArray:
    """Lines that every motion is divided into at first, (M,)."""
    spacing = point_spacing(path.errors, path.frame.datum)
    far = np.abs(path.paths.end - path.paths.start)
    pieces = np.ones(len(far))
    for axis, step in spacing.items():
        k = path.errors.chain.axis_index(axis)
        if path.errors.chain.link(axis).kind == "linear":
            step = min(step, MAX_LINE)
        pieces = np.maximum(pieces, np.ceil(far[:, k] / step - 1e-9))
    straight = min(spacing[a] for a in path.errors.chain.linear_axes)
    for k, arc in path.paths.arcs:
        radius = path.paths.radius(k, arc)
        # the height of a chord of angle a above its arc is r (1 - cos(a/2))
        step = 2.0 * np.arccos(1.0 - min(0.8 * tolerance / max(radius, tolerance), 1.0))
        step = min(step, min(straight, MAX_LINE) / max(radius, 1e-9))
        pieces[k] = max(pieces[k], np.ceil(abs(arc.angle) / step))
    pieces[path.is_whole] = 1
    return pieces.astype(np.int64)


def _divided(
    path: ProgramPath, pieces: IntArray, tolerance: float
) -> tuple[IntArray, Array, Array]:
    """Motions, shares and compensated coordinates of the ends of all lines, in order."""
    which, share = _shares(pieces)
    at = path.needed(which, share)
    # a short line of its own is within the spacing over which the field is straight
    is_checked = pieces > 1
    is_checked[[k for k, _ in path.paths.arcs]] = True
    todo = np.flatnonzero((is_checked & ~path.is_whole)[which])
    low, low_at = (share - 1.0 / pieces[which])[todo], np.empty((len(todo), at.shape[1]))
    is_first = are_first(which)[todo]
    low_at[~is_first] = at[todo[~is_first] - 1]
    low_at[is_first] = path.needed(which[todo[is_first]], np.zeros(int(is_first.sum())))
    ends = [(which, share, at)]
    lines = (which[todo], low, low_at, share[todo], at[todo])
    linear = path.frame.linear
    while len(lines[0]):
        motion, a, at_a, b, at_b = lines
        middle = 0.5 * (a + b)
        at_m = path.needed(motion, middle)
        off = np.linalg.norm((at_m - 0.5 * (at_a + at_b))[:, linear], axis=1)
        rows = (off > tolerance) & ((b - a) * path.paths.travel[motion] > MIN_LINE)
        motion, a, at_a, b, at_b, middle, at_m = (
            v[rows] for v in (motion, a, at_a, b, at_b, middle, at_m)
        )
        ends.append((motion, middle, at_m))
        lines = tuple(  # type: ignore[assignment]
            np.concatenate(pair)
            for pair in ((motion, motion), (a, middle), (at_a, at_m), (middle, b), (at_m, at_b))
        )
    which, share, at = (np.concatenate(parts) for parts in zip(*ends, strict=True))
    order = np.lexsort((share, which))
    return which[order], share[order], at[order]


def _shift_cycles(path: ProgramPath, which: IntArray, at: Array) -> None:
    """Give the motions of a canned cycle what its bottom needs, in place: each is one line."""
    ahead = _aheads(path.motions)
    own = np.flatnonzero(ahead)
    bottom = own + ahead[own]
    rows, bottoms = np.searchsorted(which, own), np.searchsorted(which, bottom)
    at[rows] = at[bottoms] + path.paths.end[own] - path.paths.end[bottom]


def _shares(pieces: IntArray) -> tuple[IntArray, Array]:
    """Motion and share at the end of every line, for motions in so many lines, (N,) each."""
    which = np.repeat(np.arange(len(pieces)), pieces)
    number = np.arange(len(which)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return which, (number + 1.0) / pieces[which]


def _check_travel(path: ProgramPath, which: IntArray, q: Array) -> None:
    chain = path.errors.chain
    low, high = chain.travels.T
    beyond = (q < low - UM) | (q > high + UM)
    if beyond.any():
        row, k = (int(v) for v in np.argwhere(beyond)[0])
        line = path.motions[which[row]].line
        name = path.program.path
        message = f"{name}: line {line}: compensated, {chain.axes[k]} leaves its travel"
        raise OutsideTravel(f"{message}; move the datum")


def _text(path: ProgramPath, head: Header, done: Timed, output: Path) -> str:
    """The compensated program: its blocks in their order, every motion as its lines."""
    language = path.program.language
    begins = np.searchsorted(done.which, np.arange(len(path.motions) + 1)).tolist()
    shown = _shown(path, done.written - path.offset[done.which])
    parts = shares_of_lines(done.which, done.share).tolist()
    blocks: list[str] = []
    number = 0
    for item in path.program.items:
        if isinstance(item, Keep):
            blocks.append(item.text)
        else:
            axes, rows = shown[item.turned]
            own = slice(begins[number], begins[number + 1])
            given = item, axes, rows[own], parts[own]
            if number in done.motions:
                blocks += language.timed_lines(*given, path.seconds[number] / MINUTE)
            else:
                blocks += language.lines(*given)
            number += 1
    start = next(k for k, block in enumerate(blocks) if not language.OPENS.match(block))
    blocks[start:start] = [*map(language.comment, head.lines()), *language.BEGIN]
    return str(language.listed(blocks, output))


def _shown(
    path: ProgramPath, at: Array
) -> dict[tuple[str, ...], tuple[tuple[str, ...], list[list[float]]]]:
    """Axes that lines name, with their coordinates, mm and degrees, by the axes that are turned."""
    chain = path.errors.chain
    rotary = chain.rotary_axes
    value = dict(zip(chain.axes, at.T, strict=True))
    value |= {a: value[a] / DEG for a in rotary}
    out = {}
    for turned in {m.turned for m in path.motions}:
        axes = ("X", "Y", "Z", *(a for a in rotary if a in turned))
        out[turned] = axes, np.column_stack([value[a] for a in axes]).tolist()
    return out
