"""A freeform patch: one B-spline height field over its own plane, trimmed to a rectangle."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from matstd.artefact.body.newton import ball_contact, foot_parameters, graph_normal
from matstd.artefact.body.patch import Hit, read_only, rows, sphere_entry
from matstd.artefact.body.spline import Jet, check_knots, clamped_knots, greville, pieces, powers
from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, Mask, apply, inverse, turn, unit
from matstd.twin.sampling import grid_points

OVERHANG = 6.0  # extension of the spline beyond the trimmed rectangle on every side, mm
LEAST_OVERHANG = 1.0  # smallest extension of a patch that is read from a file, mm
_GRID_PITCH = 2.0  # of the start grid, mm; finer than half the smallest concave radius allowed
_NUMBERS_A_BLOCK = 100_000  # numbers looked at together: in the cache, three times as fast


class ErrorShare(NamedTuple):
    """An error parameter that a patch reveals, and its share of the patch's signal (0 to 1)."""

    name: str
    share: float


@dataclass(frozen=True, eq=False)
class FreeformPatch:
    """A freeform face of the standard, and the column that carries it.

    In the patch frame ``S(u, v) = (u, v, h(u, v))`` with h a tensor B-spline: the poles stand at
    the Greville abscissae, so the parameters are millimetres of the patch's own x and y. The face
    is ``|u| <= a, |v| <= b``; its outward side is +z of the patch frame.
    """

    name: str  # feature name, FF1 ...
    T_artefact_patch: Array  # pose of the patch frame, shape (4, 4)
    half_size: tuple[float, float]  # (a, b), mm
    degree: tuple[int, int]  # (ku, kv)
    knots_u: Array  # shape (nu + ku + 1,), mm
    knots_v: Array  # shape (nv + kv + 1,), mm
    heights: Array  # control heights, shape (nu, nv), mm
    depth: float  # how far the column runs back along -z of the patch frame, mm
    errors: tuple[ErrorShare, ...] = ()  # error parameters that this patch reveals

    def __post_init__(self) -> None:
        for key, what in (("T_artefact_patch", "pose"), ("heights", "control heights")):
            object.__setattr__(
                self, key, read_only(getattr(self, key), what=f"{self.name}: {what}")
            )
        for key, axis in (("knots_u", 0), ("knots_v", 1)):
            k = self.degree[axis]
            what = f"{self.name}: {key}"
            knots = read_only(getattr(self, key), (self.heights.shape[axis] + k + 1,), what)
            check_knots(knots, k, self.half_size[axis] + LEAST_OVERHANG, what)
            object.__setattr__(self, key, knots)

    @cached_property
    def poles(self) -> Array:
        """Control net in the artefact frame, shape (nu, nv, 3), mm."""
        gu, gv = greville(self.knots_u, self.degree[0]), greville(self.knots_v, self.degree[1])
        x, y = np.meshgrid(gu, gv, indexing="ij")
        return apply(self.T_artefact_patch, np.stack([x, y, self.heights], axis=-1))

    def mean_plane(self) -> "FreeformPatch":
        """The flat pad in its place: the plane with its mean slopes through its mean height."""
        j = self.jet(self.grid())
        gu, gv = greville(self.knots_u, self.degree[0]), greville(self.knots_v, self.degree[1])
        heights = j.h.mean() + j.hu.mean() * gu[:, None] + j.hv.mean() * gv
        return replace(self, heights=heights)

    def scaled(self, k: float) -> "FreeformPatch":
        """The patch of a body scaled by k about its origin."""
        T = self.T_artefact_patch.copy()
        T[:3, 3] *= k
        # the overhang is not scaled: a smaller face needs the whole of it
        u, v = (k * a - max(0.0, 1.0 - k) * LEAST_OVERHANG for a in self.half_size)
        return replace(
            self,
            T_artefact_patch=T,
            half_size=(u, v),
            knots_u=k * self.knots_u,
            knots_v=k * self.knots_v,
            heights=k * self.heights,
        )

    @property
    def direction(self) -> Array:
        """The patch's own direction, +z of its frame, shape (3,)."""
        return self.T_artefact_patch[:3, 2]

    @property
    def is_upright(self) -> bool:
        """Whether its column is upright and parallel to the sides of the base (a pillar)."""
        return bool(np.abs(self.T_artefact_patch[:3, :3] - np.eye(3)).max() < 1e-12)

    @cached_property
    def T_patch_artefact(self) -> Array:
        """Artefact coordinates to patch coordinates, shape (4, 4)."""
        return inverse(self.T_artefact_patch)

    def jet(self, uv: Array) -> Jet:
        """Height over the patch's own plane with its derivatives at uv (N, 2)."""
        along_v, pu = self._along_v(uv, orders=3)
        orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
        return Jet(*(np.einsum("in,in->n", pu[a], along_v[b]) for a, b in orders))

    def height(self, uv: Array) -> Array:
        """Height at uv (N, 2), (N,), mm; twice as fast as `jet`."""
        (along_v,), (pu,) = self._along_v(uv, orders=1)
        return np.einsum("in,in->n", pu, along_v)

    def _along_v(self, uv: Array, orders: int) -> tuple[Array, Array]:
        """Height as polynomials of u at each point, with derivatives by v, and the powers of u.

        Coefficients and powers, each (orders, ku + 1, N).
        """
        (ku, kv), (u, v) = self.degree, rows(uv).T
        i, pu = powers(self.knots_u, ku, u, orders)
        j, pv = powers(self.knots_v, kv, v, orders)
        here = self._polynomials.take(i * (len(self.knots_v) - 2 * kv - 1) + j, axis=2)
        return np.einsum("ijn,bjn->bin", here, pv), pu

    @cached_property
    def _polynomials(self) -> Array:
        """Height as polynomials of the distances from the knots, (ku + 1, kv + 1, pieces)."""
        ku, kv = self.degree
        windows = np.lib.stride_tricks.sliding_window_view(self.heights, (ku + 1, kv + 1))
        along_u, along_v = pieces(self.knots_u, ku)[:, None], pieces(self.knots_v, kv)
        with np.errstate(invalid="ignore"):  # pieces of no length are never asked for
            every = along_u @ windows @ along_v.swapaxes(1, 2)
        return np.ascontiguousarray(np.moveaxis(every.reshape(-1, ku + 1, kv + 1), 0, 2))

    def point(self, uv: Array) -> Array:
        """Points of the surface, (N, 3), artefact frame, mm."""
        uv = rows(uv)
        return apply(self.T_artefact_patch, np.column_stack([uv, self.height(uv)]))

    def normal(self, uv: Array) -> Array:
        """Outward unit normals, (N, 3), artefact frame."""
        return turn(self.T_artefact_patch, graph_normal(self.jet(uv)))

    def curvature(self, uv: Array) -> Array:
        """Principal curvatures, (N, 2), 1/mm, largest first; positive = concave from outside."""
        return self.jet(uv).curvature

    def slope(self, uv: Array) -> Array:
        """Angle between the normal and the patch's own direction, (N,), rad."""
        j = self.jet(uv)
        return np.arctan(np.hypot(j.hu, j.hv))

    def contains(self, uv: Array) -> Mask:
        """Whether uv (N, 2) lies on the trimmed face; nan does not."""
        return np.all(np.abs(rows(uv)) <= np.asarray(self.half_size), axis=1)

    def grid(self, pitch: float = _GRID_PITCH, beyond: float = 0.0) -> Array:
        """Parameters of a regular grid over the face, extended by `beyond` mm, (N, 2)."""
        half = [a + beyond for a in self.half_size]
        axes = [np.linspace(-a, a, int(np.ceil(2 * a / pitch)) + 1) for a in half]
        return grid_points(*axes)

    def project(self, points: Array) -> Array:
        """Foot points on the (untrimmed) spline: ``(S - p) . S_u = (S - p) . S_v = 0``.

        Newton on the squared distance from the nearest node of a grid, with the step of
        Gauss and Newton where the Hessian is not positive.

        Args:
            points: Shape (N, 3), artefact frame, mm.

        Returns:
            uv, shape (N, 2), mm; nan where no foot point lies on the spline.
        """
        local = apply(self.T_patch_artefact, rows(points))
        return foot_parameters(self.jet, self.domain, local, self._nearest_node(local))

    def contact(
        self, start: Array, direction: Array, radius: float, first: Hit | None = None
    ) -> Hit:
        """First contact of a moving ball: ``S(u, v) + radius n(u, v) = start + t d``, by Newton.

        The search starts at the node of a grid over the trimmed face that the ball meets first, so
        that it finds the first of several contacts. It may end beyond the trimmed face, on the
        overhang of the spline: check with `contains`. The contact is unique where the smallest
        concave radius exceeds that of the ball.

        Args:
            start: Ball centres, shape (N, 3), artefact frame, mm.
            direction: Of travel, unit vectors, shape (N, 3) or (3,).
            radius: Of the ball, mm.
            first: Where the search starts, from `contact_start`; None to determine it here.

        Returns:
            uv (N, 2) and travel (N,); nan where the ball misses the face or Newton does not
            converge; negative travel where the ball starts in the material.
        """
        p = apply(self.T_patch_artefact, rows(start))
        d = turn(self.T_patch_artefact, unit(rows(direction, len(p))))
        uv, travel = first or self.contact_start(rows(start), rows(direction, len(p)), radius)
        hit_uv, hit_travel = np.full((len(p), 2), np.nan), np.full(len(p), np.nan)
        aimed = np.flatnonzero(np.isfinite(travel))
        if len(aimed):
            near = Hit(uv[aimed], travel[aimed])
            found = ball_contact(self.jet, self.domain, p[aimed], d[aimed], radius, near)
            hit_uv[aimed], hit_travel[aimed] = found
        return Hit(hit_uv, hit_travel)

    def contact_start(self, start: Array, direction: Array, radius: float) -> Hit:
        """Grid node that each ball meets first; infinite travel where it meets none."""
        uv, nodes, centre, reach = self._nodes
        d = unit(rows(direction, len(start)))
        best, travel = np.zeros(len(start), dtype=int), np.full(len(start), np.inf)
        # a ball whose line passes outside the bounding sphere of the face meets no node
        near = np.flatnonzero(np.isfinite(sphere_entry(centre, start, d, reach + radius)))
        # steep faces leave gaps between nodes: a node counts when the ball nearly touches it
        fat, offset = np.hypot(radius, 2.0 * _GRID_PITCH), nodes - centre
        for some in np.array_split(near, len(near) * len(nodes) // _NUMBERS_A_BLOCK + 1):
            to_centre = np.einsum("ni,ni->n", centre - start[some], d[some])
            foot = start[some] + to_centre[:, None] * d[some] - centre
            # relative to the foot of the centre on the ball's line, so that squares lose no digits
            along = d[some] @ offset.T
            across2 = np.einsum("ni,ni->n", foot, foot)[:, None] - 2.0 * foot @ offset.T
            across2 += np.einsum("ki,ki->k", offset, offset) - along**2
            along += to_centre[:, None]
            half_chord = np.sqrt(np.maximum(fat**2 - across2, 0.0))
            met = (across2 <= fat**2) & (along + half_chord >= 0.0)
            entry = np.where(met, along - half_chord, np.inf)
            best[some] = np.argmin(entry, axis=1)
            travel[some] = np.take_along_axis(entry, best[some, None], axis=1)[:, 0]
        return Hit(uv[best], travel + fat - radius)

    @cached_property
    def extremes(self) -> tuple[float, float]:
        """Height of the highest point, mm, and steepest slope, rad, on a 1 mm grid of the face."""
        j = self.jet(self.grid(1.0))
        return float(j.h.max()), float(np.arctan(np.hypot(j.hu, j.hv).max()))

    @cached_property
    def sharpest_valley(self) -> float:
        """Smallest concave radius of the spline, its overhang included, on a grid, mm."""
        low, high = self.domain
        beyond = float((np.minimum(-low, high) - self.half_size).min())
        largest = float(self.curvature(self.grid(1.0, beyond))[:, 0].max())
        return 1.0 / max(largest, 1e-9)

    @property
    def domain(self) -> tuple[Array, Array]:
        """Lowest and highest parameters of the spline, overhang included, each (2,), mm."""
        low = np.array([self.knots_u[0], self.knots_v[0]])
        return low, np.array([self.knots_u[-1], self.knots_v[-1]])

    @cached_property
    def _nodes(self) -> tuple[Array, Array, Array, float]:
        """Start grid: parameters, points, and a sphere round all of them (centre, radius)."""
        uv = self.grid()
        points = self.point(uv)
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        return uv, points, centre, float(np.linalg.norm(points - centre, axis=1).max())

    def _nearest_node(self, local: Array) -> Array:
        """Parameters of the node nearest to each point of the patch frame, (N, 2)."""
        from scipy.spatial import cKDTree

        uv, points, _, _ = self._nodes
        tree = cKDTree(apply(self.T_patch_artefact, points))
        return uv[tree.query(local)[1]]


def graph_patch(
    name: str,
    T_artefact_patch: Array,
    half_size: tuple[float, float],
    heights: ArrayLike,
    degree: tuple[int, int] = (5, 5),
    depth: float = 50.0,
    errors: tuple[ErrorShare, ...] = (),
) -> FreeformPatch:
    """Freeform patch from control heights on equally spaced clamped knots.

    Args:
        T_artefact_patch: Pose of the patch frame in the artefact, shape (4, 4).
        half_size: Half sides of the trimmed rectangle, mm.
        heights: Control heights, shape (nu, nv), mm; at least degree + 1 each way.
        depth: Length of the column behind the patch plane, mm.

    Returns:
        The patch, whose spline reaches `OVERHANG` beyond the rectangle.

    Raises:
        ShapeMismatch: Heights not a table, too few, or not finite.
    """
    net = read_only(heights, what=f"{name}: control heights")
    if net.ndim != 2:
        raise ShapeMismatch(f"{name}: control heights have {net.ndim} dimensions, expected 2")
    a, b = (float(half) + OVERHANG for half in half_size)
    return FreeformPatch(
        name=name,
        T_artefact_patch=T_artefact_patch,
        half_size=(float(half_size[0]), float(half_size[1])),
        degree=degree,
        knots_u=clamped_knots(-a, a, net.shape[0], degree[0]),
        knots_v=clamped_knots(-b, b, net.shape[1], degree[1]),
        heights=net,
        depth=float(depth),
        errors=tuple(errors),
    )
