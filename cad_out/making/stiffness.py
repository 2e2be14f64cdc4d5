"""First mode of a standard on its screws, and how its features sag when the table tilts.

Plate and pillars are cubes as stiff and heavy as they are filled; every post is a mass at its ball,
held to the plate's upper face round its foot by the stiffness of a cantilever. The
standard is held where it is screwed down.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, diags_array

from matstd.artefact.body import DatumSphere, Standard
from matstd.artefact.layout import cantilever_stiffness
from matstd.cad_out.details import BALL, Details
from matstd.cad_out.making.hexahedron import CORNERS, cube
from matstd.twin.frames import Array
from matstd.twin.sampling import grid_points

GRAVITY = 9.81e3  # in mm/s^2
_MIN_FILLING = 0.02  # of a cube, below which it is left out
_TO_TIP = 0.25  # of a cantilever's mass that swings with its end: 33/140, rounded up
_SHARE = 0.2  # of a displacement, its standard uncertainty: beams within 8 %, screws idealised
_BESIDE = 0.25
"""Of an element, beside a foot: tall balls within 5 % of scikit-fem (2 to 12 % softer)."""
_STIFF = 1e9  # N/mm that hold a node: ten thousand times a cube's own


@dataclass(frozen=True, eq=False)
class Stiffness:
    """What gravity and vibration do to a standard."""

    first_mode: float  # lowest natural frequency on rigid screws, Hz
    # displacement of every face's middle and ball, along x, y, z (rows), by weight along x, y, z
    # (columns), (3, 3), mm
    per_weight: dict[str, Array]
    # force on a ball per deflection in its softest direction, with post, plate and pads, N/mm, by
    # name
    at_balls: dict[str, float]
    cube: float  # side of the elements, mm

    @cached_property
    def sag(self) -> dict[str, float]:
        """From upright to lying on its side, the worst way, by feature, mm."""
        angle = np.linspace(0.0, 2.0 * np.pi, 25)
        across = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(25)])
        change = across - np.array([0.0, 0.0, -1.0])
        return {
            name: float(np.linalg.norm(change @ moved.T, axis=1).max())
            for name, moved in self.per_weight.items()
        }

    @property
    def worst(self) -> tuple[str, float]:
        """Where it sags most, and by how much, mm."""
        name = max(self.sag, key=self.sag.__getitem__)
        return name, self.sag[name]


def with_sag(standard: Standard, stiffness: Stiffness, down: str) -> Standard:
    """The standard with the sag that evaluations use; weight pulls to `down` of the machine."""
    made_of = standard.material
    share = round(float(np.hypot(_SHARE, made_of.modulus_share)), 2)
    per_weight = stiffness.per_weight
    return standard.sagging("finite elements", down, share, per_weight, made_of.modulus)


def stiffness_of(standard: Standard, details: Details, side: float = 10.0) -> Stiffness | None:
    """By finite elements; None where the modulus of the material is not known.

    Args:
        side: Of the cubes, mm; 10 and 6 mm differ by 1 % in the first mode, 2 % in a tall ball.
    """
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    modulus, poisson = standard.material.modulus, standard.material.poisson
    if modulus is None:
        return None
    cells, share = _cells(standard, side)
    corner = cells[:, None] + ((CORNERS + 1) / 2).astype(int)
    nodes, index = np.unique(corner.reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 8)
    places = nodes * side + _origin(standard)
    freedom = (3 * index[:, :, None] + np.arange(3)).reshape(len(index), 24)
    K_cube = cube(side, modulus, poisson)
    rows = np.repeat(freedom, 24, axis=1).ravel()
    columns = np.tile(freedom, (1, 24)).ravel()
    values = (share[:, None] * K_cube.reshape(1, -1)).ravel()
    balls = standard.spheres
    size = 3 * (len(nodes) + len(balls))
    mass = np.zeros(size)
    one = standard.material.density * side**3 / 8.0
    np.add.at(mass, freedom.ravel(), np.repeat(share * one, 24))
    extra = [
        _post_springs(ball, 3 * (len(nodes) + k), places, standard, side)
        for k, ball in enumerate(balls)
    ]
    for k, ball in enumerate(balls):
        tip = 3 * (len(nodes) + k)
        mass[tip : tip + 3] = _tip_mass(ball, standard)
    held = _screw_dofs(standard, details, places, side)
    ends = [e for e, _ in extra]
    rows = np.concatenate([rows, *[np.repeat(e, len(e)) for e in ends], held])
    columns = np.concatenate([columns, *[np.tile(e, len(e)) for e in ends], held])
    values = np.concatenate([values, *[K.ravel() for _, K in extra], np.full(len(held), _STIFF)])
    K = csc_array(coo_array((values, (rows, columns)), shape=(size, size)))
    factor = splu(K, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    solve = LinearOperator((size, size), matvec=factor.solve)
    start = np.ones(size)  # the random start of eigsh would change the last digits
    lowest = eigsh(K, k=1, M=diags_array(mass).tocsc(), sigma=0.0, OPinv=solve, v0=start)[0]
    shape = factor.solve(mass[:, None] * np.tile(np.eye(3), (size // 3, 1)) * GRAVITY)
    moved = shape.reshape(-1, 3, 3)  # node, displacement, direction of gravity
    return Stiffness(
        first_mode=float(np.sqrt(lowest[0]) / (2.0 * np.pi) * np.sqrt(1e3)),
        per_weight=_at_features(standard, places, moved * 1e-3),
        at_balls=_at_balls(factor.solve, size, balls),
        cube=side,
    )


def _at_balls(
    solve: Callable[[Array], Array], size: int, balls: tuple[DatumSphere, ...]
) -> dict[str, float]:
    """Force per deflection of every ball, N/mm; the last degrees of freedom are theirs."""
    if not balls:
        return {}
    unit = np.zeros((size, 3 * len(balls)))
    unit[size - 3 * len(balls) :] = np.eye(3 * len(balls))
    moved = solve(unit)[size - 3 * len(balls) :].reshape(len(balls), 3, len(balls), 3)
    return {
        ball.name: float(1.0 / np.linalg.eigvalsh(moved[k, :, k])[-1])
        for k, ball in enumerate(balls)
    }


def _origin(standard: Standard) -> Array:
    return np.array([-standard.base.half_size[0], -standard.base.half_size[1], 0.0])


def _cells(standard: Standard, side: float) -> tuple[Array, Array]:
    """Cubes filled by plate and pillars, (E, 3), and their filled share, (E,)."""
    low = _origin(standard)
    tops = [float(p.point(p.grid(4.0))[:, 2].max()) for p in standard.patches]
    high = np.array([*standard.base.half_size, max([standard.base.thickness, *tops])])
    counts = np.ceil((high - low) / side - 1e-6).astype(int)
    cells = grid_points(*(np.arange(n) for n in counts))
    middle = low + (cells + 0.5) * side
    parts = [standard.base.body.distance(middle)]
    parts += [column.distance(middle) for column in standard.columns.values()]
    distance = np.min(parts, axis=0)
    share = np.clip(0.5 - distance / side, 0.0, 1.0)
    return cells[share > _MIN_FILLING], share[share > _MIN_FILLING]


def _tip_mass(ball: DatumSphere, standard: Standard) -> float:
    """Mass of a ball and of the part of its post that swings with it, kg."""
    a, b, length = ball.foot_radius, ball.stem_radius, ball.centre[2] - ball.foot - ball.radius
    post = float(standard.material.density * np.pi * length * (a * a + a * b + b * b) / 3.0)
    return float(BALL.density * 4.0 / 3.0 * np.pi * ball.radius**3 + _TO_TIP * post)


def _post_springs(
    ball: DatumSphere, tip: int, places: Array, standard: Standard, side: float
) -> tuple[np.ndarray, Array]:
    """Degrees of freedom of a ball and of the plate round its foot, and their stiffness.

    The foot moves and turns as the nodes of the plate's upper face under it do, by least squares.
    """
    foot, top = np.array([*ball.centre[:2], ball.foot]), standard.base.thickness
    on_top = np.flatnonzero(np.abs(places[:, 2] - top) < 0.51 * side)
    off = np.linalg.norm(places[on_top] - foot, axis=1)
    # all of the foot: with fewer nodes a finer mesh makes the ball softer, half as stiff at 6 mm;
    # and a quarter of an element: nodes inside a disc span a smaller one, the foot has a fillet
    wide = ball.foot_radius + _BESIDE * side
    near = on_top[off <= max(wide, np.partition(off, 8)[8])]
    arm = places[near] - foot
    rigid = np.zeros((3 * len(near), 6))
    for k, (x, y, z) in enumerate(arm):
        rigid[3 * k : 3 * k + 3] = [[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]
    length = ball.centre[2] - ball.foot
    at_ball = np.array([[1, 0, 0, 0, length, 0], [0, 1, 0, -length, 0, 0], [0, 0, 1, 0, 0, 0]])
    carried = at_ball @ np.linalg.pinv(rigid)
    modulus, poisson = standard.material.modulus, standard.material.poisson
    assert modulus is not None
    # the elements under the foot give way, so that the post stands on a rigid plate here
    across = cantilever_stiffness(length, ball.stem_radius, ball.foot_radius, modulus, poisson)
    along = modulus * np.pi * ball.stem_radius * ball.foot_radius / length
    apart = np.hstack([np.eye(3), -carried])
    freedom = np.concatenate([tip + np.arange(3), (3 * near[:, None] + np.arange(3)).ravel()])
    return freedom, apart.T @ np.diag([across, across, along]) @ apart


def _screw_dofs(standard: Standard, details: Details, places: Array, side: float) -> np.ndarray:
    """Degrees of freedom of the underside that the screws hold."""
    low = np.flatnonzero(places[:, 2] < 0.5 * side)
    rings = [(pad.x, pad.y, pad.radius) for pad in details.pads]
    rings = rings or [(hole.x, hole.y, hole.bore_radius) for hole in standard.holes]
    chosen: list[Any] = []
    for x, y, radius in rings:
        off = np.hypot(places[low, 0] - x, places[low, 1] - y)
        inside = low[off <= max(radius, np.partition(off, 3)[3])]
        chosen.append(inside)
    nodes = np.unique(np.concatenate(chosen)) if chosen else low
    return (3 * nodes[:, None] + np.arange(3)).ravel()


def _at_features(standard: Standard, places: Array, moved: Array) -> dict[str, Array]:
    """Displacements of balls and middles of faces under weight along x, y, z, mm."""
    out = {}
    for patch in standard.patches:
        middle = patch.point(np.zeros((1, 2)))[0]
        out[patch.name] = moved[int(np.argmin(np.linalg.norm(places - middle, axis=1)))]
    for k, ball in enumerate(standard.spheres):
        out[ball.name] = moved[len(places) + k]
    return out
