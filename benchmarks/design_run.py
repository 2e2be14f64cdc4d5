"""The main job's figures: how fast help answers, how long the design of the example takes.

    python benchmarks/design_run.py [--skip-design]

Wanted: help in under 0.5 s, the design in under 120 s on two idle cores.
"""

import argparse
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]


def seconds(command: list[str], runs: int) -> list[float]:
    """Wall time of a command, sorted; it has to succeed."""
    out = []
    for _ in range(runs):
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        out.append(time.perf_counter() - start)
    return sorted(out)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--skip-design", action="store_true")
    args = parser.parse_args()
    print(f"Python {platform.python_version()}, {platform.machine()}")
    bare = seconds([sys.executable, "-c", "pass"], 7)
    helped = seconds([sys.executable, "-m", "matstd", "--help"], 7)
    print(
        f"matstd --help: median {helped[3]:.3f} s (least {helped[0]:.3f}), "
        f"{helped[3] / bare[3]:.1f} times an empty Python ({bare[3]:.3f} s); wanted < 0.5 s"
    )
    if args.skip_design:
        return
    with tempfile.TemporaryDirectory() as folder:
        project = str(ROOT / "examples" / "hsm600u.toml")
        command = [sys.executable, "-m", "matstd", "design", project, "-o", f"{folder}/out"]
        took = seconds(command, 1)[0]
    print(f"matstd design examples/hsm600u.toml: {took:.0f} s; wanted < 120 s")


if __name__ == "__main__":
    main()
