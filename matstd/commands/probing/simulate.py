"""`matstd simulate`: an emitted program on the machine's twin, and the run file it leaves."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.options import (
    add_body,
    add_effects,
    add_output,
    body_stated,
    load_effects,
    seen_from,
    with_size,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np

    from matstd.artefact.body import Standard
    from matstd.probe_paths.campaign import VirtualMachine
    from matstd.probe_paths.control import ReadProgram
    from matstd.probe_paths.language import Dialect
    from matstd.twin.files import SensorRecord


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "programs",
        metavar="PROGRAM",
        nargs="+",
        help="probing programs, in the order in which they run",
    )
    parser.add_argument(
        "--standard", metavar="STANDARD.toml", required=True, help="standard that is probed"
    )
    parser.add_argument(
        "--real-standard",
        metavar="STANDARD.toml",
        help="true geometry of the standard, such as a calibrated one, if it differs from "
        "--standard",
    )
    parser.add_argument("--machine", metavar="MACHINE.toml", required=True, help="machine file")
    add_body(
        parser, "temperature of the standard, °C; the run file states it (default: 20, not stated)"
    )
    add_planted(parser)
    parser.add_argument(
        "--sensors",
        metavar="SENSORS.csv",
        help="temperatures and spindle speed over time, as for `evaluate`: columns clock "
        "(2031-05-06T07:08:09), T_<sensor>_degC, spindle_rpm; the run begins at the "
        "first row",
    )
    parser.add_argument(
        "--probe-length", type=float, help="length of the probe, mm; must equal the program's"
    )
    parser.add_argument(
        "--probe-radius", type=float, help="radius of the probe ball, mm; must equal the program's"
    )
    parser.add_argument(
        "--control",
        metavar="NAME|FILE.toml",
        default="itnc530",
        help="control that the programs are written for; needed for your own dialect (itnc530)",
    )
    parser.add_argument(
        "--logs", metavar="FOLDER", help="also write the logs of the control to this folder"
    )
    add_output(parser, "RUN.csv")


def run(args: argparse.Namespace) -> int:
    """Write the run file; a touch without contact stops the program and writes nothing."""
    import numpy as np

    from matstd.artefact.body import read_standard
    from matstd.console import say, say_assumed, say_each
    from matstd.probe_paths.campaign import SMALLEST_U, ball_changes, effective_radii, simulate
    from matstd.probe_paths.control import read_program, stated_probe
    from matstd.probe_paths.language import read_dialect
    from matstd.progress import stages
    from matstd.report.words import ball_lines
    from matstd.twin.files import read_sensors, refuse_to_overwrite, write_run, write_whole
    from matstd.twin.units import UM

    checked_noise(args)
    refuse_to_overwrite(args.output, args.force)
    standard = read_standard(args.standard)
    stated = body_stated(args, standard)
    real = _piece(args, standard)
    for_errors, for_noise = np.random.default_rng(args.seed).spawn(2)
    record = read_sensors(args.sensors) if args.sensors else None
    dialect = read_dialect(args.control)
    machine = virtual_machine(args, args.machine, for_errors, dialect, record)
    probe = stated_probe(args.programs[0], args.probe_radius, args.probe_length, machine.dialect)
    first = read_program(args.programs[0], machine.chain, probe, dialect)
    if first.is_search or first.is_first:
        return _search(args, first, real, machine, for_noise)
    with stages() as show:
        campaign = simulate(args.programs, real, machine, for_noise, probe, show, standard)
    run = campaign.run if record is None else record.joined(campaign.run, campaign.begin)
    rms = float(np.sqrt(np.mean(run.deviation**2))) / UM
    run, size = with_size(run, stated) if args.body_degC is not None else (run, [])
    write_run(args.output, run, seen_from(Path(args.output).parent, args.machine))
    # after it: a run that comes second does not touch the logs of the first
    for name, text in campaign.logs.items() if args.logs else ():
        write_whole(Path(args.logs) / name, text, newline="\r\n")
    minutes = campaign.runs[-1].end / 60.0
    say(
        f"{args.output}: {len(run)} touches in {minutes:.0f} min, "
        f"deviations {rms:.3f} µm rms after the set-up was fitted"
    )
    say_each(f"planted: {text}" for text in args.add)
    say_assumed(run.touches.chain)
    u = max(machine.noise, SMALLEST_U)
    changes = ball_changes(campaign.parts, standard, machine.chain, u, dialect)
    radii = effective_radii(campaign.parts, machine.chain, u, dialect)
    say_each([*ball_lines(changes, radii=radii), *size, *run.remarks])
    return 0


def _piece(args: argparse.Namespace, believed: Standard) -> Standard:
    """The standard as it really is, at its temperature.

    Raises:
        BadFile: The calibration of another standard than the design that is believed of it.
        DesignError: The uncertainty of a temperature that is not stated.
    """
    from matstd.artefact.body import read_standard
    from matstd.twin.errors import BadFile, DesignError

    if args.body_degC is None and args.body_u_K is not None:
        raise DesignError(f"--body-u-K {args.body_u_K:g}: expected --body-degC as well")
    real = read_standard(args.real_standard) if args.real_standard else believed
    if real.known and not believed.known and real.known.nominal != believed.fingerprint:
        raise BadFile(
            args.real_standard,
            "calibration.nominal",
            real.known.nominal,
            f"{believed.fingerprint}, the fingerprint of '{believed.name}' (--standard)",
        )
    return real if args.body_degC is None else real.at(args.body_degC)


def _search(
    args: argparse.Namespace,
    program: ReadProgram,
    standard: Standard,
    machine: VirtualMachine,
    rng: np.random.Generator,
) -> int:
    """Write the log of a program that measures nothing and leaves no run file."""
    from matstd.console import say
    from matstd.probe_paths.campaign import simulate_search
    from matstd.twin.errors import DesignError
    from matstd.twin.files import write_whole

    if not args.logs or len(args.programs) > 1:
        raise DesignError(
            f"{program.path}: a search for the standard and a commissioning program leave a log "
            "and no run file: run it alone, with --logs FOLDER"
        )
    reader = "replan" if program.is_search else "evaluate"
    for name, text in simulate_search(program, standard, machine, rng).log.items():
        write_whole(Path(args.logs) / name, text, newline="\r\n")
        say(f"{Path(args.logs) / name}: {len(program.touches)} touches; matstd {reader} reads it")
    return 0


def add_planted(parser: argparse.ArgumentParser) -> None:
    """Errors, noise, effects, set-up and probe as they really are."""
    errors = parser.add_mutually_exclusive_group()
    errors.add_argument("--errors", metavar="ERRORS.toml", help="errors of the machine")
    errors.add_argument(
        "--random-errors",
        action="store_true",
        help="draw the errors from the default distributions",
    )
    parser.add_argument(
        "--noise-um", type=float, default=1.0, help="standard deviation of one touch, µm (1.0)"
    )
    parser.add_argument(
        "--add",
        metavar="EFFECT=SIZE",
        action="extend",
        nargs="+",
        default=[],
        help="simulate these effects, each size with its unit: "
        "'thermal-lag(EZZ)=25um,tau=18min', 'backlash(X)=3um', 'drift=X=2um/h'",
    )
    add_effects(parser)
    parser.add_argument(
        "--setup-error",
        metavar="NAME=SIZE",
        help="offset of the standard from its planned set-up, in its own frame: "
        "X=0.3mm,Y=-0.1mm,C=0.05deg",
    )
    parser.add_argument(
        "--probe-error",
        metavar="NAME=SIZE",
        help="error of the probe, true minus calibrated value: radius=1um,length=20um",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of noise and random errors (0)")


def checked_noise(args: argparse.Namespace) -> None:
    """Refuse noise and seed that mean nothing; raises DesignError."""
    from matstd.twin.errors import DesignError

    if not 0.0 <= args.noise_um < 1000.0 or args.seed < 0:
        raise DesignError(
            f"--noise-um {args.noise_um:g} --seed {args.seed}: "
            "expected noise from 0 to 1000 µm and a seed from 0 up"
        )


def virtual_machine(
    args: argparse.Namespace,
    machine_file: str | Path,
    rng: np.random.Generator,
    dialect: Dialect,
    record: SensorRecord | None = None,
) -> VirtualMachine:
    """The machine as it really is, with the effects that the user plants in it.

    Args:
        args: With the options of `add_planted`.
        machine_file: Its nominal kinematics.
        rng: For random errors.
        dialect: Of its control.
        record: What drives effects, by the clock.
    """
    import numpy as np

    from matstd.probe_paths.campaign import FIRST_MORNING, VirtualMachine, effects_over_record
    from matstd.sensitivity.population import Population, drawn_errors
    from matstd.twin.files import read_errors, read_machine
    from matstd.twin.frames import fixed_xyz, pose
    from matstd.twin.library import parse_sized_effect, parse_sizes
    from matstd.twin.units import UM

    chain = read_machine(machine_file)
    load_effects(args.effects)
    errors = read_errors(args.errors, chain) if args.errors else []
    if args.random_errors:
        errors = drawn_errors(Population(chain), rng)
    planted = [parse_sized_effect(text, chain) for text in args.add]
    units = {**dict.fromkeys("XYZ", "mm"), **dict.fromkeys("ABC", "rad")}
    given = args.setup_error
    stands = parse_sizes(f"--setup-error {given}", given, units) if given else {}
    units = {"radius": "mm", "length": "mm"}
    given = args.probe_error
    probe = parse_sizes(f"--probe-error {given}", given, units) if given else {}
    return VirtualMachine(
        chain,
        effects_over_record([*errors, *planted], record),
        setup_error=pose(
            fixed_xyz(np.array([stands.get(a, 0.0) for a in "ABC"])),
            np.array([stands.get(a, 0.0) for a in "XYZ"]),
        ),
        radius_error=probe.get("radius", 0.0),
        length_error=probe.get("length", 0.0),
        noise=args.noise_um * UM,
        begin=FIRST_MORNING if record is None else record.begin,
        dialect=dialect,
        temperature=_thermometers(record),
    )


def _thermometers(record: SensorRecord | None) -> Callable[[str, float], float]:
    """What the control reads of a sensor: the record, or 20 degC of one that is not in it."""
    import numpy as np

    if record is None:
        return lambda name, now: 20.0
    since, known = record.since(record.begin), record.temperature
    return lambda name, now: float(np.interp(now, since, known[name])) if name in known else 20.0
