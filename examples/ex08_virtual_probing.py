"""Virtual probing: a program runs on the exact twin of a random machine, and a model is fitted.

The true ball meets the true surface, the log is read back; the model is tested at other poses.
"""

import tempfile
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
from ex06_step import standard

from matstd.artefact.reach import joined
from matstd.diagnosis.accuracy import probed_volume, prove
from matstd.diagnosis.fit import fit_run
from matstd.probe_paths.campaign import VirtualMachine, simulate
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import PlanOptions, Probe, plan_touches, requests_at
from matstd.report.plots import draw_proof
from matstd.report.style import save
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.files import read_machine
from matstd.twin.model import contribution
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM

MACHINE, NOISE = Path(__file__).with_name("hsm600u-machine.toml"), 1.0 * UM
FACE = np.array([[0, 0], [14, 14], [-14, 14], [-14, -14], [14, -14]])  # mm
BALL = np.array([[0, 90], [0, 30], [120, 30], [240, 30]]) * DEG  # azimuth, elevation
C_DEG, B_DEG = (-120, 0, 60, 180), (-70, -45, -20, 5)


def probed(population, errors, rng, noise=NOISE, **true):
    made, rotary = standard(), [np.array(p) * DEG for p in product(C_DEG, B_DEG)]
    sets = [(p.name, FACE) for p in made.patches] + [(s.name, BALL) for s in made.spheres]
    each = [requests_at(made, *one, pose) for one in sets for pose in rotary]
    wanted = joined(each)
    options = PlanOptions(tolerated=len(wanted))  # leave out what the probe cannot reach
    plan = plan_touches(made, population.chain, Probe(), Setup("a"), wanted, options)
    caused = partial(contribution, errors)  # by all effects, at any touches
    machine = VirtualMachine(population.chain, caused, noise=noise, **true)
    with tempfile.TemporaryDirectory() as folder:
        return simulate(make_programs(plan).write(folder), made, machine, rng).run


def main():
    rng, population = np.random.default_rng(8), Population(read_machine(MACHINE))
    errors = drawn_errors(population, rng)
    fit = fit_run(run := probed(population, errors, rng), population.model)
    return {"fit": fit, "proof": prove(fit, errors, Setup("a"), probed_volume(run, 500, rng))}


if __name__ == "__main__":
    from PIL import Image

    save(draw_proof([main()["proof"]]), path := MACHINE.parent / "pictures" / "ex08.png")
    Image.open(path).resize((840, 336)).save(path)
