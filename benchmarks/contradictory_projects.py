"""Projects and machines with one contradiction each: refused before any work, or let through.

    python benchmarks/contradictory_projects.py

Each case changes one or two keys of the example into something that cannot be made, clamped,
reached or meant. Asked is what a design asks before it places anything: the readers, the seat, the
reach. A case is `impossible` (its standard could not be made, clamped or probed: it must be
refused) or `odd` (a person would ask: it is refused, or a remark says what is assumed). Wanted:
every impossible one refused in one line of our own words, at most four odd ones without a remark.
"""

import sys
import tempfile
import time
import tomllib
from pathlib import Path
from typing import Any

import tomli_w

from matstd.artefact.brief import read_project
from matstd.artefact.feasibility import check_seat, feasibility
from matstd.artefact.reach import standing_remarks
from matstd.twin.errors import DesignError

EXAMPLES = Path(__file__).parents[1] / "examples"
MOST_ODD = 4  # odd projects that may be accepted

VALIDATOR = ("Input should", "valid dictionary", "Tuple should", "value_error", "instance of")
"""Words of the validating library that must not reach a user."""

IMPOSSIBLE: dict[str, dict[str, Any]] = {
    "machine: B in radians": {"m.axis.B.range": [-1.92, 0.52]},
    "machine: X in metres": {"m.axis.X.range": [-0.4, 0.4]},
    "machine: pivot of B in metres": {"m.axis.B.point": [0.0, 0.0, -0.42]},
    "machine: pivot of B outside": {"m.axis.B.point": [0.0, 0.0, -4200.0]},
    "machine: a bracket that does not close": {"m.chain": "[w C' B' X' f Y Z (C1 t]"},
    "machine: spindle without its brackets": {"m.chain": "[w C' B' X' f Y Z C1 t]"},
    "machine: chain without Z": {"m.chain": "[w C' B' X' f Y (C1) t]"},
    "machine: an axis in no chain": {"m.axis.A": {"range": [-90.0, 90.0]}},
    "machine: travel reversed": {"m.axis.Y.range": [300.0, -300.0]},
    "machine: travel of nothing": {"m.axis.Y.range": [0.0, 0.0]},
    "machine: point of two numbers": {"m.axis.B.point": [0.0, -420.0]},
    "machine: direction of nothing": {"m.axis.X.direction": [0.0, 0.0, 0.0]},
    "machine: X and Y parallel": {"m.axis.X.direction": [0.0, 1.0, 0.0]},
    "base larger than the table": {"p.blank.base_mm": [420.0, 420.0]},
    "base of a postcard": {"p.blank.base_mm": [40.0, 40.0]},
    "base of nothing": {"p.blank.base_mm": [0.0, 280.0]},
    "base below zero": {"p.blank.base_mm": [-280.0, 280.0]},
    "blank taller than Z": {"p.blank.height_mm": 900.0},
    "blank of a sheet": {"p.blank.height_mm": 20.0},
    "a kilogram at most": {"p.limits.max_mass_kg": 1.0},
    "table of nothing": {"p.limits.table_radius_mm": 0.0},
    "table smaller than the base": {"p.limits.table_radius_mm": 90.0},
    "corners over a round table": {"p.limits.overhang_mm": 0.0},
    "slots every 5 mm": {"p.limits.slot_pitch_mm": 5.0},
    "overhang below zero": {"p.limits.overhang_mm": -10.0},
    "riser below zero": {"p.limits.riser_mm": -20.0},
    "ball of 60 mm": {"p.probe.radius_mm": 30.0},
    "ball in metres": {"p.probe.radius_mm": 0.003},
    "probe of 16 mm": {"p.probe.length_mm": 16.0},
    "probe of 1.6 m": {"p.probe.length_mm": 1600.0},
    "stylus longer than the probe": {"p.probe.stylus_length_mm": 200.0},
    "stylus thicker than its ball": {"p.probe.stylus_diameter_mm": 8.0},
    "workspace reversed": {"p.workspace.X": [150.0, -150.0]},
    "workspace beyond the travel": {"p.workspace.X": [-600.0, 600.0]},
    "workspace of B in radians": {"p.workspace.B": [-1.57, 0.35]},
    "workspace in metres": {"p.workspace.X": [-0.15, 0.15]},
    "workspace of an axis that is not there": {"p.workspace.A": [-10.0, 10.0]},
    "two patches": {"p.standard.patches": 2},
    "forty patches": {"p.standard.patches": 40},
    "ten touches": {"p.standard.touches": 10},
    "fifty thousand touches": {"p.standard.touches": 50000},
    "two poses": {"p.standard.poses": 2},
    "a hundred balls": {"p.standard.balls": 100},
    "criterion Z": {"p.standard.criterion": "Z"},
    "potential above one": {"p.standard.potential": 1.5},
    "share of no machine": {"p.standard.robust_machines": 8, "p.standard.robust_share": 0.0},
    "weight along no axis": {"p.standard.down": "down"},
    "density of water units": {"p.material.density_kg_m3": 7.8},
    "expansion per million": {"p.material.expansion_1_K": 11.5},
    "expansion per thousand": {"p.material.expansion_1_K": 11.5e-3},
    "Poisson's ratio of 0.8": {"p.material.poisson": 0.8},
    "concave radius below the ball": {"p.limits.min_concave_radius_mm": 2.0},
    "slope of 95 degrees": {"p.limits.max_slope_deg": 95.0},
    "gap of 60 mm": {"p.limits.gap_mm": 60.0},
    "clamp in the base": {
        "p.workshop.bodies": [
            {"name": "C1", "at_mm": [100.0, 0.0, 0.0], "sides_mm": [40.0, 25.0], "height_mm": 35.0}
        ]
    },
    "clamp through the faces": {
        "p.workshop.bodies": [
            {"name": "C1", "at_mm": [0.0, 0.0, 0.0], "sides_mm": [20.0, 20.0], "height_mm": 300.0}
        ]
    },
    "clamp without a size": {"p.workshop.bodies": [{"name": "C1", "at_mm": [150.0, 0.0, 0.0]}]},
    "standard in the table": {"p.setup.a.origin_mm": [0.0, 0.0, -50.0]},
    "standard beside the table": {"p.setup.a.origin_mm": [300.0, 0.0, 0.0]},
    "noise of nothing": {"p.simulation.noise_um": -1.0},
    "an error of no size": {"p.errors.parameters.EXX": []},
    "machine: travel in micrometres": {"m.axis.Y.range": [-300000.0, 300000.0]},
    "machine: B turns about Z": {"m.axis.B.direction": [0.0, 0.0, 1.0]},
    "machine: table in metres": {"m.workpiece.origin": [0.0, 0.0, -0.5]},
    "machine: X in centimetres": {"m.axis.X.range": [-40.0, 40.0]},
    "machine: Z in centimetres": {"m.axis.Z.range": [-50.0, 0.0]},
    "machine: table 60 mm off the line of C": {"m.workpiece.origin": [60.0, 0.0, -500.0]},
    "machine: table a metre low": {"m.workpiece.origin": [0.0, 0.0, -1500.0]},
    "probe in inches": {"p.probe.length_mm": 6.3},
    "a post of a metre": {
        "p.workshop.bodies": [
            {"name": "P", "at_mm": [200.0, 0.0, 0.0], "diameter_mm": 20.0, "height_mm": 1000.0}
        ]
    },
    "ball of the workshop a metre away": {
        "p.workshop.ball": {
            "at_mm": [1000.0, 0.0, 80.0],
            "diameter_mm": 25.0,
            "stem_diameter_mm": 10.0,
        }
    },
    "clearance of half a metre": {"p.workshop.clearance_mm": 500.0},
    "weight upwards": {"p.standard.down": "+Z"},
    "standard upside down": {"p.setup.a.rotation_deg": [180.0, 0.0, 0.0]},
    "a name with a blank": {"p.standard.name": "Test 1"},
    "two set-ups at one place": {"p.setup.b": {"origin_mm": [0.0, 0.0, 0.0]}},
    "steel as heavy as lead": {"p.material.density_kg_m3": 11300.0},
    "steel that does not expand": {"p.material.expansion_1_K": 0.0},
    "an error that ends below its begin": {"p.errors.parameters.EXX": [10.0, 5.0]},
}

