"""Diagnosis: identify the effect that the model of a machine lacks.

The machine of example 8 gets a backlash of C that its model lacks. The diagnosis finds that the
residuals are not noise, names the effect with its size, and the error falls to the noise.
"""

import numpy as np
from ex08_virtual_probing import MACHINE, probed

from matstd.diagnosis.answer import diagnose
from matstd.report.words import verdict_sentence
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.files import read_machine
from matstd.twin.library import parse_effect
from matstd.twin.units import UM, URAD

BACKLASH = 80 * URAD


def main():
    rng, population = np.random.default_rng(9), Population(read_machine(MACHINE))
    hidden = parse_effect("backlash(C)", population.chain), np.array([BACKLASH])
    run = probed(population, [*drawn_errors(population, rng), hidden], rng)
    found = diagnose(run, population.model)
    return {
        "sentence": verdict_sentence(found),
        "effects": [effect.name for effect in found.found],
        "size": found.steps[-1].reported[0],
        "rms, µm": [step.fit.rms / UM for step in found.steps],
        "held out, µm": [step.fit.test_rms / UM for step in found.steps],
        "log odds of single effects": {c.effect: c.log_odds for c in found.candidates},
    }


def draw(result):
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.0), layout="constrained")
    steps = ["ordinary model", *result["effects"]]
    left.plot(steps, result["rms, µm"], "o-", label="fitted touches")
    left.plot(steps, result["held out, µm"], "s--", label="held-out poses")
    left.axhline(1.0, color="0.6", lw=0.8, label="noise")
    left.set(ylabel="rms, µm", ylim=(0, 2.2), xlim=(-0.4, 1.4))
    left.legend(frameon=False)
    odds = dict(list(result["log odds of single effects"].items())[:6])
    right.barh(list(odds), list(odds.values()))
    right.set(xlabel="log odds against no effect")
    right.invert_yaxis()
    return figure


if __name__ == "__main__":
    result = main()
    print(result["sentence"])
    draw(result).savefig(MACHINE.parent / "pictures" / "ex09.png", dpi=100)
