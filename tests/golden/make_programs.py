"""Makes the golden programs: `python tests/golden/make_programs.py`, then look at the diff.

A small standard (two patches, three spheres) on a machine of the type [w C' B' X' f Y Z (C1) t];
five table poses, a visit from either side of most of them.
"""

from functools import cache
from pathlib import Path

import numpy as np

from matstd.artefact.body import Base, DatumSphere, FreeformPatch, Standard, graph_patch
from matstd.artefact.body.material import STEEL
from matstd.artefact.reach import Requests
from matstd.artefact.tool import Probe
from matstd.probe_paths.emit import Feeds, ProgramSet, make_programs
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.plan import PlanOptions, TouchPlan, plan_touches, requests_at
from matstd.twin.frames import pose, rotation
from matstd.twin.machine import Axis, Chain, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG

FOLDER = Path(__file__).parent / "programs"
LINUXCNC = Path(__file__).parent / "linuxcnc"
POSES = ((0.0, 0.0), (0.0, 120.0), (-30.0, 60.0), (-60.0, 170.0), (20.0, -100.0))
"""B and C of the table poses, degrees."""


def machine(notation: str = "[w C' B' X' f Y Z (C1) t]") -> Chain:
    """A trunnion-table machine with round numbers."""
    axes = {
        "X": Axis((-400.0, 400.0)),
        "Y": Axis((-300.0, 300.0)),
        "Z": Axis((-500.0, 0.0)),
        "B": Axis((-110.0 * DEG, 30.0 * DEG), (0.0, 0.0, -420.0)),
        "C": Axis((-360.0 * DEG, 360.0 * DEG), (0.0, 0.0, 0.0)),
    }
    return make_chain("trunnion", notation, axes, (0.0, 0.0, -500.0))


def machine_text() -> str:
    """The machine as its file."""
    chain = machine()
    lines = [f'format = "machine/1"\nname = "{chain.name}"\nchain = "{chain.notation}"']
    for letter in chain.programmed_axes:
        link = chain.link(letter)
        unit = 1.0 if link.kind == "linear" else DEG
        lines.append(f"[axis.{letter}]\nrange = {[v / unit for v in link.range]}")
        lines.append(f"point = {[float(v) for v in link.point]}")
    return "\n".join([*lines, "[workpiece]\norigin = [0.0, 0.0, -500.0]"]) + "\n"


def patch(name: str, x: float, z: float, tilt: float, phase: float) -> FreeformPatch:
    """A wavy face at (x, 0, z), tilted outwards about y, rad."""
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, 8), np.linspace(-1.0, 1.0, 8), indexing="ij")
    heights = 2.0 * np.sin(2.0 * u + phase) * np.cos(1.5 * v) + np.sin(2.2 * v - phase)
    T_artefact_patch = pose(rotation(tilt * np.array([0.0, 1.0, 0.0])), np.array([x, 0.0, z]))
    return graph_patch(name, T_artefact_patch, (15.0, 18.0), heights, depth=40.0)


def sphere(name: str, x: float, y: float, z: float = 50.0) -> DatumSphere:
    """A ball of 20 mm on a stem that stands on the base."""
    return DatumSphere(name, np.array([x, y, z]), 10.0, 4.0, 6.0, 20.0)


FACES = (patch("FF1", 0.0, 60.0, 0.0, 0.3), patch("FF2", 45.0, 55.0, 0.6, 1.1))
BALLS = (sphere("SPH1", 60.0, 60.0), sphere("SPH2", -60.0, 60.0), sphere("SPH3", -60.0, -60.0))


def standard(spheres: tuple[DatumSphere, ...] | None = None) -> Standard:
    """The small standard, or one with other spheres and no patches."""
    return Standard(
        name="SMALL-1",
        serial="",
        material=STEEL,
        base=Base((80.0, 80.0), 10.0, 20.0),
        core=None,
        patches=() if spheres else FACES,
        spheres=spheres or BALLS,
        holes=(),
        blank_height=80.0,
    )


def requests(of: Standard, each: int = 2) -> Requests:
    """Touches on every patch and sphere at every pose, as many of each."""
    parts = []
    rng = np.random.default_rng(1)
    for name, surface in of.features.items():
        for b, c in POSES:
            if name.startswith("FF"):
                uv = rng.uniform(-12.0, 12.0, (each, 2))
            elif name.startswith("SPH"):
                uv = np.column_stack(
                    [rng.uniform(-np.pi, np.pi, each), rng.uniform(0.6, 1.4, each)]
                )
            else:
                continue
            assert np.all(surface.contains(uv))
            parts.append(requests_at(of, name, uv, np.array([c, b]) * DEG))
    return Requests(
        np.concatenate([p.feature for p in parts]),
        np.concatenate([p.point for p in parts]),
        np.concatenate([p.normal for p in parts]),
        np.concatenate([p.rotary for p in parts]),
    )


def setup() -> Setup:
    """Off the table's centre and turned."""
    return Setup("a", pose(rotation(np.array([0.0, 0.0, 0.35])), np.array([12.0, -8.0, 5.0])))


@cache
def plan() -> TouchPlan:
    """All touches that can be made; two of them lean too far in their pose."""
    small = standard()
    options = PlanOptions(tolerated=2)
    return plan_touches(small, machine(), Probe(), setup(), requests(small), options)


@cache
def programs(control: str = "itnc530") -> ProgramSet:
    """The golden programs of a control, three files."""
    return make_programs(plan(), read_dialect(control), Feeds(touches_per_file=24))


if __name__ == "__main__":
    made = programs()
    for path in made.write(FOLDER) + programs("linuxcnc").write(LINUXCNC):
        print(path)
    for refused in plan().refused:
        print(refused)
