"""`matstd evaluate`: logs that our probing programs left on a control, made a run file."""

from __future__ import annotations

import argparse

from matstd.options import add_body, add_output


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
    import numpy as np

    from matstd.api.evaluating import evaluate
    from matstd.console import say, say_assumed, say_each
    from matstd.twin.files import refuse_to_overwrite
    from matstd.twin.numbers import rms
    from matstd.twin.units import UM

    refuse_to_overwrite(args.output, args.force)
    found = evaluate(
        args.logs,
        args.standard,
        args.machine,
        u=args.u_um * UM,
        z=args.z,
        probe_limit=args.probe_limit_um * UM,
        programs=args.programs,
        sensors=args.sensors,
        body_temperature=args.body_degC,
        body_u=args.body_u_K,
    )
    run = found.measured
    if run is None:
        say_each(["no run file: the logs hold no measurements", *found.probe_remarks])
        return 0
    left = rms(run.raw_deviation) / UM
    found.save(args.output, args.machine)
    say(
        f"{args.output}: {len(run)} touches at {len(np.unique(run.touches.pose))} table "
        f"poses, deviations {left:.3f} µm rms after the set-up was fitted"
    )
    say_assumed(found.chain)
    say_each([*found.probe_remarks, *found.remarks])
    return 0
