"""How long each command still runs after Ctrl-C, and what it leaves behind.

    python benchmarks/stop_latency.py [--only design,diagnose] [--at 0.3,1,3,7]

Every command is begun anew for every moment, interrupted there, and has to end within a second,
with exit code 130 and no file or folder that was not there before. Before 0.2 s Python itself
begins.
"""

import argparse
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

ROOT = Path(__file__).parents[1]
MOMENTS = "0.3,1,2,4,7,12,20,35,60,100,150"
PATIENCE = 60.0
LIMIT = 1.0
POSES = 300_000


def commands(place: Path) -> dict[str, list[str]]:
    """Arguments of every command that can last; what they read is made in a folder."""
    examples = ROOT / "examples"
    machine, project = examples / "hsm600u-machine.toml", examples / "hsm600u.toml"
    run = examples / "hidden_effect" / "warm_up.csv"
    rng = np.random.default_rng(0)
    low, high = [-300, -200, -300, -100, 0, 160], [300, 200, -50, 20, 360, 160]
    head = "X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_length_mm"
    poses, errors, out = place / "poses.csv", place / "errors.toml", place / "out"
    np.savetxt(poses, rng.uniform(low, high, (POSES, 6)), "%.3f", ",", header=head, comments="")
    errors.write_text('format = "errors/1"\n[EXX]\nshape = "linear"\namplitude = 12.0\n')
    words = {
        "design": ["design", project, "-o", out],
        "study": ["sensitivity", project, "-o", out],
        "sensitivity": ["sensitivity", machine, poses, "-o", place / "s.csv"],
        "volumetric": ["volumetric", machine, errors, poses, "-o", place / "v.csv"],
        "diagnose": ["diagnose", run, "--auto", "-o", out],
        "compare": ["compare", run, "-o", out],
    }
    designed = ROOT / "out" / "hsm600u"
    programs = sorted((designed / "programs").glob("MS_A_?.H"))
    if programs:
        machine, standard = designed / "machine.toml", designed / "standard.toml"
        known = ["--standard", standard, "--machine", machine, "--random-errors"]
        words["simulate"] = ["simulate", *programs, *known, "-o", place / "r.csv"]
    else:
        print("simulate is left out: make design first")
    return {name: [str(word) for word in given] for name, given in words.items()}


def interrupted(arguments: list[str], place: Path, after: float) -> tuple[float, int, list[str]]:
    """Seconds that a command runs on, its exit code, and what it leaves; negative: it was over."""
    before = set(place.iterdir())
    process = subprocess.Popen(
        [sys.executable, "-m", "matstd", *arguments],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        process.wait(after)
        return -1.0, process.returncode, []
    except subprocess.TimeoutExpired:
        begun = time.monotonic()
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        process.wait(PATIENCE)
        took = time.monotonic() - begun
    return took, process.returncode, [p.name for p in set(place.iterdir()) - before]


def main() -> int:
    """Print one line for each command and moment; 1 if any took longer or left anything."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="commands, with commas between")
    parser.add_argument("--at", default=MOMENTS, help=f"seconds, with commas between ({MOMENTS})")
    args = parser.parse_args()
    is_bad = False
    with TemporaryDirectory() as folder:
        known = commands(Path(folder))
        for name in args.only.split(",") if args.only else known:
            for after in map(float, args.at.split(",")):
                took, code, left = interrupted(known[name], Path(folder), after)
                if took < 0.0:
                    print(f"{name:12s} is over before {after:g} s")
                    break
                print(f"{name:12s} at {after:6.1f} s: {took:5.2f} s, code {code}, left {left}")
                is_bad |= took > LIMIT or code != 130 or bool(left)
    return int(is_bad)


if __name__ == "__main__":
    sys.exit(main())
