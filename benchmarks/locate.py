"""Standards that stand anywhere within 20 mm and 5 degrees: are they found, and is nothing hit?

    python benchmarks/locate.py OUT [--count 200] [--seed 1] [--errors]

OUT is a folder of `matstd design`. Every placement is drawn evenly within the spread in all six
directions, the widest that the probe has room for. The machine has no errors but 10 µm of
noise at a touch; with `--errors` every placement has a machine of its own, whose errors (0.1 to
0.3 mm of displacement by the default distributions) look like a displaced standard and are in the
figures then. The search is run from the text of its program on the exact twin, its log is read and
evaluated as a control's. Where the standard really stands, the whole tool is swept along every
touch and every move.
"""

import argparse
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from matstd.artefact.body import read_standard
from matstd.probe_paths.campaign import VirtualMachine, ball_centres, simulate_search
from matstd.probe_paths.control import Move, interpret, read_log, read_program
from matstd.probe_paths.emit import make_search
from matstd.probe_paths.locate import SPREADS, find_standard, plan_search
from matstd.probe_paths.plan import ToolClearance
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.errors import NotReachable
from matstd.twin.files import read_machine
from matstd.twin.frames import fixed_xyz, inverse, pose
from matstd.twin.model import contribution
from matstd.twin.record import Setup
from matstd.twin.units import DEG, MINUTE, UM

NOISE = 10.0 * UM
GOOD_MM, GOOD_DEG = 0.3, 0.1


def smallest_gap(clearance: ToolClearance, program, run) -> float:
    """Of the tool above its ball on the way of every touch, and of all of it between them, mm."""
    start = np.array([touch.q for touch in program.touches])
    touched, _ = clearance.swept_gap(start, run.q, with_ball=False)
    moves = [step.q for step in program.steps if isinstance(step, Move)]
    ways = [ends for ends in pairwise(moves) if np.array_equal(*np.isnan(ends))]
    before, after = np.nan_to_num(np.swapaxes(ways, 0, 1))
    moved, _ = clearance.swept_gap(before, after)
    return float(min(touched.min(), moved.min()))


def main() -> int:
    """Place, search, find, compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("design", type=Path, metavar="OUT")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--errors", action="store_true", help="a machine of its own for each")
    args = parser.parse_args()
    chain = read_machine(args.design / "machine.toml")
    standard = read_standard(args.design / "standard.toml")
    first = read_program(sorted((args.design / "programs").glob("*_1.*[Hc]"))[0], chain).heading
    believed, probe = first.setup, first.probe
    for spread in SPREADS:
        try:
            plan = plan_search(standard, chain, probe, believed, spread, first.workshop)
            break
        except NotReachable as error:
            print(f"within {spread.distance:g} mm: {error}")
    made = make_search(plan, (spread.distance, spread.angle))
    text = made.programs[0]
    program = interpret(text.text.encode("ascii"), Path(text.file), made.masks.get, chain)
    print(f"{len(plan)} touches, {made.duration / MINUTE:.1f} min at most")
    limit = np.repeat([spread.distance, spread.angle], 3)
    shift, angle, gap, seconds, failed = [], [], [], [], 0
    for i in range(args.count):
        rng = np.random.default_rng([args.seed, i])
        theta = rng.uniform(-limit, limit)
        beside = pose(fixed_xyz(theta[3:]), theta[:3])
        errors = drawn_errors(Population(chain), rng) if args.errors else []
        machine = VirtualMachine(
            chain, lambda t, e=errors: contribution(e, t), setup_error=beside, noise=NOISE
        )
        run = simulate_search(program, standard, machine, rng)
        stands = Setup(believed.name, believed.T_table_artefact @ beside)
        room = ToolClearance(chain, standard, stands, probe, first.workshop)
        gap.append(smallest_gap(room, program, run))
        (name, log), *_ = run.log.items()
        (part,) = read_log(name, chain.rotary_axes, log)
        before = time.process_time()
        balls, seed = ball_centres(part, chain), np.random.default_rng(0)
        try:
            found = find_standard(standard, believed, balls, part.radius, seed, spread)
        except Exception as error:
            print(f"placement {i}: {error}")
            failed += 1
            continue
        seconds.append(time.process_time() - before)
        left = inverse(found.setup.T_table_artefact) @ stands.T_table_artefact
        shift.append(np.linalg.norm(left[:3, 3]))
        angle.append(np.arccos(np.clip(0.5 * (np.trace(left[:3, :3]) - 1.0), -1.0, 1.0)) / DEG)
        if shift[-1] > GOOD_MM or angle[-1] > GOOD_DEG:
            print(f"placement {i}: {shift[-1]:.3f} mm, {angle[-1]:.3f} degrees off")
            failed += 1
    print(
        f"{args.count} placements, {failed} not found to {GOOD_MM:g} mm and {GOOD_DEG:g} degrees; "
        f"of the others the worst {max(shift):.3f} mm and {max(angle):.3f} degrees, the median "
        f"{np.median(shift):.3f} mm and {np.median(angle):.3f} degrees"
    )
    print(f"smallest gap of the tool {min(gap):.2f} mm; {np.mean(seconds):.1f} s for one log")
    return int(failed > 0 or min(gap) <= 0.0)


if __name__ == "__main__":
    raise SystemExit(main())
