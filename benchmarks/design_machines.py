"""How long `matstd design` takes on every kind of machine, and a refusal for want of reach.

    python benchmarks/design_machines.py [NAME ...]
    python benchmarks/design_machines.py --like [KIND ...]

The second goes the way of a new user for each kind of machine that `matstd new machine --like`
offers: machine file, the command that its last line names, design. Each gives a design or a refusal
in one line.
Wanted of the first: each of the eight under 240 s on two idle cores, the refusal under 5 s. Wall
and processor time are printed, so that a busy machine shows.
"""

import os
import platform
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from matstd.commands.machine.new import MACHINES

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


def matstd(*words: str) -> subprocess.CompletedProcess[str]:
    """A command of the tool."""
    command = [sys.executable, "-m", "matstd", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def first_day(kind: str, folder: Path) -> bool:
    """Print what a new user gets for a kind of machine; whether it is a design or one refusal."""
    made = matstd("new", "machine", "--like", kind, "-o", str(folder / "machine.toml"))
    words = made.stdout.splitlines()[-1].removeprefix("next: matstd ").partition("   (")[0]
    begun = matstd(*shlex.split(words))
    if begun.returncode:
        said = begun.stderr.strip().splitlines()
        print(f"{kind}: {' '.join(said)}", flush=True)
        return begun.returncode == 2 and len(said) == 1
    code, wall, used, said = timed(folder / "project.toml", folder / "out")
    programs = len(list((folder / "out" / "programs").glob("*.H")))
    print(f"{kind}: {wall:.0f} s ({used:.0f} s processor), {programs} programs; {said}", flush=True)
    return code == 0 and programs > 0


def timed(project: Path, out: Path) -> tuple[int, float, float, str]:
    """Exit code, wall and processor seconds of one design, its last line."""
    start, before = time.perf_counter(), os.times()
    done = matstd("design", str(project), "-o", str(out))
    wall, after = time.perf_counter() - start, os.times()
    used = after.children_user + after.children_system
    used -= before.children_user + before.children_system
    said = (done.stdout if done.returncode == 0 else done.stderr).strip().splitlines()
    return done.returncode, wall, used, said[-2 if done.returncode == 0 else -1]


def main() -> None:
    """Print the times."""
    print(f"Python {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores")
    failed: list[str] = []
    if sys.argv[1:2] == ["--like"]:
        for kind in sys.argv[2:] or MACHINES:
            with tempfile.TemporaryDirectory() as folder:
                failed += [kind] * (not first_day(kind, Path(folder)))
        sys.exit(f"failed: {', '.join(failed)}" if failed else 0)
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
