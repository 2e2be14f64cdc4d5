"""`matstd evaluate`: logs that our probing programs left on a control, made a run file."""

import argparse

from matstd.console import say, say_each
from matstd.options import Options, Required, body, output
from matstd.twin.errors import BadArgument
from matstd.twin.units import DEG, UM

OPTIONS: Options = {
    "logs LOG.TXT ...": "logs of the emitted programs, of all probes and set-ups, in any order",
    "--standard STANDARD.toml": Required("standard as calibrated"),
    "--machine MACHINE.toml": Required("machine file"),
    "--u-um=1.0": "standard uncertainty of one touch, µm (1.0)",
    "--z=gauge|tip": "meaning of Z in the result of cycle 4: spindle gauge point, or pole of the "
    "probe ball; a calibrated sphere shows which (gauge)",
    "--probe-limit-um=10.0": "largest change of the ball's position or of the probe's effective "
    "radius between two logs of OUT/setup/..._CAL, µm; beyond it the command stops (10)",
    "--programs DIR": "folder of the programs that the logs are checked against: sides, poses, "
    "tool and preset (default: `programs` beside STANDARD.toml, if it exists)",
    "--sensors SENSORS.csv": "temperatures over the clock of the control: columns clock "
    "(2031-05-06T07:08:09) and T_<sensor>_degC; T_body_degC is the standard's",
    "of a scan, a table with x, y, z in place of a log": {
        "--scan FACE": "name of the scanned freeform face",
        "--radius-mm:float": "radius of the ball",
        "--length-mm:float": "from the gauge point to the centre of the ball",
        "--frame=machine|standard": "what x, y, z are: readings of the axes, or the centre of the "
        "ball in the frame of the standard (machine)",
        "--origin-mm=0.0 X Y Z": "origin of the standard in the table frame, within 5 mm (0 0 0)",
        "--rotation-deg=0.0 A B C": "its rotations about the fixed x, then y, then z of the table "
        "frame (0 0 0)",
    },
    **body("temperature of the standard during probing, °C (default: T_body_degC of --sensors)"),
    **output("RUN.csv"),
}


def _scan_run(args: argparse.Namespace) -> int:
    """Write the run file of a scan."""
    import numpy as np

    from matstd.api.evaluating import evaluate_scan_log
    from matstd.twin.frames import fixed_xyz, pose
    from matstd.twin.record import Setup

    if len(args.logs) != 1 or args.radius_mm is None or args.length_mm is None:
        given = f"{len(args.logs)} files, radius {args.radius_mm}, length {args.length_mm}"
        raise BadArgument("scan", given, "one file, --radius-mm and --length-mm")
    turned = fixed_xyz(np.array(args.rotation_deg) * DEG)
    found = evaluate_scan_log(
        args.logs[0],
        args.standard,
        args.machine,
        args.scan,
        args.radius_mm,
        args.length_mm,
        setup=Setup("a", pose(turned, np.array(args.origin_mm))),
        frame=args.frame,
        u=args.u_um * UM,
        body_temperature=args.body_degC,
        body_u=args.body_u_K,
    )
    found.save(args.output, args.machine)
    say(f"{args.output}: {len(found.run)} rows of a scan of {args.scan}")
    say_each(list(found.remarks))
    return 0


def run(args: argparse.Namespace) -> int:
    """Write the run file and say what the logs hold."""
    import numpy as np

    from matstd.api.evaluating import evaluate
    from matstd.twin.files.whole import refuse_to_overwrite
    from matstd.twin.numbers import rms

    refuse_to_overwrite(args.output, args.force)
    if args.scan:
        return _scan_run(args)
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
    say_each(found.chain.remarks)
    say_each([*found.probe_remarks, *found.remarks])
    return 0
