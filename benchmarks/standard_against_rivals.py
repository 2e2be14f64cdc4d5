"""The finished standard against other artefacts, ten seeds, 300 touches of 1 µm, without CAD.

`OMP_NUM_THREADS=1 python benchmarks/standard_against_rivals.py [-n SEEDS]`, half a minute a seed.
For the example project: what each artefact leaves of the tool point, root mean square and 95 % of
the poses, over the volume that the standard fills and over the user's workspace, under equal rules.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from artefact.brief import read_project
from artefact.compare import Rival
from artefact.layout import Blank, Fittings
from artefact.place import PlacementOptions, design_standard
from artefact.reach import ProbeReach
from artefact.worth import TouchOptions
from probe_paths.plan import Probe
from sensitivity.first_order import Workspace
from twin.units import UM

PROJECT = Path(__file__).parents[1] / "examples" / "hsm600u.toml"
TOUCHES = 300
IDEAL = "ideal scatter, chosen by D"


def rivals_of(seed: int) -> tuple[Rival, ...]:
    """The standard of one seed first, then what it is compared with."""
    project = read_project(PROJECT)
    probe = Probe(project.probe_radius, project.probe_length)
    placement = design_standard(
        ProbeReach(project.chain, project.setup, probe.shape, probe.length),
        Blank(fittings=Fittings(sphere_heights=(60.0, 95.0, 130.0))),
        Workspace(project.chain, project.workspace, project.probe_length),
        np.random.default_rng(seed),
        project.population,
        PlacementOptions(
            patches=project.standard.patches, noise=1.0 * UM, choice=TouchOptions(touches=TOUCHES)
        ),
    )
    return placement.rivals


def line(name: str, of: list[Rival]) -> str:
    """Mean figures of one artefact over the seeds, µm."""
    mean = {
        key: np.mean([getattr(r, key) for r in of])
        for key in ("rms", "p95", "rms_user", "p95_user", "estimable")
    }
    shown = np.mean([r.visible / r.could_be_visible for r in of])
    figures = "  ".join(f"{mean[key] / UM:6.3f}" for key in ("rms", "p95", "rms_user", "p95_user"))
    return f"{name:28s} {figures}   {mean['estimable']:5.1f}   {100 * shown:5.1f} %"


def main() -> list[tuple[float, float, float]]:
    """Print the table; return (against spheres, against scatter, visible share) of every seed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=10, help="number of seeds, from 600")
    count = parser.parse_args().n
    found, shares = [], []
    for seed in range(600, 600 + count):
        start = time.process_time()
        of = rivals_of(seed)
        found.append(of)
        own, by_name = of[0], {r.name: r for r in of}
        ideal = by_name[IDEAL]
        placed = [r for r in of[1:] if r.body is not None and not r.body.patches]
        spheres = min(placed, key=lambda r: r.rms_user)
        ratios = [
            own.rms / spheres.rms - 1.0,
            own.rms_user / spheres.rms_user - 1.0,
            own.rms / ideal.rms - 1.0,
            own.rms_user / ideal.rms_user - 1.0,
        ]
        shares.append((ratios[1], max(ratios[2:]), own.visible / own.could_be_visible))
        words = "  ".join(f"{100 * r:+5.1f} %" for r in ratios)
        print(
            f"seed {seed}: against {spheres.name} and D-scatter, volume and workspace: {words}; "
            f"shows {own.visible} of {own.could_be_visible}; "
            f"{time.process_time() - start:.0f} s CPU",
            flush=True,
        )
    print(
        f"\nmeans of {count} seeds, µm      volume: rms, P95   workspace: rms, P95   known   shown"
    )
    for i, rival in enumerate(found[0]):
        print(line("this standard" if i == 0 else rival.name, [of[i] for of in found]))
    worst = (max(s[0] for s in shares), max(s[1] for s in shares), min(s[2] for s in shares))
    print(
        f"worst seed: {100 * worst[0]:+.1f} % against spheres (workspace), "
        f"{100 * worst[1]:+.1f} % against D-scatter, {100 * worst[2]:.1f} % of effects shown"
    )
    return shares


if __name__ == "__main__":
    main()
