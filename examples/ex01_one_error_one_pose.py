"""One error, one pose: the pitch of X, EBX = 10 µrad, and where it sends the tool point.

The error turns the tool relative to the workpiece about the reference point of X, so the tool
point moves by e + r x (x - c): nothing along the rotation, and across it by angle times arm.
"""

from pathlib import Path

import numpy as np

from matstd.twin.effects import component
from matstd.twin.files import read_machine
from matstd.twin.machine import exact_tip, tip
from matstd.twin.model import Model, contribution
from matstd.twin.record import at_poses
from matstd.twin.units import UM, URAD

HERE = Path(__file__).parent
LENGTH = 160.0  # mm, gauge point to ball centre
READINGS = {"X": 100.0, "Y": 50.0, "Z": -200.0}


def main():
    chain = read_machine(HERE / "hsm600u-machine.toml")
    q = np.array([[READINGS.get(axis, 0.0) for axis in chain.axes]])  # (1, A)
    pose = at_poses(chain, q, LENGTH)
    error = component(chain, "EBX", "constant")
    theta = np.array([10 * URAD])
    nominal = tip(chain, q, LENGTH)
    exact = exact_tip(chain, q, LENGTH, contribution([(error, theta)], pose)) - nominal
    column = Model(chain, (error,)).tip_columns(pose)  # (1, 3, 1), mm per rad
    return {
        "nominal tool point, mm": nominal[0],
        "exact deviation, µm": exact[0] / UM,
        "first order, µm": (column @ theta)[0] / UM,
    }


def draw(result):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(4.8, 3.6), layout="constrained")
    arm, d = np.array([100.0, -360.0]), result["exact deviation, µm"][[0, 2]] * 40.0
    axes.plot([0, arm[0]], [0, arm[1]], "o-", color="0.55", ms=4)
    axes.annotate("", arm + d, arm, arrowprops={"arrowstyle": "-|>", "color": "C3", "lw": 2})
    axes.text(*(arm + d + [-12, 0]), "-3.6 µm, -1.0 µm", color="C3", ha="right", va="center")
    axes.text(14, 4, "reference point of X")
    axes.text(arm[0] + 16, arm[1], "tool point: (100, -360) mm", va="center")
    axes.set(xlim=(-300, 480), ylim=(-430, 40), aspect="equal")
    axes.set(xlabel="x, mm", ylabel="z, mm", title="EBX = 10 µrad turns about y")
    return figure


if __name__ == "__main__":
    for name, value in main().items():
        print(f"{name}: {np.round(value, 4)}")
    draw(main()).savefig(HERE / "pictures" / "ex01.png", dpi=100)
