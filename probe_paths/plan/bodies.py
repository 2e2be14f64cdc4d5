"""Everything solid round the probe as convex bodies: the standard, the table, clamps, fixtures."""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import BLEND, FreeformPatch, Plate, Standard
from matstd.artefact.reach import Workshop, table_face
from matstd.probe_paths.plan.separation import CORNERS, Hulls
from matstd.twin.frames import Array, IntArray, apply, turn
from matstd.twin.record import Labels
from matstd.twin.rows import stacked

_CELL = 4.0  # mm: side of a prism's lid; its corners are 0.2 mm off at a radius of 12 mm
_FINE = 4  # intervals along a side of a cell at which the face is compared with its corners
_MAX_RISE_BETWEEN = 0.02  # mm: what a face of 12 mm radius may rise above these places in between


@dataclass(frozen=True, eq=False)
class Bodies:
    """Convex bodies, each within the outline of its owner."""

    hulls: Hulls  # one of every owner that holds all of it, table frame
    name: Labels
    on: Labels  # axis that carries each, empty for the table, (B,)
    # what an owner really consists of, by its row; it is its hull where none is listed
    parts: dict[int, Hulls]

    def rows_of(self, feature: str) -> IntArray:
        """Bodies that a touch of a feature may come close to: its own and its stem."""
        own = {feature, f"{feature} stem", *(["BASE"] if feature == "DATUM_A" else [])}
        return np.flatnonzero(np.isin(self.name, list(own)))


def standing_bodies(standard: Standard, T_table_artefact: Array, workshop: Workshop) -> Bodies:
    """Bodies of a standard where it stands, and of what stands round it."""
    lots: list[tuple[str, str, Hulls]] = []
    base, plate = standard.base, standard.base.body
    lots.append(("BASE", "", _plate(plate, np.eye(4))))
    if standard.core is not None:
        core, low = standard.core, 0.5 * base.thickness
        ends = np.array([[0.0, 0.0, low], [0.0, 0.0, core.height]])
        lots.append(("CORE", "", _hull(ends, [core.low_radius, core.high_radius])))
    parts = {}
    for s in standard.spheres:
        lots.append((s.name, "", _hull(s.centre[None], [0.0], s.radius)))
        ends = np.array([[*s.centre[:2], s.foot], s.centre])
        post = _hull(ends, [s.foot_radius, s.stem_radius])
        if s.name in standard.blended:
            wide = s.foot_radius + BLEND
            chamfer = np.array([[*s.centre[:2], s.foot], [*s.centre[:2], s.foot + BLEND]])
            foot = _hull(chamfer, [wide, s.foot_radius])
            parts[len(lots)] = _moved(stacked([post, foot]), T_table_artefact)
            post = _hull(ends, [wide, s.stem_radius])
        lots.append((f"{s.name} stem", "", post))
    for patch in standard.patches:
        column = standard.columns[patch.name]
        box = Plate(patch.half_size, 0.0, -patch.depth, column.top)
        prisms = _prisms(patch)
        if patch.name in standard.blended:
            a, b = (half + BLEND for half in patch.half_size)
            box = Plate((a, b), 0.0, -patch.depth, column.top)
            prisms = stacked([prisms, _chamfer(patch, base.thickness)])
        parts[len(lots)] = _moved(prisms, T_table_artefact)
        lots.append((patch.name, "", _plate(box, patch.T_artefact_patch)))
    # hulls of owners are tested first, their parts only where a hull is near
    lots = [(name, on, _moved(hull, T_table_artefact)) for name, on, hull in lots]
    T_table_face = table_face(T_table_artefact)
    for solid in workshop.solids:
        hull = _plate(solid.plate, T_table_face @ solid.T_face_solid)
        lots.append((solid.name, solid.on, hull))
    return Bodies(
        hulls=stacked([hull for _, _, hull in lots]),
        name=np.array([name for name, _, _ in lots]),
        on=np.array([on for _, on, _ in lots]),
        parts=parts,
    )


def _chamfer(patch: FreeformPatch, foot: float) -> Hulls:
    """Chamfer that contains the concave blend round the foot of an upright pillar."""
    x, y = patch.T_artefact_patch[:2, 3]
    corners = [
        [x + s * (patch.half_size[0] + more), y + t * (patch.half_size[1] + more), foot + up]
        for more, up in ((BLEND, 0.0), (0.0, BLEND))
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    return _hull(np.array(corners), [0.0] * CORNERS)


def _hull(corners: Array, discs: list[float], ball: float = 0.0) -> Hulls:
    """One upright body; its last corner is repeated up to `CORNERS`."""
    some = np.minimum(np.arange(CORNERS), len(corners) - 1)
    return Hulls(
        corner=corners[some][None],
        disc=np.array(discs)[some][None],
        up=np.array([[0.0, 0.0, 1.0]]),
        ball=np.array([ball]),
    )


def _plate(plate: Plate, T: Array) -> Hulls:
    """A plate with rounded corners, moved."""
    a, b = (half - plate.corner_radius for half in plate.half_size)
    corners = [[x, y, z] for x in (-a, a) for y in (-b, b) for z in (plate.low, plate.high)]
    return _moved(_hull(np.array(corners), [plate.corner_radius] * CORNERS), T)


def _prisms(patch: FreeformPatch) -> Hulls:
    """A column cut under its face: a box up to its lowest place, and prisms from there upwards."""
    sides = [2 * max(int(np.ceil(half / _CELL)), 1) for half in patch.half_size]
    u, v = (
        np.linspace(-half, half, n * _FINE + 1)
        for half, n in zip(patch.half_size, sides, strict=True)
    )
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
    height = patch.height(uv.reshape(-1, 2)).reshape(uv.shape[:2])
    floor = float(height.min()) - 1.0
    cells = [
        _cell(_FINE * i, _FINE * j, uv, height, floor)
        for i in range(sides[0])
        for j in range(sides[1])
    ]
    below = Plate(patch.half_size, 0.0, -patch.depth, floor)
    return _moved(stacked([_plate(below, np.eye(4)), *cells]), patch.T_artefact_patch)


def _cell(i: int, j: int, uv: Array, height: Array, floor: float) -> Hulls:
    """The prism under one cell of a face, raised until it contains the face."""
    mine = np.s_[i : i + _FINE + 1, j : j + _FINE + 1]
    lid, share = height[mine], np.linspace(0.0, 1.0, _FINE + 1)
    s, t = share[:, None], share[None]
    corners = lid[np.ix_([0, -1], [0, -1])]
    flat = (
        corners[0, 0] * (1 - s) * (1 - t)
        + corners[1, 0] * s * (1 - t)
        + corners[0, 1] * (1 - s) * t
        + corners[1, 1] * s * t
    )
    top = corners + float((lid - flat).max()) + _MAX_RISE_BETWEEN
    outline = uv[mine][np.ix_([0, -1], [0, -1])].reshape(-1, 2)
    low = np.column_stack([outline, np.full(4, floor)])
    high = np.column_stack([outline, top.ravel()])
    return _hull(np.concatenate([low, high]), [0.0] * CORNERS)


def _moved(hulls: Hulls, T: Array) -> Hulls:
    return replace(hulls, corner=apply(T, hulls.corner), up=turn(T, hulls.up))
