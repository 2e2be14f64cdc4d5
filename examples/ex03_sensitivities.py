"""Sensitivities |dp/dE| along the D-MT paper's trajectory, and the errors of its figures 2 and 3.

X and C run linearly, B swings. |dp/dE| is one for every translation of an axis, and for an angle
the distance from the axis of the rotation: it says nothing of directions.
"""

from pathlib import Path

import numpy as np

from sensitivity.jacobian import sensitivity
from twin.effects.geometric import component
from twin.files.machine_file import read_machine
from twin.model import Model
from twin.touches import at_poses
from twin.units import DEG, UM

HERE = Path(__file__).parent
SHOWN = ("EXX", "EYC", "EBB", "ECC", "EAX")


def main():
    chain = read_machine(HERE / "hsm600u-machine.toml")
    c = np.linspace(-np.pi, np.pi, 201)
    swing = (-35 + 55 * np.sin(2 * c)) * DEG
    axes = {"X": 400 * c / np.pi, "B": swing, "C": c, "Y": 50 + 0 * c, "Z": -200 + 0 * c}
    q = np.stack([axes.get(name, 0 * c) for name in chain.axes], axis=1)  # (201, A)
    poses = at_poses(chain, q, 160.0)
    S = sensitivity(chain, q, 160.0, [chain.symbol(name) for name in SHOWN])

    def volumetric(errors, shape):
        model = Model(chain, tuple(component(chain, name, shape) for name in errors))
        deviation = model.tip_deviation(poses, np.array([*errors.values()]))
        return np.linalg.norm(deviation, axis=1) / UM

    return {
        "C, deg": c / DEG,
        "S": dict(zip(SHOWN, S.T, strict=True)),
        "from X, µm": volumetric({"EXX": 50 * UM, "EYX": 75 * UM, "EZX": 100 * UM}, "linear"),
        "from C, µm": volumetric({"EXC": 10 * UM, "EYC": 10 * UM}, "sinusoidal"),
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
