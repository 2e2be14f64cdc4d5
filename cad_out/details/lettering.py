"""What is engraved, and where: on walls, sides and plate, never on what is touched."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from artefact.body import BLEND, DatumSphere, FreeformPatch, Standard, outline_distance
from cad_out.details.places import Bore, Side, plan_room
from cad_out.details.stroke_font import HEIGHT, width
from twin.frames import Array, pose

DEPTH = 0.3
"""Of an engraved line, mm."""

LINE = 0.5
"""Its width, mm."""

_SMALL, _LARGE, _LEAST = 4.0, 7.0, 2.0  # mm, heights of letters
_FREE = 1.5  # mm round a line of text
_AWAY = 14.0  # mm from a body that its number may stand


@dataclass(frozen=True, eq=False)
class Lettering:
    """A line of text.

    Attributes:
        text: Capitals.
        T_artefact_text: Begin of the line; x along it, y up the letters, z out of the material.
        height: Of the letters, mm.
        of: Feature that it names; empty for the standard's own name.
    """

    text: str
    T_artefact_text: Array
    height: float
    of: str = ""


def lettering_of(
    standard: Standard, sides: dict[str, Side], bores: Sequence[Bore]
) -> tuple[tuple[Lettering, ...], tuple[str, ...]]:
    """Every line of text, and the names of features for which there is no room."""
    out = _on_sides(standard, sides, bores)
    plate = _Plate(standard, list(bores))
    missing = []
    for patch in standard.patches:
        line = _on_wall(standard, patch) or plate.beside(
            patch.name, patch.T_artefact_patch[:2, 3], float(np.hypot(*patch.half_size))
        )
        missing += [] if line else [patch.name]
        out += [line] if line else []
    for sphere in standard.spheres:
        line = plate.beside(sphere.name, sphere.centre[:2], _widest(sphere))
        missing += [] if line else [sphere.name]
        out += [line] if line else []
    line = plate.beside("DATUM_A", np.array([-1.0, -1.0]) * standard.base.half_size, 20.0, far=90.0)
    missing += [] if line else ["DATUM_A"]
    out += [line] if line else []
    return tuple(out), tuple(missing)


def _widest(sphere: DatumSphere) -> float:
    return max(sphere.radius, sphere.foot_radius + BLEND)


def _label(feature: str) -> str:
    """What is engraved for a feature: balls by their number, faces and datums by their name."""
    return feature.removeprefix("SPH").removeprefix("DATUM_")


def _on_sides(standard: Standard, sides: dict[str, Side], bores: Sequence[Bore]) -> list[Lettering]:
    thick = standard.base.thickness
    large = min(_LARGE, 0.25 * thick)
    name = f"{standard.name} {standard.serial}".strip()
    pocket = next((b.mouth[0] for b in bores if b.name == "THERMO"), None)
    aside = 0.0 if pocket is None else -18.0 if pocket >= 0.0 else 18.0
    lines = [
        ("NAME", name, 0.0, 0.56 * thick, ""),
        ("NAME", "+X", 0.0, 0.18 * thick, ""),
        ("THERMO", "+Y", (pocket or 0.0) + aside, 0.4 * thick, ""),
        ("DATUM_B", "B", 0.0, 0.4 * thick, "DATUM_B"),
        ("DATUM_C", "C", 0.0, 0.4 * thick, "DATUM_C"),
    ]
    return [_on_side(sides[s], text, at, z, large, of) for s, text, at, z, of in lines]


def _on_side(side: Side, text: str, at: float, z: float, height: float, of: str) -> Lettering:
    """Text in the middle of a side or `at` beside it, smaller if it is too long."""
    height = min(height, 1.7 * side.half_length / width(text) * HEIGHT)
    out = np.array([*side.normal, 0.0])
    along = np.cross([0.0, 0.0, 1.0], out)
    middle = side.offset * out + at * np.abs(along)
    R = np.column_stack([along, [0.0, 0.0, 1.0], out])
    begin = middle - 0.5 * width(text) * height / HEIGHT * along + [0.0, 0.0, z]
    return Lettering(text, pose(R, begin), height, of)


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
    room = 1.7 * half[1 - fixed] / width(text) * HEIGHT
    height = float(min(_LARGE, free, room))
    if height < _LEAST:
        return None
    R = np.column_stack([along, [0.0, 0.0, 1.0], out])
    begin = np.array([*place[:2], low]) + out * half[fixed]
    begin = begin - 0.5 * width(text) * height / HEIGHT * along
    return Lettering(text, pose(R, begin), height, patch.name)


class _Plate:
    """Free places on the upper face, taken one after the other."""

    def __init__(self, standard: Standard, bores: list[Bore]) -> None:
        self.standard = standard
        upright = [bore for bore in bores if bore.direction[2] < 0.0]
        self.taken = [(np.array(bore.mouth[:2]), np.full(2, bore.radius)) for bore in upright]

    def beside(
        self, feature: str, middle: Array, widest: float, far: float = _AWAY
    ) -> Lettering | None:
        """Text as near to a body as there is room, or None."""
        text = _label(feature)
        angle = np.arange(48) * (2.0 * np.pi / 48)
        ray = np.column_stack([np.sin(angle), -np.cos(angle)])
        for height in (_SMALL, 0.75 * _SMALL):
            half = 0.5 * height / HEIGHT * np.array([width(text), HEIGHT])
            distance = widest + half.max() + np.arange(1.0, far, 1.5)
            places = np.round(middle + (distance[:, None, None] * ray).reshape(-1, 2), 1)
            good = np.flatnonzero(self._is_free(places, half))
            if len(good):
                at = places[good[0]]
                self.taken.append((at, half))
                top = self.standard.base.thickness
                return Lettering(text, pose(t=np.array([*(at - half), top])), height, feature)
        return None

    def _is_free(self, places: Array, half: Array) -> Array:
        t = np.linspace(-1.0, 1.0, 7)
        box = np.stack(np.meshgrid(t, t), axis=-1).reshape(-1, 2) * half
        inside = (places[:, None] + box).reshape(-1, 2)
        base = self.standard.base
        rim = -outline_distance(inside, base.half_size, base.corner_radius)
        free = (plan_room(self.standard, inside) >= _FREE) & (rim >= 3.0)
        out = free.reshape(len(places), -1).all(axis=1)
        for at, other in self.taken:
            out &= (np.abs(places - at) >= half + other + _FREE).any(axis=1)
        return np.asarray(out)
