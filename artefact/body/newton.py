"""Newton's method on height fields: foot points, and the contact of a moving ball."""

from collections.abc import Callable

import numpy as np

from matstd.artefact.body.patch import Hit
from matstd.artefact.body.spline import Jet
from matstd.twin.frames import Array, Mask, unit
from matstd.twin.units import NM

CONTACT_TOLERANCE = 1e-4 * NM  # Newton stops when the ball is this close to the surface, mm
_MAX_STEPS = 30  # Newton converges in a few steps; a search that needs more has failed
_MAX_STEP = 4.0  # mm of one step over the surface, within which Newton is trusted
_MAX_GAP = 0.1 * NM  # mm between ball and surface after the last step; more is no convergence

Surface = Callable[[Array], Jet]
Domain = tuple[Array, Array]


def foot_parameters(surface: Surface, domain: Domain, points: Array, uv: Array) -> Array:
    """Foot points on a height field: ``(S - p) . S_u = (S - p) . S_v = 0``.

    Newton on the squared distance, with the step of Gauss and Newton where the Hessian is not
    positive.

    Args:
        surface: Jet of the height at parameters (N, 2).
        points: Shape (N, 3), frame of the height field, mm.
        uv: Where to start, shape (N, 2), mm.

    Returns:
        Shape (N, 2), mm; nan where no foot point lies inside the domain.
    """
    uv = uv.copy()
    moved = np.full(len(points), np.inf)
    open_ = np.arange(len(points))
    for _ in range(_MAX_STEPS):
        step = _foot_step(surface(uv[open_]), uv[open_], points[open_])
        new = np.clip(uv[open_] + _shortened(step), *domain)
        moved[open_] = np.abs(new - uv[open_]).max(axis=1)
        uv[open_] = new
        open_ = open_[moved[open_] > CONTACT_TOLERANCE]
        if not len(open_):
            break
    found = (moved < NM) & _inside(uv, domain)
    return np.where(found[:, None], uv, np.nan)


def ball_contact(
    surface: Surface, domain: Domain, p: Array, d: Array, radius: float, first: Hit
) -> Hit:
    """Contact of moving balls with a height field, ``S(u, v) + radius n = p + t d``.

    Args:
        surface: Jet of the height at parameters (N, 2).
        p: Ball centres, shape (N, 3), frame of the height field, mm.
        d: Unit directions of travel, shape (N, 3).
        radius: Of the ball, mm.
        first: Where to start.

    Returns:
        Parameters and travel; nan where Newton does not converge inside the domain, or at a
        contact that the ball leaves instead of meeting.
    """
    uv, travel = first.uv.copy(), first.travel.copy()
    open_ = np.arange(len(p))
    for _ in range(_MAX_STEPS):
        j = surface(uv[open_])
        centre = p[open_] + travel[open_, None] * d[open_]
        residual = _offset_point(j, uv[open_], radius) - centre
        far = np.abs(residual).max(axis=1) > CONTACT_TOLERANCE
        open_ = open_[far]
        if not len(open_):
            break
        along_u, along_v = _offset_tangents(j, radius)
        step = -_solve3(along_u[far], along_v[far], -d[open_], residual[far])
        held = np.clip(uv[open_] + _shortened(step[:, :2]), *domain)
        short = open_[np.any(held != uv[open_] + step[:, :2], axis=1)]
        uv[open_] = held
        travel[open_] += step[:, 2]
        # where a step was shortened sideways, its full travel would overshoot: solve for it again
        centre = _offset_point(surface(uv[short]), uv[short], radius)
        travel[short] = np.einsum("ni,ni->n", centre - p[short], d[short])
    j = surface(uv)
    gap = np.abs(_offset_point(j, uv, radius) - p - travel[:, None] * d).max(axis=1)
    met = (gap < _MAX_GAP) & _inside(uv, domain)
    met &= np.einsum("ni,ni->n", graph_normal(j), d) < 0.0
    return Hit(np.where(met[:, None], uv, np.nan), np.where(met, travel, np.nan))


def graph_normal(j: Jet) -> Array:
    """Upward unit normals of a height field, (N, 3)."""
    return unit(np.column_stack([-j.hu, -j.hv, np.ones_like(j.h)]))


def _offset_point(j: Jet, uv: Array, radius: float) -> Array:
    """Ball centre that touches at uv, patch frame, (N, 3)."""
    return np.column_stack([uv, j.h]) + radius * graph_normal(j)


def _offset_tangents(j: Jet, radius: float) -> tuple[Array, Array]:
    """Derivatives of the touching ball's centre by u and v, patch frame, each (N, 3).

    With ``m = (-hu, -hv, 1)`` and ``n = m / w``: ``n_u = (m_u - n (n . m_u)) / w``.
    """
    w = np.sqrt(1.0 + j.hu**2 + j.hv**2)[:, None]
    n, nil, one = graph_normal(j), np.zeros_like(j.h), np.ones_like(j.h)
    tangents = []
    for S_k, m_k in (
        (np.column_stack([one, nil, j.hu]), np.column_stack([-j.huu, -j.huv, nil])),
        (np.column_stack([nil, one, j.hv]), np.column_stack([-j.huv, -j.hvv, nil])),
    ):
        n_k = (m_k - n * np.einsum("ni,ni->n", n, m_k)[:, None]) / w
        tangents.append(S_k + radius * n_k)
    return tangents[0], tangents[1]


def _solve3(a: Array, b: Array, c: Array, right: Array) -> Array:
    """Solutions x (N, 3) of ``a x0 + b x1 + c x2 = right`` by Cramer's rule; zero if singular."""
    bc = np.cross(b, c)
    det = np.einsum("ni,ni->n", a, bc)
    safe = np.where(np.abs(det) > 1e-12, det, np.inf)
    rc, br = np.cross(right, c), np.cross(b, right)
    dots = (
        np.einsum("ni,ni->n", right, bc),
        np.einsum("ni,ni->n", a, rc),
        np.einsum("ni,ni->n", a, br),
    )
    return np.column_stack(dots) / safe[:, None]


def _shortened(step: Array) -> Array:
    """Steps (N, 2), none longer than `_MAX_STEP`."""
    length = np.linalg.norm(step, axis=1, keepdims=True)
    return step * (_MAX_STEP / np.maximum(length, _MAX_STEP))


def _inside(uv: Array, domain: Domain) -> Mask:
    """Parameters strictly inside: a search that ends on the border was stopped there."""
    return np.all((uv > domain[0]) & (uv < domain[1]), axis=1)


def _foot_step(j: Jet, uv: Array, local: Array) -> Array:
    """Newton step of the foot-point search in the patch frame, (N, 2)."""
    dx, dy, dz = uv[:, 0] - local[:, 0], uv[:, 1] - local[:, 1], j.h - local[:, 2]
    gu, gv = dx + dz * j.hu, dy + dz * j.hv
    a0, b0, c0 = 1 + j.hu**2, j.hu * j.hv, 1 + j.hv**2
    a, b, c = a0 + dz * j.huu, b0 + dz * j.huv, c0 + dz * j.hvv
    firm = (a > 0.1) & (a * c - b * b > 0.1)
    a, b, c = np.where(firm, a, a0), np.where(firm, b, b0), np.where(firm, c, c0)
    det = a * c - b * b
    return np.column_stack([(b * gv - c * gu) / det, (b * gu - a * gv) / det])
