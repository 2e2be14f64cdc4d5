"""Random projects over the whole range that a project may ask for: designed, or refused in words.

    python benchmarks/random_projects.py [COUNT [FIRST_SEED]]

Machine, ball, blank, set-up, workspace, criterion and limits are drawn at random, sensible or not.
Wanted: each is designed with its CAD, or refused with one line and exit code 2 before any CAD; no
traceback, nothing that runs beyond ten minutes or takes more than 2 GiB.
"""

import platform
import sys
import tempfile
import time
import tomllib
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from subprocess import TimeoutExpired, run

import numpy as np

EXAMPLES = Path(__file__).parents[1] / "examples"
MACHINES = (
    "hsm600u", "machines/head-table", "machines/trunnion", "machines/gantry", "machines/vertical",
    "machines/horizontal", "machines/four-axis", "machines/upright",
)  # fmt: skip
LONGEST = 600.0  # s


def text_of(table: dict[str, object], path: tuple[str, ...] = ()) -> str:
    """A table as TOML: numbers, strings, lists and tables, as a project has them."""
    plain = [f"{k} = {_value(v)}" for k, v in table.items() if not isinstance(v, dict)]
    head = [f"[{'.'.join(path)}]"] if path and plain else []
    inner = [text_of(v, (*path, k)) for k, v in table.items() if isinstance(v, dict)]
    return "\n".join([*head, *plain, *inner])


def _value(value: object) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def project(seed: int) -> str:
    """One random project."""
    rng = np.random.default_rng([2031, seed])
    name = MACHINES[seed % len(MACHINES)]
    file = EXAMPLES / f"{name}.toml"
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    table["machine"] = (file.parent / table["machine"]).as_posix()
    table["seed"] = seed
    radius = float(rng.choice([1.0, 1.5, 2.0, 3.0, 4.0]))
    table["probe"]["radius_mm"] = radius
    table.setdefault("workspace", {})["poses"] = 200
    for axis, limits in table["workspace"].items():
        if isinstance(limits, list):
            middle, half = 0.5 * (limits[0] + limits[1]), 0.5 * (limits[1] - limits[0])
            half *= rng.uniform(0.4, 1.0)
            middle += rng.uniform(-0.2, 0.2) * half
            table["workspace"][axis] = [round(middle - half, 1), round(middle + half, 1)]
    table["montecarlo"] = {"draws": 200}
    table["simulation"] = {**table.get("simulation", {}), "machines": 1}
    patches = int(rng.integers(8, 17))
    table["standard"] |= {
        "patches": patches,
        "touches": int(rng.integers(100, 400)),
        "poses": int(rng.integers(8, 40)),
        "criterion": str(rng.choice(["I", "G", "D", "A", "E"])),
        "potential": round(float(rng.choice([0.0, 0.3, 0.8])), 2),
    }
    side = float(rng.uniform(160.0, 400.0))
    table["blank"] = {
        "base_mm": [round(side, 1), round(side * rng.uniform(0.6, 1.0), 1)],
        "height_mm": round(float(rng.uniform(120.0, 300.0)), 1),
    }
    table["limits"] = {**table.get("limits", {})} | {
        "min_concave_radius_mm": round(float(rng.uniform(3.0, 25.0)), 1),
        "max_slope_deg": round(float(rng.uniform(15.0, 60.0)), 1),
        "gap_mm": round(float(rng.uniform(0.5, 3.0)), 2),
        "max_mass_kg": round(float(rng.uniform(5.0, 200.0)), 1),
        "table_radius_mm": round(float(rng.uniform(0.5, 1.0) * side), 1),
        "overhang_mm": round(0.3 * side, 1),  # of the corners of a square over a disc of its side
    }
    return text_of(table) + "\n"


def outcome(file: Path, folder: str) -> tuple[str, str]:
    """What became of a project, and the last line it printed."""
    command = [sys.executable, "-m", "matstd", "design", str(file), "-o", folder]
    try:
        done = run(command, capture_output=True, text=True, timeout=LONGEST, check=False)
    except TimeoutExpired:
        return "FAILED", f"ran beyond {LONGEST:.0f} s"
    lines = [line for line in (done.stderr.strip() or done.stdout).splitlines() if line.strip()]
    end = {0: "designed", 2: "refused"}.get(done.returncode, "FAILED")
    if end == "refused" and any("Traceback" in line for line in lines):
        end = "FAILED"
    return end, lines[-1] if lines else ""


def main() -> None:
    """Design them, a line each, and what became of all."""
    given = [int(v) for v in sys.argv[1:]]
    count, first = [*given, *(24, 0)[len(given) :]]
    print(f"Python {platform.python_version()}, {platform.machine()}", flush=True)
    ends = {"designed": 0, "refused": 0, "FAILED": 0}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + count):
            file = Path(folder) / f"{seed}.toml"
            file.write_text(project(seed), encoding="utf-8")
            before = getrusage(RUSAGE_CHILDREN).ru_utime
            start = time.perf_counter()
            end, last = outcome(file, f"{folder}/{seed}")
            wall = time.perf_counter() - start
            used = getrusage(RUSAGE_CHILDREN).ru_utime - before
            ends[end] += 1
            name = MACHINES[seed % len(MACHINES)]
            print(f"{seed:3d} {name}: {end}, {wall:.0f} s ({used:.0f} s user); {last}", flush=True)
    most = getrusage(RUSAGE_CHILDREN).ru_maxrss / 2**20
    stated = ", ".join(f"{number} {end}" for end, number in ends.items())
    print(f"{stated}; at most {most:.2f} GiB in one process")
    if ends["FAILED"]:
        sys.exit(1)


if __name__ == "__main__":
    main()
