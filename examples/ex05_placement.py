"""Placement: positions and directions of patches, and the information of touches on them.

Sites, table poses and touches are chosen so that the tool point is predicted best after probing.
The comparison is the same number of touches on other artefacts.
"""

from pathlib import Path

import numpy as np

from matstd.artefact.brief import Brief, PlacementOptions
from matstd.artefact.place import design_standard
from matstd.artefact.worth import TouchOptions
from matstd.twin.files import read_machine
from matstd.twin.frames import apply
from matstd.twin.units import DEG, UM

HERE = Path(__file__).parent
OPTIONS = PlacementOptions(patches=8, sites=80, choice=TouchOptions(touches=160, poses=12))
LIMITS = {"X": (-150.0, 150.0), "Y": (-150.0, 150.0), "B": (-90 * DEG, 20 * DEG)}


def main():
    brief = Brief(read_machine(HERE / "hsm600u-machine.toml"), ranges=LIMITS, options=OPTIONS)
    placed = design_standard(brief, np.random.default_rng(600))
    return {
        "placement": placed,
        "not predicted before any touch, µm": placed.prior_rms[0] / UM,
        "not predicted after 160 touches, µm": {r.name: r.rms / UM for r in placed.rivals},
        "combinations determined": {r.name: r.estimable for r in placed.rivals},
    }


def draw(result):
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.4), layout="constrained")
    placed = result["placement"]
    for patch in placed.standard.patches:
        a, b = patch.half_size
        corners = np.array([[-a, -b, 0], [a, -b, 0], [a, b, 0], [-a, b, 0]])
        left.fill(*apply(patch.T_artefact_patch, corners)[:, :2].T, fc="#cfe2f3", ec="C0")
    left.plot(*placed.requests.point[:, :2].T, ".", color="C3", ms=3)
    for sphere in placed.standard.spheres:
        left.add_patch(plt.Circle(sphere.centre[:2], sphere.radius, fc="none", ec="C0"))
    left.set(xlabel="x, mm", ylabel="y, mm", aspect="equal", title="patches, spheres, touches")
    rest = result["not predicted after 160 touches, µm"]
    bars = right.barh([name.replace(" scatter", "") for name in rest], rest.values())
    right.bar_label(bars, fmt="%.1f", padding=3)
    right.set(xlabel="not predicted, µm rms", xlim=(0, 8), ylim=(6.6, -0.6))
    return figure


if __name__ == "__main__":
    draw(main()).savefig(HERE / "pictures" / "ex05.png", dpi=100)
