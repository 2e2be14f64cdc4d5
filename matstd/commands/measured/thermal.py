"""`matstd thermal`: laws of a thermal drift from logs, and predictions with them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.options import add_output
from matstd.twin.errors import DesignError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from matstd.diagnosis.drift import DriftRecord, Judged, Kept

OURS = ("report.html", "tables.xlsx", "tables/*.csv", "pictures/*.png", "thermal.json", "drift.csv")
"""Results that not every run leaves."""

HELD = 0.3
"""Share of a log that is held out where nothing is said."""

STEP = 300.0
"""Between two rows, s: machines drift in tens of minutes, and shorter steps tell the same."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "logs",
        metavar="LOG.csv",
        nargs="+",
        help="time_s or clock; temperatures name_degC, speeds name_rpm; displacements name_um, ...",
    )
    parser.add_argument(
        "--train-until",
        metavar="HOURS",
        type=float,
        help="fit to the log until this time; hold out the rest",
    )
    parser.add_argument(
        "--held-out",
        metavar="LOG.csv",
        nargs="+",
        default=[],
        help="logs that are held out completely",
    )
    parser.add_argument(
        "--own-zeros",
        action="store_true",
        help="fit a separate zero of the displacements for every log",
    )
    parser.add_argument(
        "--step-min",
        metavar="MIN",
        type=float,
        default=STEP / 60.0,
        help="time step of the laws, minutes (5)",
    )
    parser.add_argument(
        "--sensor-noise",
        metavar="K",
        type=float,
        help="also evaluate with this noise on the temperatures, K",
    )
    parser.add_argument(
        "--probe-every",
        metavar="HOURS",
        type=float,
        help="also evaluate with the drift probed at this interval",
    )
    parser.add_argument(
        "--u-um", type=float, default=1.0, help="standard uncertainty of a probed drift, µm (1)"
    )
    parser.add_argument(
        "--law", metavar="thermal.json", help="predict with this law of an earlier run; fit nothing"
    )
    parser.add_argument(
        "--probed", metavar="PROBED.csv", help="with --law: drifts probed on standards"
    )
    add_output(parser)


def run(args: argparse.Namespace) -> int:
    """Compare laws, or predict with one; the folder appears whole or not at all."""
    _check(args)
    return _predict(args) if args.law else _compare(args)


def _check(args: argparse.Namespace) -> None:
    """Refuse options that do not go together, or make no sense."""
    if args.law and (args.held_out or args.train_until or len(args.logs) > 1):
        raise DesignError("expected one LOG.csv and no training options with --law")
    if args.probed and not args.law:
        raise DesignError("expected --law thermal.json with --probed")
    if args.train_until is not None and (args.held_out or len(args.logs) > 1):
        raise DesignError("expected --train-until with one log, or --held-out LOG.csv with several")
    if args.own_zeros and not args.held_out:
        raise DesignError("expected several logs and --held-out LOG.csv with --own-zeros")
    if len(args.logs) > 1 and not args.held_out:
        raise DesignError("expected --held-out LOG.csv, since there are several logs")
    for name, low, high in (
        ("step_min", 1e-3, 60.0),
        ("u_um", 1e-3, 1e3),
        ("sensor_noise", 0.0, 10.0),
        ("probe_every", 0.05, 1000.0),
    ):
        value = getattr(args, name)
        if value is not None and not low <= value <= high:
            option = name.replace("_", "-")
            raise DesignError(f"--{option} {value:g}: expected {low:g} to {high:g}")


def _compare(args: argparse.Namespace) -> int:
    """Laws beside one another, the chosen one with its file and page."""
    import numpy as np

    from matstd.console import say, say_each
    from matstd.diagnosis.drift import (
        chosen,
        judge,
        offered,
        write_drift,
        write_prediction,
    )
    from matstd.progress import stages
    from matstd.report.drift import drift_lines, write_drift_page
    from matstd.twin.files import results_folder

    record, train, held = _record(args)
    laws = offered(record)
    noise = args.sensor_noise
    noisy = record.with_noise(noise, np.random.default_rng(1)) if noise else None
    with results_folder(args.output, args.force, OURS) as folder, stages() as show:
        judged = judge(record, train, held, laws, show, noisy)
        best = chosen(judged, record)
        record = record.rezeroed(best.law.predicted(record))
        hold = _hold(record, held)
        probings = _probings(args, record, held, best)
        said = {
            "logs": [Path(p).name for p in (*args.logs, *args.held_out)],
            "train_h": len(train) * record.step / 3600.0,
            "held_out_h": len(held) * record.step / 3600.0,
            "sensor_noise_K": noise,
            "probing": probings,
            "remarks": list(record.remarks),
        }
        write_drift(folder / "thermal.json", record, judged, best, said)
        write_prediction(folder / "drift.csv", record, best.law.predicted(record), best.u(record))
        title = ", ".join(Path(p).name for p in args.logs)
        write_drift_page(folder, record, judged, best, hold, train, held, title, probings)
    for line, is_best in drift_lines(record, judged, best, hold):
        say(line, style="bold" if is_best else None)
    say_each((*probings, *record.remarks))
    say(f"{args.output}: look at report.html, thermal.json, drift.csv")
    return 0


