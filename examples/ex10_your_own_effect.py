"""Your own effect: a rotary table that lifts while it is clamped after a backward turn.

One frozen class states where it acts and how much; one `Kind` gives it a word to be found by.
"""

from dataclasses import dataclass

import numpy as np
from ex08_virtual_probing import MACHINE, probed

from matstd.diagnosis.answer import diagnose
from matstd.report.words import verdict_sentence
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.files import read_machine
from matstd.twin.library import register
from matstd.twin.model import Declared, Kind, Parameter
from matstd.twin.units import UM


@dataclass(frozen=True)
class ClampLift(Declared):
    """``EZC = h`` where C was last turned backwards, else nothing; h in mm, 1 to 10 um."""

    kind, acts_on = "clamp-lift", "EZC"
    parameters = (Parameter("lift", "mm", 5 * UM),)

    def amounts(self, touches):
        """One after a backward turn."""
        return (touches.last_move("C") < 0,)


KIND = Kind.of(
    ClampLift, formula="EZC = h after a backward turn, else 0", units="h: µm",
    typical="1 to 10 µm", source="a wedge that clamps", title="lift of the table by its clamp",
)  # fmt: skip


def main():
    rng, population = np.random.default_rng(10), Population(read_machine(MACHINE))
    hidden = ClampLift(), np.array([5 * UM])
    run = probed(population, [*drawn_errors(population, rng), hidden], rng)
    before = diagnose(run, population.model)
    register(KIND)
    return {"before": before, "after": diagnose(run, population.model)}


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, 2, figsize=(7.6, 3.0), sharey=True, layout="constrained")
    for axes, (when, found) in zip(panels, main().items(), strict=True):
        print(f"{when}: {verdict_sentence(found)} {found.steps[-1].reported}")
        colour = np.where(found.run.touches.last_move("C") > 0, "C0", "C3")
        axes.scatter(range(len(colour)), found.fit.residual / UM, 4, colour)
        axes.set(title=f"{when}: {found.verdict.value}", xlabel="touch; red: C from above")
    panels[0].set_ylabel("residual, µm")
    figure.savefig(MACHINE.parent / "pictures" / "ex10.png", dpi=100)
