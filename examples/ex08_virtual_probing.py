"""Virtual probing: a program run on the exact twin of a random machine, and what is learnt of it.

The true ball meets the true surface, the control's log is read back, a model is fitted; the proof
is at poses that nobody probed.
"""

import tempfile
from dataclasses import astuple
from itertools import product
from pathlib import Path

import numpy as np
from ex06_step import standard

from diagnosis.fit import fit_run
from diagnosis.proof import probed_volume, prove
from probe_paths.campaign import simulate
from probe_paths.contacts import VirtualMachine
from probe_paths.plan import PlanOptions, TouchRequests, requests_at
from probe_paths.planner import plan_touches
from probe_paths.probe import Probe
from probe_paths.program import make_programs
from sensitivity.sampling import Population, drawn_errors
from twin.effect import contribution
from twin.files.machine_file import read_machine
from twin.touches import Setup
from twin.units import DEG, UM

HERE, NOISE = Path(__file__).parent, 1.0 * UM
FACE = np.array([[0.0, 0.0], [14.0, 14.0], [-14.0, 14.0], [-14.0, -14.0], [14.0, -14.0]])  # mm
BALL = np.array([[0, 90], [0, 30], [120, 30], [240, 30]]) * DEG  # azimuth, elevation
POSES = [np.array(pose) * DEG for pose in product((-120, 0, 60, 180), (-70, -45, -20, 5))]


def main():
    made, setup, rng = standard(), Setup("a"), np.random.default_rng(8)
    population = Population(read_machine(HERE / "hsm600u-machine.toml"))
    sets = [(p.name, FACE) for p in made.patches] + [(s.name, BALL) for s in made.spheres]
    each = [requests_at(made, *one, pose) for one in sets for pose in POSES]
    wanted = TouchRequests(*map(np.concatenate, zip(*map(astuple, each), strict=True)))
    options = PlanOptions(tolerated=len(wanted))  # leave out what the probe cannot reach
    plan = plan_touches(made, population.chain, Probe(), setup, wanted, options)
    errors = drawn_errors(population, rng)
    machine = VirtualMachine(population.chain, lambda t: contribution(errors, t), noise=NOISE)
    with tempfile.TemporaryDirectory() as folder:
        run = simulate(make_programs(plan).write(folder), made, machine, rng).run
    fit = fit_run(run, population.model)
    proof = prove(fit, errors, setup, probed_volume(run, 500, rng))
    return {"run": run, "fit": fit, "proof": proof}


if __name__ == "__main__":
    from PIL import Image

    from diagnosis.proof_picture import write_proof_picture

    picture = HERE / "pictures" / "ex08.png"
    write_proof_picture(picture, [main()["proof"]])
    Image.open(picture).resize((840, 336)).save(picture)