def _record(args: argparse.Namespace) -> tuple[DriftRecord, NDArray[np.int64], NDArray[np.int64]]:
    """All hours, and the rows to fit and to hold out."""
    from dataclasses import replace

    import numpy as np

    from matstd.diagnosis.drift import check_alike, joined, lead, read_log, varying
    from matstd.report.drift import clock_line

    paths = [*args.logs, *args.held_out]
    records = [read_log(path, args.step_min * 60.0) for path in paths]
    check_alike(records, paths)
    record = joined(records, args.own_zeros)
    if args.held_out:
        count = sum(len(r) for r in records[: len(args.logs)])
    else:
        hours = (record.time - record.time[0]) / 3600.0
        until = (1.0 - HELD) * hours[-1] if args.train_until is None else args.train_until
        count = int(np.searchsorted(hours, until))
    if count < LEAST or len(record) - count < 2:
        raise DesignError(
            f"{count} rows to fit and {len(record) - count} held out: "
            f"expected {LEAST} and 2 at least (steps of {record.step / 60.0:g} min)"
        )
    train = np.arange(count)
    record = varying(record, train)
    ahead = lead(record)
    if ahead:
        record = replace(record, remarks=(*record.remarks, clock_line(ahead)))
    return record, train, np.arange(count, len(record))


LEAST = 40
"""Rows to learn from: ten for each of the blocks that are left out."""


def _hold(record: DriftRecord, held: NDArray[np.int64]) -> NDArray[np.float64]:
    """What holding the last value leaves one step ahead, (K,)."""
    import numpy as np

    step = record.displacement[held] - record.displacement[held - 1]
    return np.sqrt(np.mean(step**2, axis=0))


def _probings(
    args: argparse.Namespace, record: DriftRecord, held: NDArray[np.int64], best: Judged
) -> list[str]:
    """What probing the drift in held-out hours leaves, as a sentence."""
    import numpy as np

    from matstd.diagnosis.drift import kept
    from matstd.report.drift import kept_line

    if args.probe_every is None:
        return []
    every = max(1, round(args.probe_every * 3600.0 / record.step))
    rows = held[::every]
    if record.zeros is not None:  # the first probing in a log tells where its zero is
        firsts = rows[np.unique(record.zeros[rows], return_index=True)[1]]
        record = record.rezeroed(best.law.predicted(record), firsts)
    result = kept(best, record, rows, args.u_um)
    return [kept_line(result, record, held, every * record.step)]


def _predict(args: argparse.Namespace) -> int:
    """The drift of a log by an earlier law, with what was probed meanwhile."""
    from dataclasses import replace

    import numpy as np

    from matstd.console import say, say_each
    from matstd.diagnosis.drift import read_law, read_log, write_prediction
    from matstd.report.drift import draw_drift, law_title
    from matstd.report.style import save
    from matstd.twin.errors import BadFile
    from matstd.twin.files import results_folder

    saved = read_law(args.law)
    record = read_log(args.logs[0], saved.step, needs_displacement=False)
    missing = [d for d in saved.drives if d not in record.drives]
    if missing:
        raise BadFile(
            args.logs[0], "columns", f"no {', '.join(missing)}", f"the drives of {args.law}"
        )
    if abs(record.step - saved.step) > 0.01 * saved.step:
        found = f"a reading every {record.step:g} s"
        raise BadFile(args.logs[0], "time", found, f"every {saved.step:g} s or faster")
    nothing = np.zeros((len(record), len(saved.components)))
    record = replace(
        record,
        components=saved.components,
        units=saved.units,
        displacement=nothing,
        drives=saved.drives,
        drive=record.columns(saved.drives),
    )
    result = _with_probings(args, record, saved.judged()) if args.probed else None
    judged = saved.judged()
    predicted = result.predicted if result else judged.law.predicted(record)
    u = result.u if result else judged.u(record)
    with results_folder(args.output, args.force, OURS) as folder:
        write_prediction(folder / "drift.csv", record, predicted, u)
        (folder / "pictures").mkdir()
        drawn = draw_drift(record, predicted, u, has_measured=False)
        save(drawn, folder / "pictures" / "drift.png")
    say(f"{law_title(saved.name)}: {len(record)} rows of {record.step / 60.0:g} min")
    say_each(record.remarks)
    say(f"{args.output}: look at drift.csv, pictures/drift.png")
    return 0


def _with_probings(args: argparse.Namespace, record: DriftRecord, judged: Judged) -> Kept:
    """The prediction with the probings of a file."""
    from dataclasses import replace

    from matstd.diagnosis.drift import kept, read_probed

    rows, values, u = read_probed(args.probed, record)
    displacement = record.displacement.copy()
    displacement[rows] = values
    known = replace(record, displacement=displacement)
    return kept(judged, known, rows, args.u_um if u is None else u)
