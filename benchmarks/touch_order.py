"""Is the order of touches within a visit short? Against the best that is known for each.

    python benchmarks/touch_order.py OUT [--seconds 2]

OUT is a folder of `matstd design`. What is kept: the visits, their order and sides (mixed poses,
each from both sides), the anchor touch first, and the way between two touches: up to the height
of the visit, sideways, down. So only the moves sideways depend on the order. Their time by the
clock of the programs is compared with a reference that shares no code with the planner: exact
(all subsets, Held and Karp) up to 13 touches, beyond that the best of many random starts, each
made locally best by turning parts round and moving single touches, for some seconds per visit.
"""

import argparse
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from matstd.artefact.body import read_standard
from matstd.probe_paths.control import Clock, read_program, step_times
from matstd.probe_paths.linuxcnc import shortened
from matstd.probe_paths.plan import short_order
from matstd.twin.files import read_machine
from matstd.twin.frames import Array
from matstd.twin.units import MINUTE

EXACT = 13  # touches behind the anchor; 2^13 subsets


def sideways(places: Array, clock: Clock) -> Array:
    """Seconds of a rapid move between any two places (N, 2): the slower axis decides."""
    way = np.abs(places[:, None] - places).max(axis=-1)
    short = way < clock.rapid**2 / clock.acceleration
    triangle = 2.0 * np.sqrt(way / clock.acceleration)
    return np.where(short, triangle, way / clock.rapid + clock.rapid / clock.acceleration)


def exact(cost: Array) -> float:
    """Shortest way from place 0 through all others, over all subsets."""
    n = len(cost) - 1
    best = np.full((1 << n, n), np.inf)
    best[1 << np.arange(n), np.arange(n)] = cost[0, 1:]
    for subset in range(1, 1 << n):
        ways = (best[subset][:, None] + cost[1:, 1:]).min(axis=0)
        for k in range(n):
            if not subset >> k & 1:
                more = subset | 1 << k
                best[more, k] = min(best[more, k], ways[k])
    return float(best[-1].min())


def length(cost: Array, tour: list[int]) -> float:
    return float(sum(cost[a, b] for a, b in pairwise(tour)))


def searched(cost: Array, seconds: float, rng: np.random.Generator) -> float:
    """Best of many random starts."""
    best, end = np.inf, time.process_time() + seconds
    while time.process_time() < end:
        tour = [0, *(1 + rng.permutation(len(cost) - 1)).tolist()]
        now, is_better = length(cost, tour), True
        while is_better:
            is_better = False
            for i in range(1, len(tour)):
                for j in range(1, len(tour)):
                    if i < j:
                        other = tour[:i] + tour[i : j + 1][::-1] + tour[j + 1 :]
                        made = length(cost, other)
                        if made < now - 1e-12:
                            tour, now, is_better = other, made, True
                    left = tour[:i] + tour[i + 1 :]
                    other = [*left[:j], tour[i], *left[j:]]
                    made = length(cost, other)
                    if made < now - 1e-12:
                        tour, now, is_better = other, made, True
        best = min(best, now)
    return best


def main() -> int:
    """Compare every visit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("design", type=Path, metavar="OUT")
    parser.add_argument("--seconds", type=float, default=2.0, help="of a search, per visit (2)")
    args = parser.parse_args()
    chain, clock = read_machine(args.design / "machine.toml"), Clock()
    standard = read_standard(args.design / "standard.toml")
    paths = sorted((args.design / "programs").glob("*.*[Hc]"))
    programs = [read_program(path, chain) for path in paths]
    plan = shortened(programs, standard, chain)
    xy = [chain.axis_index(a) for a in "XY"]
    rng, ours, stood, best, worst = np.random.default_rng(0), 0.0, 0.0, 0.0, 1.0
    before = time.process_time()
    for v in range(len(plan.visits)):
        places = plan.start[plan.visit == v][:, xy]
        short_order(places[1:], places[0])
    spent = time.process_time() - before
    for v in range(len(plan.visits)):
        places = plan.start[plan.visit == v][:, xy]
        if len(places) < 3:
            continue
        cost = sideways(places, clock)
        order = 1 + short_order(places[1:], places[0])
        mine = length(cost, [0, *order.tolist()])
        known = exact(cost) if len(places) <= EXACT + 1 else searched(cost, args.seconds, rng)
        known = min(known, mine)
        stood += length(cost, list(range(len(places))))
        ours, best, worst = ours + mine, best + known, max(worst, mine / known)
    print(f"{len(plan)} touches in {len(plan.visits)} visits; ordered in {spent:.2f} s")
    print(f"sideways: programs {stood:.1f} s, planner {ours:.1f} s, best known {best:.1f} s")
    above, at_worst = 100.0 * (ours / best - 1.0), 100.0 * (worst - 1.0)
    print(f"planner {above:.1f} % above the best, {at_worst:.1f} % in the worst visit")
    total = 0.0
    for program in programs:
        travel = np.full(len(program.touches), plan.options.standoff)
        total += step_times(chain, program.steps, clock, travel)[-1]
    print(f"of {total / MINUTE:.1f} min, {ours / MINUTE:.1f} depend on the order within a visit")
    return int(ours > 1.1 * best)


if __name__ == "__main__":
    raise SystemExit(main())
