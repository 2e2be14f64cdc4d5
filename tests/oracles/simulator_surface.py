"""Curved, smooth pads of a standard: random graphs over a rectangle, and distances to them."""

from dataclasses import dataclass

import numpy as np

HALF = 18.0
"""Half the side of the touched rectangle of a pad, mm."""


NEXT_TO_NONE = 1e-9
"""Step of a Newton iteration, mm, after which the next would be below the last digit."""


@dataclass
class Pads:
    """M pads; the height over each one's own plane is a quadratic plus a wave.

    ``h = a xx + b xy + c yy + d sin(k x + f) sin(l y + g)``, and the form error of the true surface
    is a second wave of the same kind with an amplitude that is zero on all pads but one.
    """

    origin: np.ndarray  # (M, 3)
    frame: np.ndarray  # (M, 3, 3), columns x, y, z
    quadratic: np.ndarray  # (M, 3)
    wave: np.ndarray  # (M, 5): amplitude, k, f, l, g
    form: np.ndarray  # (M, 5)

    def __len__(self):
        return len(self.origin)

    def without_form(self):
        return Pads(self.origin, self.frame, self.quadratic, self.wave, np.zeros_like(self.form))


def random_pads(rng, count=11):
    """Pads on a ring around the middle of the standard, at several heights and tilts."""
    origin, frame = [], []
    for i in range(count):
        angle = 2.0 * np.pi * (i + rng.uniform(-0.3, 0.3)) / count
        distance = rng.uniform(50.0, 115.0)
        place = (distance * np.cos(angle), distance * np.sin(angle), rng.uniform(62.0, 120.0))
        azimuth, tilt = angle + rng.normal(0.0, 0.7), rng.uniform(0.05, 0.95)
        z = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
        x = np.cross((0.0, 1.0, 0.0), z)
        x /= np.linalg.norm(x)
        origin.append(place)
        frame.append(np.stack([x, np.cross(z, x), z], axis=1))
    curvature = rng.uniform(-0.009, 0.009, (count, 3))
    waves = np.stack(
        [
            rng.uniform(0.0, 0.05, count),
            2.0 * np.pi / rng.uniform(45.0, 90.0, count),
            rng.uniform(0.0, 2.0 * np.pi, count),
            2.0 * np.pi / rng.uniform(45.0, 90.0, count),
            rng.uniform(0.0, 2.0 * np.pi, count),
        ],
        axis=1,
    )
    return Pads(np.array(origin), np.array(frame), curvature, waves, np.zeros((count, 5)))


def height(pads, index, x, y):
    """Height and its derivatives h, hx, hy, hxx, hxy, hyy at places (N,) of pads index (N,)."""
    a, b, c = pads.quadratic[index].T
    h, hx, hy = a * x * x + b * x * y + c * y * y, 2 * a * x + b * y, b * x + 2 * c * y
    hxx, hxy, hyy = 2 * a, b + 0.0, 2 * c
    for wave in (pads.wave, pads.form):
        d, k, f, m, g = wave[index].T
        sx, cx, sy, cy = np.sin(k * x + f), np.cos(k * x + f), np.sin(m * y + g), np.cos(m * y + g)
        h, hx, hy = h + d * sx * sy, hx + d * k * cx * sy, hy + d * m * sx * cy
        hxx, hxy, hyy = (
            hxx - d * k * k * sx * sy,
            hxy + d * k * m * cx * cy,
            hyy - d * m * m * sx * sy,
        )
    return h, hx, hy, hxx, hxy, hyy


def surface_point(pads, index, x, y):
    """Points and unit normals in the artefact frame, (N, 3) each."""
    h, hx, hy, *_ = height(pads, index, x, y)
    local = np.stack([x, y, h], axis=1)
    normal = np.stack([-hx, -hy, np.ones_like(h)], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    frame = pads.frame[index]
    return pads.origin[index] + turn(frame, local), turn(frame, normal)


def turn(R, v):
    return (R @ v[:, :, None])[:, :, 0]


def foot(pads, index, ball, start):
    """Foot point of ball centres (N, 3) on their pads: places x, y and the signed distance.

    Newton on the squared distance, from places (2 arrays) close by.
    """
    frame = pads.frame[index]
    local = turn(np.swapaxes(frame, 1, 2), ball - pads.origin[index])
    x, y = start[0].copy(), start[1].copy()
    for _ in range(8):
        h, hx, hy, hxx, hxy, hyy = height(pads, index, x, y)
        dx, dy, dz = local[:, 0] - x, local[:, 1] - y, local[:, 2] - h
        gx, gy = dx + dz * hx, dy + dz * hy
        axx, axy, ayy = 1 + hx * hx - dz * hxx, hx * hy - dz * hxy, 1 + hy * hy - dz * hyy
        det = axx * ayy - axy * axy
        step_x, step_y = (ayy * gx - axy * gy) / det, (axx * gy - axy * gx) / det
        x, y = x + step_x, y + step_y
        if max(np.abs(step_x).max(), np.abs(step_y).max()) < NEXT_TO_NONE:
            break
    point, normal = surface_point(pads, index, x, y)
    return x, y, np.einsum("ni,ni->n", ball - point, normal)
