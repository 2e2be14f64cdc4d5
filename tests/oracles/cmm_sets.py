"""Measurements of a coordinate measuring machine on pieces whose truth is known.

Faces by scipy's B-splines from the numbers of a `standard.toml`, balls by their equation. Planted
are places and radii of balls, smooth form and short waves of faces; of the machine noise, an error
that the points of a feature share, and one scale. The frame of the truth is that of its balls, by
Horn's quaternions.
"""

import numpy as np
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

UM = 1e-3
U_POINT, U_FEATURE, U_SCALE = 0.3 * UM, 0.4 * UM, 3e-6
PITCH, LINE, RIM = 5.0, 1.0, 2.0
TURN, ASIDE = Rotation.from_rotvec([0.01, -0.02, 1.2]), np.array([300.0, 200.0, -50.0])


class Face:
    """A face as drawn, with planted deviations along its normal."""

    def __init__(self, table, rng, waves):
        self.table, self.half = table, np.array(table["half_size_mm"])
        self.low = rng.normal(0.0, 3.0 * UM, 4)
        self.length = rng.uniform(8.0, 15.0, 2)
        self.phase = rng.uniform(0.0, 2.0 * np.pi, 2)
        self.waves = waves * np.sqrt(2.0) * rng.uniform(0.5, 1.5, 2)

    def off(self, uv):
        u, v = (uv / self.half).T
        smooth = np.column_stack([np.ones(len(uv)), u, v, np.sin(1.5 * u + v)]) @ self.low
        ripple = np.sin(2.0 * np.pi * uv / self.length + self.phase) @ self.waves
        return smooth + ripple

    def at(self, uv):
        """Points on the drawn face and outward normals."""
        degree, heights = self.table["degree"], np.array(self.table["heights_mm"])
        knots = np.array(self.table["knots_u_mm"]), np.array(self.table["knots_v_mm"])

        def height(u, v):
            along = BSpline(knots[1], heights.T, degree[1])(v)
            return np.einsum(
                "nk,nk->n", BSpline(knots[0], np.eye(len(heights)), degree[0])(u), along
            )

        h, (u, v) = 1e-5, uv.T
        slope = [(height(u + h, v) - height(u - h, v)) / (2 * h),
                 (height(u, v + h) - height(u, v - h)) / (2 * h)]  # fmt: skip
        n = np.column_stack([-slope[0], -slope[1], np.ones(len(uv))])
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        R = np.array(self.table["rotation"])
        return np.column_stack([u, v, height(u, v)]) @ R.T + self.table["origin_mm"], n @ R.T

    def places(self, lines):
        """A grid, and a dense line along either direction between its rows, (N, 2)."""
        ends = self.half - RIM
        axes = [np.linspace(-e, e, int(np.ceil(2 * e / PITCH)) + 1) for e in ends]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 2)
        if not lines:
            return grid
        step = [axis[1] - axis[0] for axis in axes]
        aside = [axis[len(axis) // 2] - 0.5 * s for axis, s in zip(axes, step, strict=True)]
        dense = [np.arange(-e, e + 1e-9, LINE) for e in ends]
        along_u = np.column_stack([dense[0], np.full(len(dense[0]), aside[1])])
        along_v = np.column_stack([np.full(len(dense[1]), aside[0]), dense[1]])
        return np.concatenate([grid, along_u, along_v])


def upper_half(rng, count):
    z, phi = rng.uniform(0.0, 1.0, count), rng.uniform(0.0, 2.0 * np.pi, count)
    return np.column_stack([np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi), z])


def horn(a, b):
    """Rotation and shift that bring points a to b best."""
    S = (a - a.mean(0)).T @ (b - b.mean(0))
    d = np.array([S[1, 2] - S[2, 1], S[2, 0] - S[0, 2], S[0, 1] - S[1, 0]])
    N = np.block([[np.trace(S), d], [d[:, None], S + S.T - np.trace(S) * np.eye(3)]])
    w, x, y, z = np.linalg.eigh(N)[1][:, -1]
    R = Rotation.from_quat([x, y, z, w])
    return R, b.mean(0) - R.apply(a.mean(0))


class Piece:
    """A piece, and what a machine measures on it."""

    def __init__(self, file, seed, waves):
        rng = np.random.default_rng(seed)
        self.rng = rng
        self.balls = {b["name"]: b for b in file["sphere"]}
        drawn = np.array([b["centre_mm"] for b in file["sphere"]])
        self.centres = drawn + rng.normal(0.0, 15.0 * UM, drawn.shape)
        self.radii = {n: b["radius_mm"] + rng.normal(0.0, 0.5 * UM) for n, b in self.balls.items()}
        self.faces = {p["name"]: Face(p, rng, waves) for p in file["patch"]}
        self.drawn = drawn
        self.back = horn(self.centres, drawn)

    def true_centres(self):
        return self.back[0].apply(self.centres) + self.back[1]

    def true_points(self, name, uv):
        """Points of the real face in the frame of its balls, and normals."""
        face = self.faces[name]
        p, n = face.at(uv)
        R, t = self.back
        return R.apply(p + face.off(uv)[:, None] * n) + t, R.apply(n)

    def rows(self, lines=True):
        """Name and coordinates of every measured point."""
        rng, out = self.rng, []
        scale = 1.0 + rng.normal(0.0, U_SCALE)
        parts = []
        for (name, r), c in zip(self.radii.items(), self.centres, strict=True):
            n = upper_half(rng, 40)
            r = r + rng.normal(0.0, U_FEATURE) + rng.normal(0.0, U_POINT, (40, 1))
            parts.append((name, c + r * n))
        for name, face in self.faces.items():
            uv = face.places(lines)
            p, n = face.at(uv)
            off = face.off(uv) + rng.normal(0.0, U_POINT, len(uv))
            parts.append((name, p + off[:, None] * n))
        for name, points in parts:
            shared = rng.normal(0.0, U_FEATURE, 3)
            there = scale * TURN.apply(points + shared) + ASIDE
            out += [(f"{name}_{k}", *p) for k, p in enumerate(there, 1)]
        return out


def write_rows(path, rows):
    lines = ["feature,x [mm],y [mm],z [mm]"]
    lines += [f"{name},{x:.8f},{y:.8f},{z:.8f}" for name, x, y, z in rows]
    path.write_text("\n".join(lines) + "\n")
    return path


def scores(file, made, piece, rng, count=40):
    """Errors of a calibration over stated uncertainties: distances of balls, radii, faces.

    Args:
        file: Tables of the designed standard.
        made: Tables of the calibrated one.
    """
    known = made["calibration"]["feature"]
    u_scale = 1e-6 * made["calibration"]["scale_u_ppm"]
    names = list(piece.balls)
    found = {b["name"]: b for b in made["sphere"]}
    centre = np.array([found[n]["centre_mm"] for n in names])
    u = np.array([known[n]["u_axes_um"] for n in names]) * UM
    truth = piece.true_centres()
    distance = []
    for i in range(len(names)):
        for j in range(i):
            e = truth[i] - truth[j]
            d = np.linalg.norm(e)
            u_d = np.sqrt(((e / d) ** 2 @ (u[i] ** 2 + u[j] ** 2)) + (u_scale * d) ** 2)
            distance.append((np.linalg.norm(centre[i] - centre[j]) - d) / u_d)
    u_radius = {v["feature"]: 0.5 * v["u_um"] * UM for v in made["calibration"]["verdict"]
                if v["characteristic"] == "diameter"}  # fmt: skip
    radius = [(found[n]["radius_mm"] - piece.radii[n]) / u_radius[n] for n in names]
    middle = piece.drawn.mean(axis=0)
    J = np.concatenate([np.hstack([np.eye(3), -cross(p - middle)]) for p in piece.drawn])
    frame = np.mean(u**2) * np.linalg.inv(J.T @ J)
    faces = []
    for table in made["patch"]:
        name, half = table["name"], np.array(table["half_size_mm"])
        uv = rng.uniform(-1.0, 1.0, (count, 2)) * (half - RIM)
        there, _ = piece.true_points(name, uv)
        made_face = Face(table, np.random.default_rng(0), 0.0)
        here, normal = made_face.at(uv)
        for _ in range(3):  # the foot point of the true point on the made face
            R = np.array(table["rotation"])
            aside = (there - here) - np.sum((there - here) * normal, axis=1)[:, None] * normal
            uv = uv + (aside @ R)[:, :2]
            here, normal = made_face.at(uv)
        error = np.sum((here - there) * normal, axis=1)
        row = known[name]
        arm = np.linalg.norm(uv, axis=1)
        K = np.hstack([normal, np.cross(there - middle, normal)])
        square = (row["u_um"] ** 2 + row["u_form_um"] ** 2) * UM**2
        square = square + (row["u_urad"] * 1e-6 * arm) ** 2 + np.einsum("ni,ij,nj->n", K, frame, K)
        square = square + (u_scale * np.sum((there - middle) * normal, axis=1)) ** 2
        faces += (error / np.sqrt(square)).tolist()
    return np.array(distance), np.array(radius), np.array(faces)


def cross(a):
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
