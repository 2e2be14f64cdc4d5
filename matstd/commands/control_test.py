"""`matstd control-test`: emitted programs on an installed LinuxCNC, and what its own log says."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.virtual_machine import add_planted, checked_noise

if TYPE_CHECKING:
    from pathlib import Path

    from probe_paths.linuxcnc import Session


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "design", metavar="OUT", help="folder of `matstd design`; its programs are for any control"
    )
    add_planted(parser)
    parser.add_argument(
        "--touches", metavar="N", type=int, help="only so many, spread evenly over the programs"
    )
    parser.add_argument(
        "--user", default="", help="who runs LinuxCNC where you are root, which it refuses"
    )
    parser.add_argument(
        "-o", "--output", metavar="FOLDER", required=True, help="for programs, log and run file"
    )
    parser.add_argument("--force", action="store_true", help="replace what is in the folder")


def run(args: argparse.Namespace) -> int:
    """Run the programs, keep the log whatever happens, evaluate it where all touches were made."""
    import shutil
    from pathlib import Path

    import numpy as np

    from artefact.body import read_standard
    from matstd.console import say
    from matstd.virtual_machine import virtual_machine
    from probe_paths.campaign import SMALLEST_U, check_moves, evaluate
    from probe_paths.control import MAX_FEED, read_log, read_program
    from probe_paths.emit import Feeds, make_programs
    from probe_paths.language import read_dialect
    from probe_paths.linuxcnc import (
        TwinContact,
        installed,
        latch_u,
        machine_files,
        machine_folder,
        run_on_linuxcnc,
        shortened,
    )
    from twin.errors import DesignError
    from twin.files import read_machine, write_run
    from twin.units import UM

    checked_noise(args)
    user = installed(args.user)
    out = _output_folder(args)
    design = Path(args.design)
    chain = read_machine(design / "machine.toml")
    standard = read_standard(design / "standard.toml")
    dialect = read_dialect("linuxcnc")
    for_errors, for_noise = np.random.default_rng(args.seed).spawn(2)
    machine = virtual_machine(args, design / "machine.toml", for_errors, dialect)
    given = [read_program(path, chain) for path in _programs(design)]
    # feeds near nothing that is measured: as high as a program may state them
    feeds = Feeds(approach=MAX_FEED, turning=MAX_FEED)
    made = make_programs(shortened(given, standard, chain, args.touches), dialect, feeds)
    programs = [read_program(path, chain) for path in made.write(out)]
    for program in programs:
        check_moves(program, standard, chain)
    contact = TwinContact(programs, standard, machine, for_noise)
    folder = machine_folder(user)
    try:
        socket = folder / "probe"
        files = machine_files(chain, programs[0].heading.probe, dialect, str(socket))
        touches = sum(program.touches for program in made.programs)
        say(f"{touches} touches on LinuxCNC, about {made.duration / 60.0:.0f} min")
        session = run_on_linuxcnc(made.programs, files, contact, socket, user)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    paths = _kept(session, out)
    if session.outcome:
        raise DesignError(f"{session.outcome}; what was logged is kept in {out}")
    contact.check_in_time()
    parts = [part for path in paths for part in read_log(path, chain.rotary_axes)]
    slow = programs[0].touches[0].slow_feed
    u = float(np.hypot(max(machine.noise, SMALLEST_U), latch_u(slow)))
    run = evaluate(parts, standard, chain, u, dialect)
    write_run(out / "run.csv", run, _seen_from(design / "machine.toml", out))
    latch = contact.latched(parts)
    say(
        f"{out / 'run.csv'}: {len(run)} touches from LinuxCNC's own log, "
        f"u = {u / UM:.3f} µm with the latch"
    )
    say(
        f"- latched {latch.min() / UM:.3f} to {latch.max() / UM:.3f} µm beyond the twin's contact, "
        f"mean {latch.mean() / UM:.3f}; modelled 0 to {slow * 1e-3 / UM:.3f} µm"
    )
    for text in args.add:
        say(f"- planted: {text}")
    for remark in run.remarks:
        say(f"- {remark}")
    return 0


def _output_folder(args: argparse.Namespace) -> Path:
    """The folder, which is there and holds nothing that nobody asked to replace."""
    from pathlib import Path

    from twin.errors import DesignError

    out = Path(args.output)
    if out.exists() and not out.is_dir():
        raise DesignError(f"{out}: is a file, expected a folder or a name that is free")
    if out.is_dir() and any(out.iterdir()) and not args.force:
        raise DesignError(f"{out}: already exists; choose another folder or give --force")
    out.mkdir(parents=True, exist_ok=True)
    return out


def _programs(design: Path) -> list[Path]:
    """Programs of a design in the order in which they are run."""
    from twin.errors import BadFile

    folder = design / "programs"
    found = [p for p in folder.glob("*") if p.suffix.lower() in (".h", ".ngc")]
    if not found:
        raise BadFile(folder, "folder", "no program", "the folder that `matstd design` made")
    return sorted(found, key=lambda p: (len(p.name), p.name))


def _kept(session: Session, out: Path) -> list[Path]:
    """Logs, and what LinuxCNC said, beside the programs."""
    from twin.files import write_whole

    for name, text in {**session.logs, "linuxcnc.txt": session.said}.items():
        write_whole(out / name, text)
    return [out / name for name in session.logs]


def _seen_from(file: Path, folder: Path) -> str:
    import os
    from pathlib import Path

    return Path(os.path.relpath(file, folder.resolve())).as_posix()
