"""What is engraved, and where: on walls, sides and plate, never on what is touched."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import BLEND, FreeformPatch, Standard, outline_distance
from matstd.cad_out.details.dot_font import LARGE, SMALL, dots, size
from matstd.cad_out.details.places import Bore, Side, plan_room
from matstd.twin.frames import Array, pose
from matstd.twin.sampling import grid_points

_OF_SIDE = 0.37  # of the plate's thickness, that letters on a side take: two lines have room
_TEXT_MARGIN = 1.5  # mm round a line of text
_MAX_DISTANCE = 14.0  # mm from a body that its number may stand


@dataclass(frozen=True, eq=False)
class Lettering:
    """A line of text."""

    text: str
    T_artefact_text: Array  # begin of the line; x along it, y up the letters, z out of the material
    rows: int  # of dots in a letter, `SMALL` or `LARGE`
    of: str = ""  # feature that it names; empty for the standard's own name

    @property
    def dots(self) -> Array:
        """Middles of the dots in the frame of the text, (N, 2), mm."""
        return dots(self.text, self.rows)


def lettering_of(
    standard: Standard, sides: dict[str, Side], bores: Sequence[Bore]
) -> tuple[tuple[Lettering, ...], tuple[str, ...]]:
    """Every line of text, and what finds no room: names of features, or the text itself."""
    out, missing = _on_sides(standard, sides, bores)
    plate = _Plate(standard, list(bores))
    for patch in standard.patches:
        line = _on_wall(standard, patch) or plate.beside(
            patch.name, patch.T_artefact_patch[:2, 3], float(np.hypot(*patch.half_size))
        )
        missing += [] if line else [patch.name]
        out += [line] if line else []
    for sphere in standard.spheres:
        widest = max(sphere.radius, sphere.foot_radius + BLEND)
        line = plate.beside(sphere.name, sphere.centre[:2], widest)
        missing += [] if line else [sphere.name]
        out += [line] if line else []
    line = plate.beside("DATUM_A", np.array([-1.0, -1.0]) * standard.base.half_size, 20.0, far=90.0)
    missing += [] if line else ["DATUM_A"]
    out += [line] if line else []
    return tuple(out), tuple(missing)


def _label(feature: str) -> str:
    """What is engraved for a feature: balls by their number, faces and datums by their name."""
    return feature.removeprefix("SPH").removeprefix("DATUM_")


def _on_sides(
    standard: Standard, sides: dict[str, Side], bores: Sequence[Bore]
) -> tuple[list[Lettering], list[str]]:
    thick = standard.base.thickness
    pocket = next((b.mouth[0] for b in bores if b.name == "THERMO"), None)
    aside = 0.0 if pocket is None else -18.0 if pocket >= 0.0 else 18.0
    beside = 0.4 * sides["DATUM_C"].half_length  # which is touched in its middle
    wanted = [
        ("NAME", f"{standard.name} {standard.serial}".strip(), 0.0, 0.68 * thick, ""),
        ("NAME", "+X", 0.0, 0.28 * thick, ""),
        ("THERMO", "+Y", (pocket or 0.0) + aside, 0.5 * thick, ""),
        ("DATUM_B", "B", 0.0, 0.5 * thick, "DATUM_B"),
        ("DATUM_C", "C", beside, 0.5 * thick, "DATUM_C"),
    ]
    found = [_on_side(sides[s], text, at, z, thick, of) for s, text, at, z, of in wanted]
    missing = [w[4] or w[1] for w, line in zip(wanted, found, strict=True) if line is None]
    return [line for line in found if line], missing


def _on_side(side: Side, text: str, at: float, z: float, thick: float, of: str) -> Lettering | None:
    """Text in the middle of a side or `at` beside it, in the largest letters that fit."""
    out = np.array([*side.normal, 0.0])
    along = np.cross([0.0, 0.0, 1.0], out)
    middle = side.offset * out + at * np.abs(along) + [0.0, 0.0, z]
    R = np.column_stack([along, [0.0, 0.0, 1.0], out])
    rows = _largest(text, [1.7 * side.half_length, _OF_SIDE * thick])
    return None if rows is None else _around(text, R, middle, rows, of)


def _on_wall(standard: Standard, patch: FreeformPatch) -> Lettering | None:
    """Number on the wall of an upright pillar that looks outwards, below the face's lowest edge."""
    if not patch.is_upright:
        return None
    place, half = patch.T_artefact_patch[:3, 3], np.array(patch.half_size)
    fixed = int(np.argmax(np.abs(place[:2]) / standard.base.half_size))
    out = np.zeros(3)
    out[fixed] = 1.0 if place[fixed] >= 0.0 else -1.0
    along = np.cross([0.0, 0.0, 1.0], out)
    t = np.linspace(-1.0, 1.0, 31)[:, None]
    edge = (out + t * along)[:, :2] * half
    low = standard.base.thickness + BLEND + 1.0
    free = place[2] + float(patch.height(edge).min()) - 1.0 - low
    text = _label(patch.name)
    rows = _largest(text, [1.7 * half[1 - fixed], free])
    if rows is None:
        return None
    R = np.column_stack([along, [0.0, 0.0, 1.0], out])
    middle = np.array([*place[:2], low + 0.5 * size(text, rows)[1]]) + out * half[fixed]
    return _around(text, R, middle, rows, patch.name)


def _largest(text: str, room: Sequence[float]) -> int | None:
    """Rows of dots of the largest letters that a width and a height have room for, mm."""
    return next((rows for rows in (LARGE, SMALL) if np.all(size(text, rows) <= room)), None)


def _around(text: str, R: Array, middle: Array, rows: int, of: str) -> Lettering:
    """A line of text centred at a point."""
    return Lettering(text, pose(R, middle - R[:, :2] @ (0.5 * size(text, rows))), rows, of)


class _Plate:
    """Free places on the upper face, taken one after the other."""

    def __init__(self, standard: Standard, bores: list[Bore]) -> None:
        self.standard = standard
        upright = [bore for bore in bores if bore.direction[2] < 0.0]
        self.taken = [(np.array(bore.mouth[:2]), np.full(2, bore.radius)) for bore in upright]

    def beside(
        self, feature: str, middle: Array, widest: float, far: float = _MAX_DISTANCE
    ) -> Lettering | None:
        """Text as near to a body as there is room, or None."""
        text = _label(feature)
        angle = np.arange(48) * (2.0 * np.pi / 48)
        ray = np.column_stack([np.sin(angle), -np.cos(angle)])
        half = 0.5 * size(text, SMALL)
        distance = widest + half.max() + np.arange(1.0, far, 1.5)
        places = np.round(middle + (distance[:, None, None] * ray).reshape(-1, 2), 1)
        good = np.flatnonzero(self._is_free(places, half))
        if not len(good):
            return None
        at = places[good[0]]
        self.taken.append((at, half))
        on_top = np.array([*at, self.standard.base.thickness])
        return _around(text, np.eye(3), on_top, SMALL, feature)

    def _is_free(self, places: Array, half: Array) -> Array:
        t = np.linspace(-1.0, 1.0, 7)
        box = grid_points(t, t) * half
        inside = (places[:, None] + box).reshape(-1, 2)
        base = self.standard.base
        rim = -outline_distance(inside, base.half_size, base.corner_radius)
        free = (plan_room(self.standard, inside) >= _TEXT_MARGIN) & (rim >= 3.0)
        out = free.reshape(len(places), -1).all(axis=1)
        for at, other in self.taken:
            out &= (np.abs(places - at) >= half + other + _TEXT_MARGIN).any(axis=1)
        return np.asarray(out)
