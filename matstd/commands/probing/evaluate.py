"""`matstd evaluate`: logs that our probing programs left on a control, made a run file."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.options import add_body, add_output, body_stated, seen_from, with_size

if TYPE_CHECKING:
    from matstd.probe_paths.control import LogPart
    from matstd.twin.machine import Chain


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "logs",
        metavar="LOG.TXT",
        nargs="+",
        help="logs of the emitted programs, of all probes and set-ups, in any order",
    )
    parser.add_argument(
        "--standard", metavar="STANDARD.toml", required=True, help="standard as calibrated"
    )
    parser.add_argument("--machine", metavar="MACHINE.toml", required=True, help="machine file")
    parser.add_argument(
        "--u-um", type=float, default=1.0, help="standard uncertainty of one touch, µm (1.0)"
    )
    parser.add_argument(
        "--z",
        choices=("gauge", "tip"),
        default="gauge",
        help="meaning of Z in the result of cycle 4: spindle gauge point, or pole of the "
        "probe ball; a calibrated sphere shows which (gauge)",
    )
    parser.add_argument(
        "--probe-limit-um",
        type=float,
        default=10.0,
        help="largest change of the ball's position or of the probe's effective radius "
        "between two logs of OUT/setup/..._CAL, µm; beyond it the command stops (10)",
    )
    parser.add_argument(
        "--programs",
        metavar="DIR",
        help="folder of the programs that the logs are checked against: sides, poses, tool "
        "and preset (default: `programs` beside STANDARD.toml, if it exists)",
    )
    parser.add_argument(
        "--sensors",
        metavar="SENSORS.csv",
        help="temperatures over the clock of the control: columns clock "
        "(2031-05-06T07:08:09) and T_<sensor>_degC; T_body_degC is the standard's",
    )
    add_body(
        parser, "temperature of the standard during probing, °C (default: T_body_degC of --sensors)"
    )
    add_output(parser, "RUN.csv")


def run(args: argparse.Namespace) -> int:
    """Write the run file and say what the logs hold."""
    from pathlib import Path

    import numpy as np

    from matstd.artefact.body import read_standard
    from matstd.console import say, say_assumed, say_each
    from matstd.probe_paths.campaign import (
        ball_changes,
        check_changes,
        effective_radii,
        evaluate,
        read_heights,
    )
    from matstd.probe_paths.control import read_log
    from matstd.probe_paths.language import Dialect
    from matstd.report.words import ball_lines
    from matstd.twin.files import read_machine, read_sensors, refuse_to_overwrite, write_run
    from matstd.twin.units import UM

    _check_numbers(args)
    refuse_to_overwrite(args.output, args.force)
    chain, standard = read_machine(args.machine), read_standard(args.standard)
    parts = [part for path in args.logs for part in read_log(path, chain.rotary_axes)]
    _check_programs(args, parts, chain)
    dialect, u, limit = Dialect(result_height=args.z), args.u_um * UM, args.probe_limit_um * UM
    changes = ball_changes(parts, standard, chain, u, dialect)
    first = [part for part in parts if part.is_first]
    heights = [read_heights(part, standard, chain) for part in first]
    known = [(p.radius, p.heading.probe.radius) for p in first]
    radii = effective_radii(parts, chain, u, dialect)
    told = ball_lines(changes, limit, heights, radii, known)
    if not any(part.is_measuring for part in parts) and told:
        say_each(["no run file: the logs hold no measurements", *told])
        return 0
    check_changes(changes, limit)
    measured = evaluate(parts, standard, chain, u, dialect)
    twice: list[str] = []
    if args.sensors:
        record = read_sensors(args.sensors)
        twice = [name for name in measured.touches.temperature if name in record.temperature]
        measured = record.joined(measured, min(part.begin for part in parts))
    rms = float(np.sqrt(np.mean(measured.deviation**2))) / UM
    measured, size = with_size(measured, body_stated(args, standard))
    write_run(args.output, measured, seen_from(Path(args.output).parent, args.machine))
    say(
        f"{args.output}: {len(measured)} touches at {len(np.unique(measured.touches.pose))} table "
        f"poses, deviations {rms:.3f} µm rms after the set-up was fitted"
    )
    say_assumed(chain)
    say_each(told)
    if not changes and any(part.is_ball for part in parts):
        say_each(["the ball was measured once: a change of the probe cannot be determined"])
    say_each([*size, *measured.remarks])
    say_each(f"T_{name}_degC: that of {args.sensors} counts, not the log's" for name in twice)
    say_each(
        f"{part.path}: {part.program} stopped after {len(part.number)} touches"
        for part in parts
        if not part.is_complete
    )
    return 0


def _check_programs(args: argparse.Namespace, parts: list[LogPart], chain: Chain) -> None:
    """Compare the logs with the programs that wrote them, where these are at hand."""
    from pathlib import Path

    from matstd.probe_paths.campaign import check_as_programmed
    from matstd.probe_paths.control import read_program
    from matstd.twin.errors import DesignError

    beside = Path(args.standard).parent / "programs"
    folder = beside if args.programs is None else Path(args.programs)
    names = {part.program for part in parts if part.is_measuring}
    files = [f for f in folder.glob("*") if f.stem in names and f.suffix in (".H", ".ngc")]
    if args.programs is not None and not files:
        raise DesignError(f"--programs {folder}: found none of {', '.join(sorted(names))}")
    programs = {file.stem: read_program(file, chain) for file in files}
    check_as_programmed(parts, programs, chain)


def _check_numbers(args: argparse.Namespace) -> None:
    """Refuse an uncertainty or a limit that means nothing; raises DesignError."""
    from matstd.twin.errors import DesignError

    if not 1e-3 <= args.u_um <= 1000.0:
        raise DesignError(f"--u-um {args.u_um:g}: expected an uncertainty from 0.001 to 1000 µm")
    if not 0.0 < args.probe_limit_um < float("inf"):
        raise DesignError(f"--probe-limit-um {args.probe_limit_um:g}: expected more than 0 µm")
