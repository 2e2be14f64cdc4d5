"""Sensitivities |dp/dE| along the D-MT paper's trajectory, and the errors of its figures 2 and 3.

X and C run linearly, B swings. |dp/dE| is one for every translation of an axis, and for an angle
the distance from the axis of the rotation: it says nothing of directions.
"""

from pathlib import Path

import numpy as np

from matstd.sensitivity.first_order import Workspace, sensitivity
from matstd.sensitivity.study import along_path, paper_trajectory
from matstd.twin.effects import component
from matstd.twin.files import read_machine
from matstd.twin.units import DEG, UM

HERE = Path(__file__).parent
LIMITS = {"X": (-400.0, 400.0), "B": (-90 * DEG, 20 * DEG), "C": (-180 * DEG, 180 * DEG)}
SHOWN = ("EXX", "EYC", "EBB", "ECC", "EAX")


def main():
    chain = read_machine(HERE / "hsm600u-machine.toml")
    path = paper_trajectory(
        Workspace(chain, LIMITS, 160.0), count=201, held={"Y": 50.0, "Z": -200.0}
    )
    S = sensitivity(chain, path.q, path.length, [chain.symbol(name) for name in SHOWN])

    def volumetric(sizes, shape):
        errors = [(component(chain, n, shape), np.array([a * UM])) for n, a in sizes.items()]
        return along_path(path, errors).size / UM

    return {
        "C, deg": path.q[:, chain.axis_index("C")] / DEG,
        "S": dict(zip(SHOWN, S.T, strict=True)),
        "from X, µm": volumetric({"EXX": 50.0, "EYX": 75.0, "EZX": 100.0}, "linear"),
        "from C, µm": volumetric({"EXC": 10.0, "EYC": 10.0}, "sinusoidal"),
    }


def draw(result):
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.2), layout="constrained")
    for name, S in result["S"].items():
        left.semilogy(result["C, deg"], S, "--" if name == "EYC" else "-", label=name)
    left.set(xlabel="C, deg", ylabel="|dp/dE|, mm/mm or mm/rad", ylim=(0.5, 1000))
    left.legend(ncol=2, loc=(0.2, 0.18), frameon=False)
    right.plot(result["C, deg"], result["from X, µm"], label="EXX, EYX, EZX")
    right.plot(result["C, deg"], result["from C, µm"], label="EXC, EYC")
    right.set(xlabel="C, deg", ylabel="volumetric error, µm", ylim=(0, 150))
    right.legend(loc="upper center", frameon=False)
    return figure


if __name__ == "__main__":
    draw(main()).savefig(HERE / "pictures" / "ex03.png", dpi=100)
