"""All benchmarks one after the other: `python -m benchmarks`, a few hours on two cores.

Each is a script of its own with options; this runs them as the README quotes them. Those named are
run alone: `python -m benchmarks jacobians fuzz_readers`.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
MACHINES = ("hsm600u", "machines/head-table", "machines/trunnion", "machines/vertical")
"""On which the standard is compared with its rivals."""


def run(name: str, *arguments: str) -> None:
    """One script, its output on the console."""
    print(f"\n== {name} {' '.join(arguments)}", flush=True)
    done = subprocess.run([sys.executable, str(HERE / f"{name}.py"), *arguments])
    if done.returncode:  # its own words stand above
        sys.exit(done.returncode)


RUNS: dict[str, tuple[str, ...]] = {
    "jacobians": (),
    "without_sampling": (),
    "total_effects": (),
    "montecarlo": (),
    "fuzz_readers": (),
    "stop_latency": ("--only", "sensitivity,volumetric,diagnose,compare"),
    "design_run": (),
    "design_machines": (),
    "placement_certificate": (),
    "standard_against_rivals": ("--jobs", "2", "--machines", *MACHINES),
    "diagnosis_scale": (),
    "description_faults": (),
    "noise_with_memory": ("--jobs", "2"),
    "large_effects": ("--jobs", "2"),
    "flat_plate": (),
    "real_records": (),
    "trend_alarms": (),
    "contradictory_projects": (),
    "standard_temperature": (),
    "wavy_face": (),
    "live_page": (),
    "machine_page": (),
}
"""Scripts and their arguments; the unseen cases, which have to be made first, come after them."""


def unseen_cases() -> None:
    """Cases that an independent simulator makes, and what the diagnosis says of them."""
    with tempfile.TemporaryDirectory() as folder:
        run("make_cases", "-n", "60", "--seed", "1", "-j", "2", "-o", f"{folder}/plain")
        run("make_cases", "-n", "50", "--seed", "1", "--hard", "-j", "2", "-o", f"{folder}/hard")
        run("diagnosis_cases", f"{folder}/plain", "--jobs", "2")
        run("diagnosis_cases", f"{folder}/hard", "--jobs", "2")


def main(names: list[str]) -> None:
    """Run them all, or those named; a script that needs arguments of its own says so itself."""
    scripts = {path.stem for path in HERE.glob("*.py")} - {"__main__", "harness"}
    for name in names:
        if name not in scripts:
            sys.exit(f"{name}: no benchmark; expected one of {', '.join(sorted(scripts))}")
    for name in names or RUNS:
        run(name, *RUNS.get(name, ()))
    if not names:
        unseen_cases()


if __name__ == "__main__":
    main(sys.argv[1:])
