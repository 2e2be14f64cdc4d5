"""A patch: a saddle of known curvature as a B-spline, its normals, and a ball that meets it.

On one span of degree 2 over [-A, A] the control values of x^2 are A^2, -A^2, A^2: nine control
heights are the saddle u^2/(2 R1) - v^2/(2 R2) exactly. Positive curvature is concave from outside.
"""

from pathlib import Path

import numpy as np

from matstd.artefact.body import OVERHANG, graph_patch
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.units import DEG

HERE = Path(__file__).parent
R1, R2 = 60.0, 90.0  # mm, concave along u, convex along v
HALF, BALL = (24.0, 24.0), 3.0  # mm


def saddle(name, T_artefact_patch):
    square = np.array([1.0, -1.0, 1.0]) * (HALF[0] + OVERHANG) ** 2
    heights = square[:, None] / (2 * R1) - square[None, :] / (2 * R2)
    return graph_patch(name, T_artefact_patch, HALF, heights, degree=(2, 2))


def main():
    tilted = pose(fixed_xyz(np.array([0.0, 40 * DEG, 0.0])), np.array([60.0, 0.0, 120.0]))
    patch = saddle("FF1", tilted)
    middle = np.zeros((1, 2))
    start = patch.point(middle) + (BALL + 10.0) * patch.normal(middle)
    hit = patch.contact(start, -patch.normal(middle), BALL)  # a ball goes down from 10 mm above
    return {
        "patch": patch,
        "principal radii in the middle, mm": 1.0 / patch.curvature(middle)[0],
        "slope at u = 24 mm, deg": patch.slope(np.array([[HALF[0], 0.0]]))[0] / DEG,
        "normal in the middle": patch.normal(middle)[0],
        "travel of the ball, mm": hit.travel[0],
    }


def draw(result):
    import matplotlib.pyplot as plt

    patch, u = result["patch"], np.linspace(-HALF[0], HALF[0], 33)
    uv = np.stack(np.meshgrid(u, u, indexing="ij"), axis=-1)  # (33, 33, 2)
    x, y, z = patch.point(uv.reshape(-1, 2)).T.reshape(3, 33, 33)
    concave = patch.curvature(uv.reshape(-1, 2))[:, 0].reshape(33, 33)
    figure = plt.figure(figsize=(5.4, 3.6), layout="constrained")
    axes = figure.add_subplot(projection="3d", elev=30, azim=-25)
    colour = plt.cm.ScalarMappable(plt.Normalize(0.012, 0.017), "viridis")
    axes.plot_surface(x, y, z, facecolors=colour.to_rgba(concave), rcount=33, ccount=33)
    few = uv[::8, ::8].reshape(-1, 2)
    axes.quiver(*patch.point(few).T, *(9 * patch.normal(few)).T, color="C3", lw=1)
    axes.set(xlabel="x, mm", ylabel="y, mm", zticks=[110, 120, 130], aspect="equal")
    figure.colorbar(colour, ax=axes, shrink=0.6, pad=0.14, label="concave curvature, 1/mm")
    return figure


if __name__ == "__main__":
    draw(main()).savefig(HERE / "pictures" / "ex04.png", dpi=100)
