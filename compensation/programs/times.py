"""Lines with rotary axes take the time that the program gives them.

F of a line that turns axes alone is in degrees per minute; as soon as a linear axis moves, even by
the micrometre of a correction, it is in millimetres per minute (LinuxCNC; Fanuc adds degrees
to millimetres). Such lines are written in inverse time.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from matstd.compensation.programs.path import ProgramPath, shares_of_lines
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import DEG, MINUTE

MIN_CHANGED_SHARE = 0.02
"""Share of the way of the linear axes below which a correction does not change the feed."""

MAX_TIME_DIFFERENCE = 0.05
"""Share of the time of a line within which controls agree on F of lines that move and turn."""

MIN_INVERSE_FEED = 0.1
"""Slowest feed of LinuxCNC in inverse time, mm/min or degrees/min (inches in inches): a line with
1 µm of correction in 6 s would be faster than programmed."""

FEED_MARGIN = 1.2
"""Factor on `MIN_INVERSE_FEED` at which lines are written: coordinates are rounded to 10 nm."""

MAX_LAG_SHARE = 0.1
"""Share of the tolerance below which a change of the correction waits for the next line."""


class Timed(NamedTuple):
    """Ends of lines, and the motions among them that are written in inverse time."""

    which: IntArray  # motion of every line, (N,)
    share: Array  # share of its motion that is done at its end, (N,)
    written: Array  # program coordinates, rounded, (N, A)
    motions: frozenset[int]  # numbers of the motions whose time would change if F alone were kept


def in_time(
    path: ProgramPath, which: IntArray, share: Array, written: Array, tolerance: float
) -> Timed:
    """Keep the time of every line that turns an axis; raises BadFile. Lines as of `Timed`.

    Args:
        tolerance: By which corrections may lag where LinuxCNC cannot go slowly enough, mm.
    """
    linear = path.frame.linear
    begin = path.begins_at(which, written)
    moved = written - begin
    far = np.linalg.norm(moved[:, linear], axis=1)
    wanted = path.paths.far[which] * shares_of_lines(which, share)
    turns = np.abs(np.delete(moved, linear, axis=1)).max(axis=1, initial=0.0) > 1e-6 * DEG
    turns &= ~path.is_whole[which] & (path.paths.turned[which] > 0.0)
    # without a known start the length of a line, and so its time, is unknown
    for k in np.unique(which[turns & ~path.is_from_known[which]]).tolist():
        if path.motions[k].minutes == 0.0:
            found = "rotary axes that turn with a feed from where X, Y or Z is not known"
            raise _refused(
                path, k, found, "a motion to X, Y and Z before: how long it takes is not known"
            )
    changes = turns & (np.abs(far - wanted) > MIN_CHANGED_SHARE * np.minimum(far, wanted))
    stated = np.array([m.minutes > 0.0 for m in path.motions])
    timed = frozenset(np.unique(which[changes & ~stated[which]]).tolist())
    for k in timed:
        _check(path, k)
    slow = timed | set(np.unique(which[turns & stated[which]]).tolist())
    if not slow:
        return Timed(which, share, written, timed)
    # the same place is rounded otherwise behind another unit, and LinuxCNC takes a nanometre for a
    # way in X, Y, Z
    for k in slow:
        if k and path.motions[k].unit != path.motions[k - 1].unit:
            found = "rotary axes that turn right behind G20 or G21"
            raise _refused(path, k, found, "a motion of X, Y and Z between")
    rows = np.searchsorted(which, np.arange(len(path.motions) + 1)).tolist()
    parts: list[tuple[IntArray, Array, Array]] = []
    lag = np.zeros(written.shape[1])
    for k in range(len(path.motions)):
        own = slice(rows[k], rows[k + 1])
        if k in slow:
            start = begin[own][0] + lag
            made = list(_slowed(path, k, start, share[own], written[own], tolerance))
            number = np.full(len(made), k)
            at = path.rounded(number, np.array([at for _, at in made]))
            # a line that cannot be slow enough leaves a part of the correction to the next motion
            lag = at[-1] - written[own][-1]
            parts.append((number, np.array([s for s, _ in made]), at))
        else:
            lag = np.zeros(written.shape[1])
            parts.append((which[own], share[own], written[own]))
    joined = [np.concatenate(p) for p in zip(*parts, strict=True)]
    return Timed(joined[0], joined[1], joined[2], timed)


def _slowed(
    path: ProgramPath, k: int, start: Array, shares: Array, ends: Array, tolerance: float
) -> Iterator[tuple[float, Array]]:
    """Lines of one motion, none of which LinuxCNC would run faster: shares and ends.

    A line whose correction changes too slowly waits first, its rotary axes alone turning, and then
    takes the correction along at the slowest feed that there is; the rotary axes turn evenly.
    """
    linear = path.frame.linear
    slowest = FEED_MARGIN * MIN_INVERSE_FEED * path.motions[k].unit / MINUTE  # mm/s
    at, done = start.copy(), 0.0
    for share, end in zip(shares.tolist(), ends, strict=True):
        far = float(np.linalg.norm((end - at)[linear]))
        could = slowest * path.seconds[k] * (share - done)
        target = end.copy()
        if far <= MAX_LAG_SHARE * tolerance and far < could:
            target[linear] = at[linear]
        elif far < could:
            lag = far * (1.0 - far / could)
            count = int(np.ceil(2.0 * lag / tolerance))
            for n in range(count):
                one = at + (n + np.array([1.0 - far / could, 1.0]))[:, None] / count * (end - at)
                one[0, linear] = (at + n / count * (end - at))[linear]
                step = (share - done) / count
                yield done + step * (n + 1.0 - far / could), one[0]
                if n < count - 1:
                    yield done + step * (n + 1.0), one[1]
        yield share, target
        at, done = target, share


def _refused(path: ProgramPath, k: int, found: str, expected: str) -> BadFile:
    return BadFile(path.program.path, path.motions[k].line, found, expected)


def _check(path: ProgramPath, k: int) -> None:
    """Whether the time of a motion can be kept; raises BadFile."""
    motion = path.motions[k]
    far, turned = float(path.paths.far[k]), float(path.paths.turned[k])
    said = f"{' and '.join(motion.turned)} turning by {turned:.4g} degrees at F{motion.word:g}"
    slowest = FEED_MARGIN * MIN_INVERSE_FEED
    if not path.program.language.HAS_INVERSE_TIME or motion.tcpm:
        where = "with tool-point control" if motion.tcpm else "in Klartext"
        raise _refused(
            path, k, f"{said}, which its correction in X, Y, Z would make mm/min",
            f"FMAX or G0: no documented way to state the time of a block {where} is known",
        )  # fmt: skip
    # controls disagree on F of such a line, so its time is known only if the turn adds little
    if far > 0.0 and np.hypot(far, turned) > (1.0 + MAX_TIME_DIFFERENCE) * far:
        raise _refused(
            path, k, f"{said} while X, Y, Z go {far:.4g} mm, which its correction changes",
            "it in inverse time (G93): LinuxCNC takes F for the mm alone, Fanuc for degrees too",
        )  # fmt: skip
    if turned / path.seconds[k] * MINUTE < slowest:
        raise _refused(path, k, said, f"{slowest:g} degrees/min or more: LinuxCNC's slowest in G93")
