"""`matstd thermal`: laws of a thermal drift from logs, and predictions with them."""

import argparse

from matstd.console import say, say_each
from matstd.options import Options, output
from matstd.twin.errors import DesignError
from matstd.twin.units import HOUR, MINUTE, UM

OPTIONS: Options = {
    "logs LOG.csv ...": "time_s or clock; temperatures name_degC, speeds name_rpm; displacements "
    "name_um, ...",
    "--train-until:float HOURS": "fit to the log until this time; hold out the rest",
    "--held-out LOG.csv ...": "logs that are held out completely",
    "--own-zeros": "fit a separate zero of the displacements for every log",
    "--step-min=5.0 MIN": "time step of the laws, minutes (5)",
    "--sensor-noise:float K": "also evaluate with this noise on the temperatures, K",
    "--probe-every:float HOURS": "also evaluate with the drift probed at this interval",
    "--u-um=1.0": "standard uncertainty of a probed drift, µm (1)",
    "--law thermal.json": "predict with this law of an earlier run; fit nothing",
    "--probed PROBED.csv": "with --law: drifts probed on standards",
    **output(),
}


def run(args: argparse.Namespace) -> int:
    """Compare laws, or predict with one; the folder appears whole or not at all."""
    if args.law and (args.held_out or args.train_until or len(args.logs) > 1):
        raise DesignError("expected one LOG.csv and no training options with --law")
    if args.probed and not args.law:
        raise DesignError("expected --law thermal.json with --probed")
    return _predict(args) if args.law else _compare(args)


def _compare(args: argparse.Namespace) -> int:
    """Laws beside one another, the chosen one with its file and page."""
    from matstd.api.drifting import SOMETIMES, learn_drift
    from matstd.progress import stages
    from matstd.twin.files import results_folder

    with results_folder(args.output, args.force, SOMETIMES) as folder, stages() as show:
        found = learn_drift(
            args.logs,
            args.held_out,
            train_until=None if args.train_until is None else args.train_until * HOUR,
            own_zeros=args.own_zeros,
            step=args.step_min * MINUTE,
            sensor_noise=args.sensor_noise,
            probe_every=None if args.probe_every is None else args.probe_every * HOUR,
            u=args.u_um * UM,
            progress=show,
        )
        found.write(folder)
    for line, is_best in found.lines:
        say(line, style="bold" if is_best else None)
    say_each((*found.probings, *found.record.remarks))
    say(f"{args.output}: look at report.html, thermal.json, drift.csv")
    return 0


def _predict(args: argparse.Namespace) -> int:
    """The drift of a log by an earlier law, with what was probed meanwhile."""
    from matstd.api.drifting import predict_drift

    found = predict_drift(args.law, args.logs[0], args.probed, args.u_um * UM)
    found.save(args.output, args.force)
    say(f"{found.law}: {len(found.record)} rows of {found.record.step / MINUTE:g} min")
    say_each(found.record.remarks)
    say(f"{args.output}: look at drift.csv, pictures/drift.png")
    return 0
