"""A probing program for the iTNC 530, written from a plan and read back from its own text.

Nothing is tilted: X and Y are readings less the preset, Z is that of the ball's lowest point.
"""

from pathlib import Path

import numpy as np
from ex06_step import standard

from matstd.artefact.reach import joined
from matstd.probe_paths.control import interpret
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import Probe, plan_touches, requests_at
from matstd.twin.files import read_machine
from matstd.twin.record import Setup
from matstd.twin.units import DEG

HERE = Path(__file__).parent
UV = np.array([[0.0, 0.0], [12.0, 12.0], [-12.0, 12.0], [-12.0, -12.0], [12.0, -12.0]])  # mm
POSES = [("FF1", 0, 0), ("FF2", 0, 0), ("FF2", -40, 180), ("FF3", -50, -60), ("FF4", -50, 60)]


def main():
    chain, made = read_machine(HERE / "hsm600u-machine.toml"), standard()
    each = [requests_at(made, name, UV, np.array([c, b]) * DEG) for name, b, c in POSES]
    wanted = joined(each)
    programs = make_programs(plan_touches(made, chain, Probe(), Setup("a"), wanted))
    (program,) = programs.programs
    read = interpret(program.text.encode(), Path("MS_A_1.H"), programs.masks.get, chain)
    return {
        "programs": programs,
        "text": program.text.replace("\r\n", "\n"),
        "minutes": program.duration / 60.0,
        "feature": [read.features[touch.feature] for touch in read.touches],
        "readings": np.array([touch.q for touch in read.touches]),  # (33, A)
        "came from": np.array([touch.side for touch in read.touches]),  # (33, A)
    }


def draw(result):
    import matplotlib.pyplot as plt

    number = np.arange(1, len(result["feature"]) + 1)
    figure, axes = plt.subplots(figsize=(5.4, 3.2), layout="constrained")
    for column, name, colour in ((1, "B", "C0"), (0, "C", "C1")):
        reading, side = result["readings"][:, column] / DEG, result["came from"][:, column]
        axes.step(number, reading, where="mid", color=colour, lw=0.8, label=name)
        for sign, marker in ((1, "^"), (-1, "v")):
            axes.plot(number[side == sign], reading[side == sign], marker, color=colour, ms=4)
    for k in number[[f.startswith("SPH") for f in result["feature"]]]:
        axes.axvline(k, color="0.8", lw=3, zorder=0)
    axes.set(xlabel="touch (grey: anchor sphere)", ylabel="reading, deg; ▲▼: last motion")
    axes.legend(frameon=False)
    return figure


if __name__ == "__main__":
    draw(main()).savefig(HERE / "pictures" / "ex07.png", dpi=100)
