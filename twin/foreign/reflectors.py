"""Reflectors on an arm: where they were measured, and where they sit and the tracker stands."""

import re

import numpy as np
from numpy.typing import NDArray

from twin.errors import BadFile
from twin.frames import Array, apply, inverse, pose, rotation
from twin.record import rigid_motion
from twin.sheets import MM, Sheet, bare, unit_of_column

_LETTER = re.compile(r"(?<![a-z])([xyz])(?![a-z])", re.IGNORECASE)
_MEASURED = re.compile(r"meas|act|ist\b|track|refl|laser", re.IGNORECASE)

ROUNDS = 50
"""Most steps of Gauss and Newton towards tracker and reflectors; five are usual."""

SETTLED = 1e-9
"""Step (mm, rad) below which they have arrived."""


def reflector_places(sheet: Sheet) -> tuple[Array, tuple[str, ...]]:
    """Where the reflectors were measured, (N, K, 3), mm, and their names.

    Columns x, y and z with the same words about the letter are one reflector (`x1 y1 z1 x2 y2 z2`,
    `SMR1 X`); mm where the name of a column has no unit. Of columns of several kinds those count
    whose names say that they were measured.

    Raises:
        BadFile: No columns x, y, z; several of one letter of which it is not said that they were
            measured and that do not differ by a number alone.
    """
    found: dict[str, dict[str, int]] = {}
    for i, column in enumerate(sheet.columns):
        name = bare(column).replace("_", " ")
        match = _LETTER.search(name)
        if match:
            words = (name[: match.start()] + name[match.end() :]).strip().lower()
            found.setdefault(words, {}).setdefault(match.group(1).lower(), i)
    named = {words: columns for words, columns in found.items() if len(columns) == 3}
    measured = {words: columns for words, columns in named.items() if _MEASURED.search(words)}
    chosen = measured or named
    if not chosen or len({re.sub(r"\d+", "", words).strip() for words in chosen}) > 1:
        every = [sheet.columns[i] for columns in found.values() for i in columns.values()]
        listed = ", ".join(map(repr, every)) or "no such column"
        raise BadFile(
            sheet.path, "header", listed, "one column of measured x, y, z (or x1, x2 ...)"
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


def placed(T_table_tool: Array, place: Array, reflector: Array | None) -> tuple[Array, Array]:
    """Pose of the tracker's frame in the table, (4, 4), and reflectors in the tool frame, (K, 3).

    ``R (p + R_i v) + t = x`` with (R, t) what takes the table to the tracker and v a reflector,
    by Gauss and Newton from the tracker that fits the flange.

    Args:
        T_table_tool: Of the nominal arm at every pose, (N, 4, 4).
        place: Where the reflectors were measured, (N, K, 3), mm; not a number where one was not.
        reflector: Where they sit, (K, 3), if that is known.
    """
    n, k = place.shape[:2]
    v = np.zeros((k, 3)) if reflector is None else reflector
    there: NDArray[np.bool_] = np.all(np.isfinite(place), axis=2)
    seen = np.where(there[:, :, None], place, 0.0)
    middle = seen.sum(axis=1) / there.sum(axis=1, keepdims=True)
    T = rigid_motion(
        apply(T_table_tool, np.broadcast_to(v.mean(axis=0), (n, 3))), middle, np.eye(4)
    )
    for _ in range(ROUNDS):
        R_tool = T[:3, :3] @ T_table_tool[:, :3, :3]
        at = np.einsum("nij,kj->nki", R_tool, v) + apply(T, T_table_tool[:, :3, 3])[:, None]
        J = np.zeros((n, k, 3, 6 + 3 * k))
        J[..., :3] = np.cross(np.eye(3), (at - T[:3, 3])[:, :, None]).swapaxes(2, 3)
        J[..., 3:6] = np.eye(3)
        for j in range(k):
            J[:, j, :, 6 + 3 * j : 9 + 3 * j] = R_tool
        free = 6 + 3 * k if reflector is None else 6
        step = np.zeros(6 + 3 * k)
        rows = there.reshape(-1).repeat(3)
        left = (seen - at).reshape(-1)[rows]
        step[:free] = np.linalg.lstsq(J.reshape(-1, 6 + 3 * k)[rows, :free], left, rcond=None)[0]
        T = pose(rotation(step[:3]) @ T[:3, :3], T[:3, 3] + step[3:6])
        v = v + step[6:].reshape(k, 3)
        if np.abs(step).max() < SETTLED:
            break
    return inverse(T), v
