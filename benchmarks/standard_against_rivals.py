"""The finished standard against other artefacts under equal rules: ten seeds, without CAD.

    OMP_NUM_THREADS=1 python benchmarks/standard_against_rivals.py [-n SEEDS] [--touches N]
        [--machines hsm600u machines/trunnion ...] [--jobs J]

For every example project: what each artefact leaves of the tool point, root mean square and 95 % of
the poses, over the volume that the standard fills and over the user's workspace, with 300 touches;
and how surely the touches on its faces find a model that is wrong by 2 µm over the measuring task.
Half a minute to a minute of processor time a seed and machine; `--jobs` are processes.
"""

import argparse
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from matstd.artefact.brief import read_project
from matstd.artefact.compare import Power, Rival
from matstd.artefact.place import design_standard
from matstd.artefact.worth import TouchOptions
from matstd.twin.units import UM

EXAMPLES = Path(__file__).parents[1] / "examples"
MACHINES = (
    "hsm600u",
    "machines/head-table",
    "machines/trunnion",
    "machines/vertical",
    "machines/four-axis",
)
HEAD = "      volume: rms, P95   workspace: rms, P95   known   shown"
IDEAL = "ideal scatter, chosen by D"


def placed_on(job: tuple[str, int], touches: int) -> tuple[tuple[Rival, ...], Power, float]:
    """Of a machine and a seed: the standard, then its rivals; power of its proof; CPU seconds."""
    name, seed = job
    start = time.process_time()
    brief = read_project(EXAMPLES / f"{name}.toml")
    fewer = replace(brief.options, choice=TouchOptions(touches=touches))
    placement = design_standard(replace(brief, options=fewer), np.random.default_rng(seed))
    return placement.rivals, placement.power, time.process_time() - start


def line(name: str, of: list[Rival]) -> str:
    """Mean figures of one artefact over the seeds, µm."""
    mean = {
        key: np.mean([getattr(r, key) for r in of])
        for key in ("rms", "p95", "rms_user", "p95_user", "estimable")
    }
    shown = np.mean([r.visible / r.could_be_visible for r in of])
    figures = "  ".join(f"{mean[key] / UM:6.3f}" for key in ("rms", "p95", "rms_user", "p95_user"))
    return f"{name:28s} {figures}   {mean['estimable']:5.1f}   {100 * shown:5.1f} %"


def against(of: Sequence[Rival], power: Power, seed: int, seconds: float) -> float:
    """Print one seed; return by how much more the standard leaves than the best spheres do."""
    own, by_name = of[0], {r.name: r for r in of}
    placed = [r for r in of[1:] if r.body is not None and not r.body.patches]
    best = {"spheres": min(placed, key=lambda r: r.rms_user), "D-scatter": by_name.get(IDEAL)}
    words = [
        f"{100 * (own.rms / r.rms - 1.0):+5.1f} % and "
        f"{100 * (own.rms_user / r.rms_user - 1.0):+5.1f} % against {what}"
        for what, r in best.items()
        if r is not None
    ]
    print(
        f"seed {seed}: volume and workspace {', '.join(words)} ({best['spheres'].name}); "
        f"shows {own.visible} of {own.could_be_visible}; {power.touches} touches on its faces find "
        f"2 µm over the task with {100 * power.power.mean():.1f} % ({power.found} of "
        f"{len(power.power)} effects at 95 %); {seconds:.0f} s CPU",
        flush=True,
    )
    return own.rms_user / best["spheres"].rms_user - 1.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=10, help="number of seeds, from 600")
    parser.add_argument("--touches", type=int, default=300)
    parser.add_argument("--machines", nargs="+", default=["hsm600u"], help=", ".join(MACHINES))
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    args = parser.parse_args()
    seeds = range(600, 600 + args.n)
    with ProcessPoolExecutor(args.jobs) as pool:
        results = pool.map(partial(placed_on, touches=args.touches), product(args.machines, seeds))
        for machine in args.machines:
            print(f"\n{machine}, {args.touches} touches")
            found, more = [], []
            for seed in seeds:
                of, power, seconds = next(results)
                found.append({r.name if i else "this standard": r for i, r in enumerate(of)})
                more.append(against(of, power, seed, seconds))
            print(f"means of {args.n} seeds, µm{HEAD}")
            for name in found[0]:
                print(line(name, [of[name] for of in found if name in of]))
            print(
                f"over the workspace against the best spheres: {100 * np.mean(more):+.1f} % on the "
                f"mean, {100 * max(more):+.1f} % at worst"
            )


if __name__ == "__main__":
    main()
