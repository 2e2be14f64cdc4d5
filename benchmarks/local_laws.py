"""Whether the regions of a run say where a local law acts, and in which component error.

    python benchmarks/local_laws.py [--runs 60] [--first 0] [--jobs 1] [--seed 1]

Each run is simulated exactly with a law that no library has, in one part of the travels (a worn
zone, a hose, a corner, a sector of a rotary axis), by its own formula. The first region that the
ordinary model leaves is right where it has at least half of its touches in common with those at
which half of the law or more acts; its carrier is right if it is the component, one that these
touches do not distinguish from it, or among those that it is reported not to be distinguished from.
"""

import time

import numpy as np
from harness import MACHINES, in_processes, mark, run_options  # puts the simulator on the path
from simulator import probe, run_text
from simulator_case import Ordinary, read_back, visible_size
from simulator_experiment import MACHINES as FILES
from simulator_experiment import STATED_NOISE, random_experiment
from simulator_laws import local_law

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.residual import Region, regions
from matstd.twin.laws import carrier_of
from matstd.twin.library import ordinary_model
from matstd.twin.record import Touches, with_commanded

VISIBLE = 15.0, 40.0  # signal to noise beside the geometric model

COMMON, ALIKE = 0.5, 0.95
"""Share of touches in common, and cosine of two carriers over them, that is right."""


class Readings:
    """State of touches as a local law asks for it."""

    def __init__(self, touches: Touches) -> None:
        self.q = {a: touches.reading(a) for a in touches.chain.programmed_axes}
        self.count = len(touches)

    def __len__(self) -> int:
        return self.count


def is_carrier(region: Region, carrier: str, touches: Touches, where: np.ndarray) -> bool:
    """Whether the carrier of a region is the true one, or does the same where the law acts."""
    named = () if region.wrong is None else (region.wrong.carrier, *region.wrong.alike)
    if carrier in named:
        return True
    if not named:
        return False
    a, b = (carrier_of(n, touches.chain).columns(touches[where])[:, 0] for n in (named[0], carrier))
    return bool(abs(a @ b) > ALIKE * np.linalg.norm(a) * np.linalg.norm(b))


def one(job: tuple[int, int]) -> tuple[bool, bool, float]:
    """Whether the region and the carrier of one run are right, and the seconds it took."""
    seed, index = job
    rng = np.random.default_rng([seed, index])
    label = MACHINES[index % 3]
    e = random_experiment(rng, label)
    still = np.zeros(len(e.time))
    ordinary = Ordinary(read_back(run_text(e, probe(e, [], still), False), FILES[label]).touches)
    while True:
        effect, carrier, part = local_law(rng, e.machine)
        per_unit, _ = visible_size(e, effect, ordinary, STATED_NOISE)
        effect.amplitude = rng.uniform(*VISIBLE) / max(per_unit, 1e-9)
        if effect.amplitude < effect.largest:
            break
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    run = with_commanded(read_back(run_text(e, probe(e, [effect], noise), False), FILES[label]))
    fit = fit_run(run, ordinary_model(run.touches.chain))
    began = time.process_time()
    found = regions(fit)
    seconds = time.process_time() - began
    where = part(Readings(run.touches)) >= 0.5
    is_region = is_right = False
    words = "-"
    if found:
        first = found[0]
        common = (first.rows & where).sum() / (first.rows | where).sum()
        is_region = bool(common >= COMMON)
        is_right = is_carrier(first, carrier, run.touches, where)
        box = " and ".join(f"{c.variable} {c.side.value} {c.bound}" for c in first.conditions)
        others = ", ".join(getattr(first, "alike", ()))
        words = f"{getattr(first, 'carrier', '')} ({others}) {box}: {100 * common:.0f} %"
    print(
        f"region {mark(is_region)} carrier {mark(is_right)} {label}{index} {carrier}, "
        f"{where.mean():.0%} of touches, {effect.amplitude:.1f} -> {len(found)}: {words}",
        flush=True,
    )
    return is_region, is_right, seconds


def main() -> None:
    parser = run_options(__doc__, 60)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    jobs = [(args.seed, k) for k in range(args.first, args.first + args.runs)]
    region, carrier, seconds = zip(*in_processes(one, jobs, args.jobs), strict=True)
    both = sum(a and b for a, b in zip(region, carrier, strict=True))
    print(
        f"\nregion right {sum(region)} of {len(jobs)}; carrier right {sum(carrier)}; both {both}; "
        f"{np.median(seconds):.2f} s of processor a run"
    )


if __name__ == "__main__":
    main()
