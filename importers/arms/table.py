"""Tables of joint readings with the places at which a tracker measured reflectors."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.importers.arms.orientation import oriented, rotations
from matstd.importers.sheets import ANGLES, MM, Sheet
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array, IntArray, Mask

_JOINT = re.compile(
    r"(?:\A|[^a-z])(?:j|joint|axis|achse|gelenk|q|theta|a)[\s_.]*(\d{1,2})(?!\d)", re.IGNORECASE
)
_LETTER = re.compile(r"(?<![a-z])([xyz])(?![a-z])", re.IGNORECASE)
_MEASURED = re.compile(r"meas|act|ist\b|track|refl|laser", re.IGNORECASE)
_FIXED = re.compile(r"\b(ref(erence|erenz)?|fix(ed)?|fest|base|monument|datum)\b", re.IGNORECASE)
"""Names of targets beside the arm."""
_CYCLE = re.compile(r"cycle|zyklus|\brep(lica\w*|eat\w*|etition\w*)?\b|trial", re.IGNORECASE)
_COUPLED = re.compile(r"J?(\d{1,2})\s*([+-])\s*J?(\d{1,2})\Z", re.IGNORECASE)


MAX_FIXED_MOTION = 2.0  # range (mm) of a fixed target in the frame of a tracker that drifts
MIN_MOTION_RATIO = 20.0  # least motion of the reflectors on the arm, in ranges of a fixed target


@dataclass(frozen=True, eq=False)
class ArmTable:
    """Joint readings and measured places, one row per pose."""

    sheet: Sheet
    q: Array  # readings, (N, J), rad, of a joint that slides mm
    joints: tuple[str, ...]  # columns of the readings
    # where the reflectors were measured, (N, K, 3), mm; not a number where one was not
    place: Array
    names: tuple[str, ...]
    # measured rotation of the target in the tracker's frame, (N, 3, 3); None where places alone
    turn: Array | None = None
    # places of targets beside the arm by name, each (N, 3), mm
    fixed: Mapping[str, Array] = field(default_factory=dict)
    repeat: IntArray | None = None  # number of the repetition, (N,)

    @property
    def shots(self) -> Mask:
        """Which reflectors were measured at which poses, (N, K)."""
        is_whole: Mask = np.all(np.isfinite(self.q), axis=1)
        return np.all(np.isfinite(self.place), axis=2) & is_whole[:, None]


def read_arm(sheet: Sheet, axes: Sequence[str] = (), is_oriented: bool = False) -> ArmTable:
    """Readings of joints, and places of reflectors in the tracker's frame.

    Columns of joints are taken in the order of their numbers (`j1`, `joint 2`, `theta3`), degrees
    where the name of a column has no unit. Columns x, y and z with the same words about the letter
    are one reflector (`x1 y1 z1 x2 y2 z2`, `SMR1 X`), mm where no unit is stated. One that is named
    so (`ref x`, `base y`), or does not move with the others, is a fixed target beside the arm.

    Args:
        axes: Names of the axes of the arm; columns named so are taken, if all are there.
        is_oriented: Whether the orientation of the target is read (`qw qx qy qz` or `rx ry rz`).

    Raises:
        BadFile: No such columns, a joint twice or missing, ambiguous columns of places.
    """
    turned = oriented(sheet) if is_oriented else ()
    joints = _joints(sheet, axes)
    reflectors, fixed = _reflectors(sheet, (*joints, *turned))
    q = [sheet.quantity(i, {**ANGLES, **MM}, "deg") for i in joints]
    place = [[sheet.quantity(of[c], MM, "mm") for c in "xyz"] for of in reflectors]
    several = len(reflectors) > 1
    cycle = sheet.find(_CYCLE)
    table = ArmTable(
        sheet=sheet,
        q=np.stack(q, axis=1),
        joints=tuple(sheet.columns[i] for i in joints),
        place=np.array(place).transpose(2, 0, 1),
        names=tuple(f"reflector {k + 1}" if several else "reflector" for k in range(len(place))),
        turn=rotations(sheet, turned) if turned else None,
        fixed={
            name: np.stack([sheet.quantity(of[c], MM, "mm") for c in "xyz"], axis=1)
            for name, of in fixed.items()
        },
        repeat=None if cycle is None else sheet.whole_numbers(cycle, "the number of a repetition"),
    )
    if table.turn is not None and several:
        found = f"orientations beside {len(reflectors)} reflectors"
        raise BadFile(sheet.path, "header", found, "one target with an orientation")
    return _without_standing(table)


def _without_standing(table: ArmTable) -> ArmTable:
    """The table with reflectors that stand still while others move among the fixed targets."""
    with np.errstate(invalid="ignore"):
        low, high = np.nanmin(table.place, axis=0), np.nanmax(table.place, axis=0)
    motion = np.linalg.norm(high - low, axis=1)  # (K,)
    limit = min(MAX_FIXED_MOTION, float(motion.max()) / MIN_MOTION_RATIO)
    stands = motion < limit
    if not stands.any():
        return table
    fixed = {table.names[k]: table.place[:, k] for k in np.flatnonzero(stands)}
    return replace(
        table,
        place=table.place[:, ~stands],
        names=tuple(n for n, still in zip(table.names, stands, strict=True) if not still),
        fixed={**table.fixed, **fixed},
    )


def _joints(sheet: Sheet, axes: Sequence[str]) -> list[int]:
    """Columns of joints, by the names of axes if all are there, else by their numbers."""
    named = [_named(sheet, axis) for axis in axes]
    found = [i for i in named if i is not None]
    if found and len(found) == len(axes):
        return found
    numbered: dict[int, int] = {}
    for i, column in enumerate(sheet.columns):
        match = _JOINT.search(column)
        if match and (first := numbered.setdefault(int(match[1]), i)) != i:
            twice = f"{sheet.columns[first]!r} and {column!r}"
            raise BadFile(sheet.path, "header", twice, "every joint once")
    numbers = sorted(numbered)
    if not numbers or numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        raise sheet.lacking("columns j1, j2, j3 ... of joints")
    return [numbered[k] for k in numbers]


def _named(sheet: Sheet, axis: str) -> int | None:
    """Column of the name of an axis, `Z` before `z`; raises BadFile where two have it."""
    same = [i for i, name in enumerate(sheet.names) if name == axis]
    same = same or [i for i, name in enumerate(sheet.names) if name.upper() == axis]
    if len(same) > 1:
        both = " and ".join(repr(sheet.columns[i]) for i in same[:2])
        raise BadFile(sheet.path, "header", both, f"one column of the readings of {axis}")
    return same[0] if same else None


def _reflectors(
    sheet: Sheet, others: Sequence[int]
) -> tuple[list[dict[str, int]], dict[str, dict[str, int]]]:
    """Columns x, y and z of every reflector, and those of fixed targets by name.

    `Z` and `z` are two columns. Of columns of several kinds those count whose names say that they
    were measured; of one kind they may differ by a number alone.
    """
    found: dict[tuple[str, bool], dict[str, int]] = {}
    for i, name in enumerate(sheet.names):
        match = _LETTER.search(name.replace("_", " "))
        if match and i not in others:
            around = match.string[: match.start()] + match.string[match.end() :]
            key = around.strip().lower(), match[1].isupper()
            found.setdefault(key, {}).setdefault(match[1].lower(), i)
    # three coordinates of one name are a place; a single x or z is something else
    whole = {key: of for key, of in found.items() if len(of) == 3}
    fixed = {words: of for (words, _), of in whole.items() if _FIXED.search(_words(words))}
    whole = {key: of for key, of in whole.items() if key[0] not in fixed}
    measured = {key: of for key, of in whole.items() if _MEASURED.search(key[0])}
    chosen = measured or whole
    kinds = {(_words(words), is_upper) for words, is_upper in chosen}
    if len(kinds) != 1:
        every = [sheet.columns[i] for of in found.values() for i in of.values()]
        raise BadFile(
            sheet.path,
            "header",
            ", ".join(map(repr, every)) or "no such column",
            "one column of measured x, y, z (or x1, x2 ...), the others renamed, or `measured` in "
            "its name",
        )
    return list(chosen.values()), fixed


def _words(name: str) -> str:
    """A name without numbers."""
    return re.sub(r"\d+", "", name).strip()


def coupled(q: Array, how: str) -> Array:
    """Readings of joints where one counts from the link of another, `J3+J2`; raises DesignError.

    On arms with a parallel linkage, and in the readings of some controls without one, joint 3
    counts from the horizontal: its angle against link 2 is J3 + J2 (or J3 - J2).
    """
    match = _COUPLED.match(how.strip())
    joint, other = (int(match[1]) - 1, int(match[3]) - 1) if match else (-1, -1)
    if match is None or not (0 <= joint < q.shape[1] and 0 <= other < q.shape[1]):
        raise DesignError(f"--coupled {how}: expected two of {q.shape[1]} joints such as J3+J2")
    out = q.copy()
    out[:, joint] += (1.0 if match[2] == "+" else -1.0) * q[:, other]
    return out
