"""The 71 error parameters of [w C' B' X' f Y Z (C1) t], and what each does at one pose.

Six component errors an axis; of the location errors only those that change anything; the set-up
of the workpiece (6) and of the tool (5: its rotation about itself cannot be seen).
"""

from collections import Counter
from pathlib import Path

import numpy as np

from matstd.sensitivity.first_order import sensitivity
from matstd.twin.files import read_machine
from matstd.twin.machine import LETTERS, Family, Ranges
from matstd.twin.units import DEG, UM

HERE = Path(__file__).parent
LENGTH = 160.0  # mm
READINGS = {"X": 100.0, "Y": 50.0, "Z": -200.0, "B": -30 * DEG, "C": 60 * DEG}


def main():
    chain = read_machine(HERE / "hsm600u-machine.toml")
    q = np.array([[READINGS.get(axis, 0.0) for axis in chain.axes]])
    S = sensitivity(chain, q, LENGTH)[0]  # (71,), mm/mm and mm/rad
    expected = np.array([Ranges().sd(chain, symbol) for symbol in chain.symbols])
    family = Counter(symbol.family.name for symbol in chain.symbols)
    effect = dict(zip([s.name for s in chain.symbols], S * expected / UM, strict=True))
    return {
        "parameters": len(chain.symbols),
        **{f"of family {name}": count for name, count in family.items()},
        "largest at this pose": max(effect, key=effect.__getitem__),
        "effect of each at this pose, µm": effect,
    }


def draw(result):
    import matplotlib.pyplot as plt

    chain = read_machine(HERE / "hsm600u-machine.toml")
    links = [link.name for link in chain.links]
    table = np.full((12, len(links)), np.nan)
    for s in chain.symbols:
        row = s.component + (0 if s.family is Family.COMPONENT else 6)
        table[row, links.index(s.link)] = result["effect of each at this pose, µm"][s.name]
    figure, axes = plt.subplots(figsize=(4.8, 4.6), layout="constrained")
    picture = axes.imshow(table, cmap="YlOrRd", vmin=0, vmax=120, aspect="auto")
    for (i, j), value in np.ndenumerate(table):
        if np.isfinite(value):
            axes.text(j, i, f"{value:.0f}", ha="center", va="center", size=8)
    axes.axhline(5.5, color="k", lw=1)
    axes.set_xticks(range(len(links)), links)
    axes.set_yticks(range(12), [f"E{c}_" for c in LETTERS] + [f"E{c}0_" for c in LETTERS])
    figure.colorbar(picture, label="expected effect at the tool point, µm")
    return figure


if __name__ == "__main__":
    draw(main()).savefig(HERE / "pictures" / "ex02.png", dpi=100)
