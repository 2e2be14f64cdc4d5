"""How near the tool comes to anything at the touches of emitted programs, from outside.

    python benchmarks/emitted_gaps.py OUT [--wide]

OUT is a folder of `matstd design` for a machine with the kinematics of examples/hsm600u.toml. Its
programs are read; with `--wide` their touches are first planned anew for a probe with a stem of
3 x 40 mm, a body of 62 mm and a nose of 100 mm, and what is refused is printed. Then every touch is
looked at from its start to its contact: surfaces as points every 0.5 mm, the tool above its ball as
exact cylinders, kinematics by hand (`planted_collisions`). A place of a surface is up to 0.36 mm
beside the nearest point, which is taken off the gap; where that leaves less than 1 mm, points every
0.15 mm are looked at.
"""

import argparse
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from planted_collisions import (
    features_points,
    rotations,
    solid_points,
    standard_points,
    tip_on_table,
)

from matstd.artefact.body import Standard, read_standard
from matstd.artefact.reach import Requests
from matstd.probe_paths.control import ReadProgram, interpret, read_program
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.linuxcnc import shortened
from matstd.probe_paths.plan import Heading, PlanOptions, Probe, TouchPlan, plan_touches
from matstd.twin.files import read_machine
from matstd.twin.frames import Array

PITCH = 0.5  # mm between points of a surface
FINER = 0.15  # mm: the same where the first look leaves less than is wanted
_PLACES = 3  # of the way in that are looked at
_NEAR = 2.0  # mm: what is farther away is not looked at closely
_COARSE = 3.0  # mm between the points that say what is near
WIDE = Probe(stack=((40.0, 1.5), (160.0, 31.0)), nose_radius=50.0)
WANTED = 1.0  # mm


def planned_for(probe: Probe, programs: Sequence[ReadProgram], standard: Standard) -> TouchPlan:
    """The touches of programs, planned anew for another probe."""
    chain = read_machine(ARGS.design / "machine.toml")
    old = shortened(programs, standard, chain)
    rotary = np.array([visit.rotary for visit in old.visits])[old.visit]
    wanted = Requests(old.feature, old.point, old.normal, rotary)
    options = PlanOptions(tolerated=len(wanted), workshop=old.options.workshop)
    return plan_touches(standard, chain, probe, old.setup, wanted, options)


def gap_above_ball(points: Array, centres: Array, axis: Array, probe: Probe) -> float:
    """Smallest distance of points (K, 3) from the tool above its ball at places (N, 3), mm."""
    best = np.inf
    for centre in centres:
        way, low = points - centre.astype(points.dtype), 0.0
        along = way @ axis.astype(points.dtype)
        across = np.linalg.norm(way - along[:, None] * axis.astype(points.dtype), axis=1)
        for high, radius in probe.shape.cylinders:
            beyond = np.maximum(np.maximum(low - along, along - high), 0.0)
            best = min(best, float(np.hypot(np.maximum(across - radius, 0.0), beyond).min()))
            low = high
    return best


def _clouds(standard: Standard, head: Heading, pitch: float) -> dict[str, Array]:
    """Points of everything by name; in single precision, which is 0.03 µm here."""
    assert head.workshop is not None
    bodies = standard_points(standard, head.setup.T_table_artefact, pitch)
    bodies |= {solid.name: solid_points(solid, pitch) for solid in head.workshop.solids}
    return {name: points.astype(np.float32) for name, points in bodies.items()}


def _at_least(gap: float, pitch: float) -> float:
    """A gap, less what a place of the surface may lie beside the nearest point."""
    return float(np.sqrt(max(gap**2 - 0.5 * pitch**2, 0.0)))


def smallest(programs: Sequence[ReadProgram], standard: Standard) -> tuple[Array, Array]:
    """Gap of every touch, the distance of the points taken off, and its number."""
    head = programs[0].heading
    coarse, fine = (_clouds(standard, head, pitch) for pitch in (_COARSE, PITCH))
    finer: dict[str, Array] = {}
    gaps, numbers = [], []
    for program in programs:
        for touch in program.touches:
            C, B = rotations(touch.q[:2])
            axis = C.apply(B.apply([0.0, 0.0, 1.0]))
            way = np.linspace(0.0, touch.back, _PLACES)[:, None] * touch.direction[2:5]
            centres = tip_on_table(touch.q[2:5] + way, touch.q[:2])
            gap, near = _NEAR, []
            for name, points in fine.items():
                if gap_above_ball(coarse[name], centres, axis, head.probe) < _NEAR + _COARSE:
                    gap = min(gap, gap_above_ball(points, centres, axis, head.probe))
                    near.append(name)
            gaps.append(_at_least(gap, PITCH))
            if gaps[-1] < WANTED:
                place = head.setup.T_table_artefact
                finer = finer or features_points(standard, place, FINER)
                flat = [gap_above_ball(fine[n], centres, axis, head.probe)
                        for n in near if n not in finer]  # fmt: skip
                others = [gap_above_ball(finer[n], centres, axis, head.probe)
                          for n in near if n in finer]  # fmt: skip
                gaps[-1] = min(_at_least(min(flat, default=_NEAR), PITCH),
                               _at_least(min(others, default=_NEAR), FINER))  # fmt: skip
            numbers.append(touch.number)
    return np.array(gaps), np.array(numbers)


def main() -> int:
    """Read, plan anew where asked, look from outside."""
    chain = read_machine(ARGS.design / "machine.toml")
    standard = read_standard(ARGS.design / "standard.toml")
    paths = sorted((ARGS.design / "programs").glob("*.H"))
    programs = [read_program(path, chain) for path in paths]
    if ARGS.wide:
        plan = planned_for(WIDE, programs, standard)
        made = make_programs(plan)
        programs = [
            interpret(p.text.encode("ascii"), Path(p.file), made.masks.get, chain)
            for p in made.programs
        ]
        words = (re.sub(r"[\d.]+ mm", "too little", r.reason) for r in plan.refused)
        print(f"{len(plan.refused)} touches refused by name")
        for reason, count in Counter(words).most_common():
            print(f"{count:4d} {reason}")
    gaps, numbers = smallest(programs, standard)
    print(
        f"{len(gaps)} touches: smallest gap {gaps.min():.3f} mm (touch {numbers[gaps.argmin()]}), "
        f"{np.sum(gaps < WANTED)} nearer than {WANTED:g} mm"
    )
    return int(np.any(gaps < WANTED))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("design", type=Path, metavar="OUT")
    parser.add_argument("--wide", action="store_true")
    ARGS = parser.parse_args()
    raise SystemExit(main())
