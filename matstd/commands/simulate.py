"""`matstd simulate`: an emitted program on the machine's twin, and the run file it leaves."""

from __future__ import annotations

import argparse

from matstd.virtual_machine import add_planted, checked_noise


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "programs", metavar="PROGRAM", nargs="+", help="in the order in which they are run"
    )
    parser.add_argument("--standard", metavar="STANDARD.toml", required=True, help="what is probed")
    parser.add_argument("--machine", metavar="MACHINE.toml", required=True, help="the machine")
    add_planted(parser)
    parser.add_argument(
        "--sensors",
        metavar="SENSORS.csv",
        help="what temperatures and the spindle do, as `evaluate` takes it: columns clock "
        "(2031-05-06T07:08:09), T_<sensor>_degC, spindle_rpm; the run begins at its first row",
    )
    parser.add_argument("--probe-length", type=float, help="mm; must be the program's")
    parser.add_argument("--probe-radius", type=float, help="mm; must be the program's")
    parser.add_argument(
        "--control",
        metavar="NAME|FILE.toml",
        default="itnc530",
        help="whose words the programs have; needed for a dialect of your own (itnc530)",
    )
    parser.add_argument("--logs", metavar="FOLDER", help="also write the logs")
    parser.add_argument("-o", "--output", metavar="RUN.csv", required=True, help="to be written")
    parser.add_argument("--force", action="store_true", help="overwrite the output")


def run(args: argparse.Namespace) -> int:
    """Write the run file; a touch without contact stops the program and writes nothing."""
    import os
    from pathlib import Path

    import numpy as np

    from artefact.body import read_standard
    from matstd.console import say
    from matstd.progress import stages
    from matstd.virtual_machine import virtual_machine
    from probe_paths.campaign import simulate
    from probe_paths.control import stated_probe
    from probe_paths.language import read_dialect
    from twin.files import read_sensors, refuse_to_overwrite, write_run, write_whole
    from twin.units import UM

    checked_noise(args)
    refuse_to_overwrite(args.output, args.force)
    standard = read_standard(args.standard)
    for_errors, for_noise = np.random.default_rng(args.seed).spawn(2)
    record = read_sensors(args.sensors) if args.sensors else None
    dialect = read_dialect(args.control)
    machine = virtual_machine(args, args.machine, for_errors, dialect, record)
    probe = stated_probe(args.programs[0], args.probe_radius, args.probe_length, machine.dialect)
    with stages() as show:
        campaign = simulate(args.programs, standard, machine, for_noise, probe, show)
    run = campaign.run if record is None else record.joined(campaign.run, campaign.begin)
    for name, text in campaign.logs.items() if args.logs else ():
        write_whole(Path(args.logs) / name, text, newline="\r\n")
    folder = Path(args.output).resolve().parent
    write_run(args.output, run, Path(os.path.relpath(args.machine, folder)).as_posix())
    rms = float(np.sqrt(np.mean(run.deviation**2))) / UM
    minutes = campaign.runs[-1].end / 60.0
    say(
        f"{args.output}: {len(run)} touches in {minutes:.0f} min, "
        f"deviations {rms:.3f} µm rms after the set-up was fitted"
    )
    for text in args.add:
        say(f"- planted: {text}")
    for remark in run.remarks:
        say(f"- {remark}")
    return 0
