"""Reflectors on an arm: where they were measured, and where they sit and the tracker stands."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from matstd.importers.sheets import MM, Sheet, bare, unit_of_column
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.record import rigid_motion

_LETTER = re.compile(r"(?<![a-z])([xyz])(?![a-z])", re.IGNORECASE)
_MEASURED = re.compile(r"meas|act|ist\b|track|refl|laser", re.IGNORECASE)

OPEN = 10.0
"""Standard uncertainty (mm) of a direction from which poses do not determine it. Thirty poses of an
arm that is 1 mm wrong leave 0.4 mm; a path with one orientation leaves metres."""

ROUGH = 5.0
"""Most scatter (mm) that this is judged with: what scatters more is not of the stated arm."""

LOST = 0.5
"""Share of the spread of the measured places from which what is left is no error of an arm."""

TAKES_PART = 0.05
"""Share of a unit vector from which a parameter takes part in a direction."""


def reflector_places(sheet: Sheet, joints: Sequence[str] = ()) -> tuple[Array, tuple[str, ...]]:
    """Where the reflectors were measured, (N, K, 3), mm, and their names.

    Columns x, y and z with the same words about the letter are one reflector (`x1 y1 z1 x2 y2 z2`,
    `SMR1 X`); mm where the name of a column has no unit. `Z` and `z` are two columns. Of columns of
    several kinds those count whose names say that they were measured.

    Args:
        joints: Columns that hold readings of joints.

    Raises:
        BadFile: No columns x, y, z; several of one letter of which it is not said that they were
            measured and that do not differ by a number alone.
    """
    found: dict[tuple[str, bool], dict[str, int]] = {}
    letters = {c: m for c in sheet.columns if (m := _LETTER.search(bare(c).replace("_", " ")))}
    for i, column in enumerate(sheet.columns):
        if column in letters and column not in joints:
            match = letters[column]
            around = match.string[: match.start()] + match.string[match.end() :]
            key = around.strip().lower(), match.group(1).isupper()
            found.setdefault(key, {}).setdefault(match.group(1).lower(), i)
    named = {key: columns for key, columns in found.items() if len(columns) == 3}
    measured = {key: columns for key, columns in named.items() if _MEASURED.search(key[0])}
    chosen = measured or named
    kinds = {(re.sub(r"\d+", "", words).strip(), is_upper) for words, is_upper in chosen}
    if len(kinds) != 1:
        every = [sheet.columns[i] for columns in found.values() for i in columns.values()]
        listed = ", ".join(map(repr, every)) or "no such column"
        raise BadFile(
            sheet.path,
            "header",
            listed,
            "one column of measured x, y, z (or x1, x2 ...), the others renamed, or `measured` in "
            "its name",
        )
    factors = {i: MM.get(unit_of_column(sheet.columns[i]) or "mm", 1.0) for c in chosen.values()
               for i in c.values()}  # fmt: skip
    places = [
        np.stack([sheet.numbers(c[letter]) * factors[c[letter]] for letter in "xyz"], axis=1)
        for c in chosen.values()
    ]
    several = len(chosen) > 1
    names = tuple(f"reflector {k + 1}" if several else "reflector" for k in range(len(chosen)))
    return np.stack(places, axis=1), names


@dataclass(frozen=True, eq=False)
class Placement:
    """Where the tracker stands and the reflectors sit, and whether the poses say so.

    Attributes:
        T_table_tracker: Pose of the tracker's frame in the table frame, (4, 4).
        reflector: Places in the tool frame, (K, 3), mm.
        rms: Of the coordinates that are left, mm.
        spread: Of the measured coordinates about their mean, rms, mm.
        is_settled: Whether the search for the reflectors has converged.
        free: Directions that the poses do not determine, in words; empty where they do.
    """

    T_table_tracker: Array
    reflector: Array
    rms: float
    spread: float
    is_settled: bool
    free: tuple[str, ...]

    @property
    def is_lost(self) -> bool:
        """Whether an arm that moved so could not have been measured so."""
        return self.rms > max(LOST * self.spread, ROUGH)


def placed(T_table_tool: Array, place: Array, reflector: Array | None, u: float) -> Placement:
    """Tracker and reflectors from the places where reflectors were measured.

    ``R (p + R_i v) + t = x`` with (R, t) what takes the table to the tracker and v a reflector.
    For given reflectors the tracker follows in closed form, so only they are searched for, by
    damped least squares from the flange (variable projection, Golub and Pereyra 1973).

    Args:
        T_table_tool: Of the nominal arm at every pose, (N, 4, 4).
        place: Where the reflectors were measured, (N, K, 3), mm; not a number where one was not.
        reflector: Where they sit, (K, 3), if that is known.
        u: Standard uncertainty of one coordinate, mm.
    """
    problem = _Problem(T_table_tool, place, reflector is not None)
    if reflector is None:
        from scipy.optimize import least_squares  # a third of a second, for arms alone

        start = np.zeros(3 * place.shape[1])
        found = least_squares(problem.left, start, problem.slopes, xtol=1e-14, ftol=1e-14)
        v, is_settled = found.x.reshape(-1, 3), bool(found.status > 0)
    else:
        v, is_settled = reflector, True
    left = problem.left(v.ravel())
    rms = float(np.sqrt(np.mean(left**2)))
    seen = problem.seen
    return Placement(
        T_table_tracker=inverse(problem.tracker(v)),
        reflector=v,
        rms=rms,
        spread=float(np.sqrt(np.mean((seen - seen.mean(axis=0)) ** 2))),
        is_settled=is_settled,
        free=tuple(problem.free(v, float(np.clip(rms, u, max(u, ROUGH))))),
    )


class _Problem:
    """Places of K reflectors at N poses, and what they say of tracker and reflectors."""

    def __init__(self, T_table_tool: Array, place: Array, is_known: bool) -> None:
        self.T, self.count, self.is_known = T_table_tool, place.shape[1], is_known
        there: NDArray[np.bool_] = np.all(np.isfinite(place), axis=2)
        self.pose, self.of = np.nonzero(there)
        self.seen = place[there]  # (M, 3)

    def believed(self, v: Array) -> Array:
        """Where the arm takes the reflectors to be, (M, 3), table frame."""
        T = self.T[self.pose]
        return np.einsum("mij,mj->mi", T[:, :3, :3], v[self.of]) + T[:, :3, 3]

    def tracker(self, v: Array) -> Array:
        """What takes the table to the tracker, (4, 4)."""
        return rigid_motion(self.believed(v), self.seen, flat=0.0)

    def left(self, v: Array) -> Array:
        """What is left of the coordinates for reflectors (3 K,), (3 M,)."""
        at = v.reshape(-1, 3)
        return np.asarray((apply(self.tracker(at), self.believed(at)) - self.seen).ravel())

    def columns(self, v: Array) -> Array:
        """Motion per unit of every parameter, (3 M, 6 + 3 K).

        Turns of the table about its directions, by what moves a place of the usual distance by one
        mm; shifts along them; the reflectors along the directions of the tool frame, mm.
        """
        R, at = self.tracker(v)[:3, :3], self.believed(v)
        arm = at - at.mean(axis=0)
        reach = max(float(np.sqrt(np.mean(np.sum(arm**2, axis=1)))), 1e-9)
        J = np.zeros((len(at), 3, 6 + 3 * self.count))
        J[:, :, :3] = np.cross(np.eye(3), arm[:, None]).swapaxes(1, 2) / reach
        J[:, :, 3:6] = np.eye(3)
        rows = np.arange(len(at))
        for i in range(3):
            J[rows, :, 6 + 3 * self.of + i] = self.T[self.pose, :3, i]
        return np.einsum("ij,mjp->mip", R, J).reshape(-1, J.shape[2])

    def slopes(self, v: Array) -> Array:
        """Of `left`, (3 M, 3 K): what of the reflectors' columns the tracker cannot follow."""
        J = self.columns(v.reshape(-1, 3))
        Q = np.linalg.qr(J[:, :6])[0]
        return np.asarray(J[:, 6:] - Q @ (Q.T @ J[:, 6:]))

    def free(self, v: Array, scatter: float) -> Iterator[str]:
        """Directions that are open by more than OPEN where coordinates scatter, in words."""
        J = self.columns(v)[:, : 6 if self.is_known else None]
        _, s, Vt = np.linalg.svd(J, full_matrices=False)
        undetermined = Vt[s * OPEN < scatter].T  # (P, d)
        if not undetermined.shape[1]:
            return
        for k in range((len(undetermined) - 6) // 3):
            number = f" {k + 1}" if self.count > 1 else ""
            for words in _directions(undetermined[6 + 3 * k : 9 + 3 * k], "along", "xyz"):
                yield f"the reflector{number} {words} of the tool frame"
        for words in _directions(undetermined[:3], "about", "XYZ"):
            yield f"a turn of the tracker {words} of the table frame"


def _directions(block: Array, preposition: str, letters: str) -> Iterator[str]:
    """What the columns of a block (3, d) span: nothing, a line, a plane or everything."""
    U, s, _ = np.linalg.svd(block)
    rank = int((s > TAKES_PART).sum())
    if rank == 3:
        yield f"{preposition} every direction"
    elif rank == 2:
        yield f"{preposition} every direction square to {_direction(U[:, 2], letters)}"
    elif rank == 1:
        yield f"{preposition} {_direction(U[:, 0], letters)}"


def _direction(n: Array, letters: str) -> str:
    """`z`, or `(0.60, 0.80, 0.00)` with its largest number positive."""
    largest = int(np.argmax(np.abs(n)))
    if abs(n[largest]) > 1.0 - 1e-4:
        return letters[largest]
    n = n * np.sign(n[largest]) + 0.0
    return f"({', '.join(f'{v:.2f}' for v in np.round(n, 2) + 0.0)})"
