"""How long `matstd design` takes on every kind of machine, and a refusal for want of reach.

    python benchmarks/design_machines.py [NAME ...]

Wanted: each of the eight under 240 s on two idle cores, the refusal under 5 s. Wall and processor
time are printed, so that a busy machine shows.
"""

import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"
NAMES = (
    "hsm600u",
    "machines/head-table",
    "machines/trunnion",
    "machines/gantry",
    "machines/vertical",
    "machines/horizontal",
    "machines/four-axis",
    "machines/upright",
)


def timed(project: Path, out: Path) -> tuple[int, float, float, str]:
    """Exit code, wall and processor seconds of one design, its last line."""
    start, before = time.perf_counter(), os.times()
    command = [sys.executable, "-m", "matstd", "design", str(project), "-o", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    wall, after = time.perf_counter() - start, os.times()
    used = after.children_user + after.children_system
    used -= before.children_user + before.children_system
    said = (done.stdout if done.returncode == 0 else done.stderr).strip().splitlines()
    return done.returncode, wall, used, said[-2 if done.returncode == 0 else -1]


def main() -> None:
    """Print the times."""
    print(f"Python {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores")
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        for name in sys.argv[1:] or NAMES:
            code, wall, used, said = timed(
                EXAMPLES / f"{name}.toml", Path(folder) / Path(name).name
            )
            load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
            print(f"{name}: {wall:.0f} s ({used:.0f} s processor, load {load}); {said}", flush=True)
            failed += [name] * (code != 0)
        far = Path(folder) / "far.toml"
        text = (EXAMPLES / "hsm600u.toml").read_text(encoding="utf-8")
        text = text.replace(
            '"hsm600u-machine.toml"', f'"{(EXAMPLES / "hsm600u-machine.toml").as_posix()}"'
        )
        text = text.replace("origin_mm = [0.0,", "origin_mm = [2000.0,")
        text = text.replace("table_radius_mm = 160.0", "table_radius_mm = 2200.0")
        far.write_text(text, encoding="utf-8")
        code, wall, used, said = timed(far, Path(folder) / "far")
        print(f"out of reach: refused in {wall:.1f} s ({used:.1f} s processor); {said}")
    if failed or code != 2:
        sys.exit(f"failed: {', '.join(failed) or 'the refusal'}")


if __name__ == "__main__":
    main()
