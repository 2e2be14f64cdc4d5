"""A design on LinuxCNC: every block through its interpreter, and touches that it really makes.

What is planted is looked for in the control's own log, beside a model that was learnt by probing
the whole programs virtually without it.

    python benchmarks/control.py OUT [--touches 100] [--user NAME] [--add EFFECT=SIZE]

OUT is a folder of `matstd design`. Without LinuxCNC it says so. The second part takes the time that
the touches take; `--touches 0` leaves it out.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from matstd.artefact.body import read_standard
from matstd.cli import main as matstd
from matstd.probe_paths.control import read_program
from matstd.probe_paths.emit import Program, make_programs
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.linuxcnc import shortened
from matstd.twin.files import read_machine


def programs_of(design: Path) -> list[Program]:
    """All programs of a design for LinuxCNC, planned again from their text."""
    chain = read_machine(design / "machine.toml")
    files = [p for p in (design / "programs").iterdir() if p.suffix in (".H", ".ngc")]
    read = [read_program(p, chain) for p in sorted(files, key=lambda p: (len(p.name), p.name))]
    plan = shortened(read, read_standard(design / "standard.toml"), chain)
    return list(make_programs(plan, read_dialect("linuxcnc")).programs)


def interpreted(program: Program, folder: Path, top: float) -> str:
    """What `rs274` says of a program in which every touch is met; Z ends at `top`, mm."""
    met = program.text.replace("[#5070 - 1]", "0").replace("#5070 GT 0", "1 GT 0")
    (folder / "tool.tbl").write_text("T30 P30 Z163.0 D6.0\n")
    (folder / "a.var").write_text("")
    (folder / program.file).write_text(met)
    (folder / "a.ini").write_text(f"[AXIS_Z]\nMAX_LIMIT = {top}\n")
    command = ["rs274", "-i", "a.ini", "-t", "tool.tbl", "-v", "a.var", "-g", program.file]
    home = os.environ | {"HOME": str(folder)}  # where it keeps a tool table that two runs share
    done = subprocess.run(
        command, cwd=folder, env=home, capture_output=True, text=True, check=False
    )
    return done.stdout


def probed(design: Path, folder: Path, touches: int, add: str, user: str) -> None:
    """Touches on the control with an effect planted, and what is found in its log."""
    noise, quiet = ["--noise-um", "0.2"], ["--no-report", "-o"]
    of = ["--standard", str(design / "standard.toml"), "--machine", str(design / "machine.toml")]
    programs = [str(p) for p in sorted((design / "programs").iterdir()) if p.suffix == ".H"]
    matstd(["simulate", *programs, *of, *noise, "-o", str(folder / "known.csv")])
    matstd(["diagnose", str(folder / "known.csv"), *quiet, str(folder / "known")])
    begin = time.perf_counter()
    wanted = ["--touches", str(touches), "--add", add, *(["--user", user] if user else [])]
    matstd(["control-test", str(design), *wanted, *noise, "-o", str(folder / "control")])
    print(f"{time.perf_counter() - begin:.0f} s")
    model = ["--model", str(folder / "known" / "model.toml")]
    matstd(["diagnose", str(folder / "control" / "run.csv"), *model, *quiet, str(folder / "found")])


def main() -> None:
    """Blocks, then touches."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("design", type=Path)
    parser.add_argument("--touches", type=int, default=100)
    parser.add_argument("--user", default="")
    parser.add_argument("--add", default="backlash(X)=10um")
    args = parser.parse_args()
    if shutil.which("rs274") is None:
        raise SystemExit("LinuxCNC (rs274) is not installed: docs/controls.md")
    top = read_machine(args.design / "machine.toml").link("Z").range[1]
    with tempfile.TemporaryDirectory() as folder:
        for program in programs_of(args.design):
            begin = time.perf_counter()
            said = interpreted(program, Path(folder), top)
            seconds = time.perf_counter() - begin
            is_whole = "PROGRAM_END" in said
            made = said.count("STRAIGHT_PROBE") // 2
            print(
                f"{program.file}: {program.text.count(chr(10))} lines, "
                f"{'all taken' if is_whole else 'NOT TAKEN'}, {made} of {program.touches} touches, "
                f"{seconds:.1f} s"
            )
    if args.touches:
        with tempfile.TemporaryDirectory() as folder:
            probed(args.design, Path(folder), args.touches, args.add, args.user)


if __name__ == "__main__":
    main()
