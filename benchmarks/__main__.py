"""All benchmarks one after the other: `python -m benchmarks`, about a quarter of an hour.

Each is a script of its own with options; this runs them as the README quotes them.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent


def run(name: str, *arguments: str) -> None:
    """One script, its output on the console."""
    print(f"\n== {name} {' '.join(arguments)}", flush=True)
    subprocess.run([sys.executable, str(HERE / f"{name}.py"), *arguments], check=True)


def main() -> None:
    """Run them all."""
    run("design_run")
    run("design_machines")
    run("jacobians")
    run("fuzz_readers")
    run("stop_latency", "--only", "sensitivity,volumetric,diagnose,compare")
    run("montecarlo")
    run("placement_certificate")
    run("standard_against_rivals")
    run("diagnosis_scale")
    with tempfile.TemporaryDirectory() as folder:
        run("make_cases", "-n", "60", "--seed", "1", "-j", "2", "-o", f"{folder}/plain")
        run("make_cases", "-n", "50", "--seed", "1", "--hard", "-j", "2", "-o", f"{folder}/hard")
        run("diagnosis_cases", f"{folder}/plain", "--jobs", "2")
        run("diagnosis_cases", f"{folder}/hard", "--jobs", "2")


if __name__ == "__main__":
    main()