ODD: dict[str, dict[str, Any]] = {
    "riser above the travel": {"p.limits.riser_mm": 600.0},
    "standard on its side": {"p.setup.a.rotation_deg": [90.0, 0.0, 0.0]},
    "modulus in GPa": {"p.material.modulus_MPa": 200.0},
    "rotation of the set-up in radians": {"p.setup.a.rotation_deg": [0.0, 0.0, 1.5708]},
    "origin of the set-up in metres": {"p.setup.a.origin_mm": [0.05, 0.02, 0.0]},
    "balls known to 3 mm": {"p.calibration.ball_um": 3000.0},
    "noise of a millimetre": {"p.simulation.noise_um": 1000.0},
    "error of a metre": {"p.errors.parameters.EXX": [1e6, 2e6]},
}


def changed(tables: dict[str, Any], change: dict[str, Any]) -> None:
    """Set keys such as `p.blank.height_mm` of project `p` and machine `m`."""
    for key, value in change.items():
        *way, last = key.split(".")
        table = tables
        for step in way:
            table = table.setdefault(step, {})
        table[last] = value


def outcome(change: dict[str, Any], folder: Path) -> tuple[str, str]:
    """What became of a project, `refused`, `asked` or `ACCEPTED`, and by which words."""
    tables = {
        "p": tomllib.loads((EXAMPLES / "hsm600u.toml").read_text(encoding="utf-8")),
        "m": tomllib.loads((EXAMPLES / "hsm600u-machine.toml").read_text(encoding="utf-8")),
    }
    changed(tables, change)
    tables["p"]["machine"] = "machine.toml"
    (folder / "machine.toml").write_text(tomli_w.dumps(tables["m"]), encoding="utf-8")
    (folder / "project.toml").write_text(tomli_w.dumps(tables["p"]), encoding="utf-8")
    try:
        brief = read_project(folder / "project.toml")
        check_seat(brief)
        feasibility(brief).check()
    except DesignError as error:
        return "refused", str(error).replace(f"{folder}/", "")
    standing = standing_remarks(brief.chain, brief.setup.T_table_artefact, brief.down)
    said = [*brief.remarks, *standing]
    return "asked" if said else "ACCEPTED", "; ".join(map(str, said))


def main() -> None:
    """All cases, a line each."""
    passed: dict[str, list[str]] = {"impossible": [], "odd": []}
    foreign = []
    begin = time.process_time()
    with tempfile.TemporaryDirectory() as place:
        for kind, cases in (("impossible", IMPOSSIBLE), ("odd", ODD)):
            for name, change in cases.items():
                end, words = outcome(change, Path(place))
                if end == "ACCEPTED" or (end == "asked" and kind == "impossible"):
                    passed[kind].append(name)
                if any(word in words for word in VALIDATOR) or "\n" in words:
                    foreign.append(name)
                print(f"{kind:10} {end:8} {name}: {words[:150]}", flush=True)
    used = time.process_time() - begin
    print(
        f"{len(IMPOSSIBLE)} impossible, {len(passed['impossible'])} accepted; {len(ODD)} odd, "
        f"{len(passed['odd'])} accepted; {len(foreign)} in foreign words; {used:.0f} s of processor"
    )
    if passed["impossible"] or len(passed["odd"]) > MOST_ODD or foreign:
        sys.exit(1)


if __name__ == "__main__":
    main()
