"""Laws of a thermal drift from logs of temperatures and displacements, and predictions by them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from matstd.api.saved import REPORT_FILES
from matstd.diagnosis.drift import (
    DriftRecord,
    Judged,
    JudgedLaws,
    ProbedPrediction,
    check_alike,
    chosen,
    joined,
    judge,
    lead,
    offered,
    predict_with_probings,
    read_law,
    read_log,
    read_probed,
    varying,
    write_drift,
    write_prediction,
)
from matstd.report.drift import (
    clock_line,
    draw_drift,
    drift_lines,
    kept_line,
    law_title,
    write_drift_page,
)
from matstd.report.style import save
from matstd.twin.compute import Progress, silent
from matstd.twin.display import Displayed
from matstd.twin.errors import BadArgument, BadFile, DesignError
from matstd.twin.files import results_folder
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import HOUR, MINUTE, UM

SOMETIMES = (*REPORT_FILES, "pictures/*.png", "thermal.json", "drift.csv")
"""Files that not every run leaves."""

HELD_OUT_SHARE = 0.3  # share of a log that is held out where nothing is said

STEP = 5.0 * MINUTE
"""Between two rows, s: machines drift in tens of minutes, and shorter steps add no information."""

MIN_ROWS = 40  # rows to learn from: ten for each of the blocks that are left out


@dataclass(frozen=True, eq=False, repr=False)
class DriftLaws(Displayed, JudgedLaws):
    """Laws of a thermal drift beside one another; `learn_drift` returns it.

    Example:
        >>> found = learn_drift(["drift.csv"])
        >>> any(one is found.best for one in found.judged)
        True
    """

    probings: tuple[str, ...]  # what probing the drift now and then would leave, as a sentence
    # names of the logs that were learnt from, and of those that were held out
    logs: tuple[tuple[str, ...], tuple[str, ...]]
    # noise on temperatures that the laws were judged with, too, K
    sensor_noise: float | None = None

    @property
    def lines(self) -> list[tuple[str, bool]]:
        """Every law in a sentence, and whether it is the chosen one."""
        return list(drift_lines(self))

    def save(self, folder: str | Path, force: bool = False) -> None:
        """Write thermal.json, drift.csv and the page into a folder, whole or not at all."""
        with results_folder(folder, force, SOMETIMES) as place:
            self.write(place)

    def write(self, folder: Path) -> None:
        """Write the results into a folder that is there."""
        record, best = self.record, self.best
        facts = {
            "logs": [name for names in self.logs for name in names],
            "train_h": len(self.train) * record.step / HOUR,
            "held_out_h": len(self.held) * record.step / HOUR,
            "sensor_noise_K": self.sensor_noise,
            "probing": list(self.probings),
            "remarks": list(record.remarks),
        }
        write_drift(folder / "thermal.json", self, facts)
        write_prediction(folder / "drift.csv", record, best.law.predicted(record), best.u(record))
        write_drift_page(folder, self, ", ".join(self.logs[0]), self.probings)


def learn_drift(
    logs: Sequence[str | Path],
    held_out: Sequence[str | Path] = (),
    *,
    train_until: float | None = None,
    own_zeros: bool = False,
    step: float = STEP,
    sensor_noise: float | None = None,
    probe_every: float | None = None,
    u: float = 1.0 * UM,
    progress: Progress = silent,
) -> DriftLaws:
    """Laws of a thermal drift, judged by what was held out.

    Args:
        logs: Temperatures, speeds and displacements over time (docs/thermal.md).
        held_out: Whole logs that are held out.
        train_until: Time of a single log from which the rest is held out, s; 70 % without it.
        own_zeros: Displacements of every log count from a zero of its own.
        step: Of the laws, s.
        sensor_noise: Judge the laws also with so much noise on temperatures, K.
        probe_every: Judge the chosen law also with the drift probed after such times, s.
        u: Standard uncertainty of a probed drift, mm.
        progress: Called with what is being done.

    Raises:
        BadFile: A log that cannot be read.
        BadArgument: A number that makes no sense.
        DesignError: Too few rows, or logs that do not go together.

    Example:
        >>> found = learn_drift(["drift.csv"])
        >>> len(found.train), len(found.held)
        (68, 29)
    """
    _check(len(logs), bool(held_out), train_until, own_zeros)
    for name, unit, value, low, high in (
        ("step_min", MINUTE, step, 1e-3, 60.0),
        ("u_um", UM, u, 1e-3, 1e3),
        ("sensor_noise", 1.0, sensor_noise, 0.0, 10.0),
        ("probe_every", HOUR, probe_every, 0.05, 1000.0),
    ):
        if value is not None and not low <= value / unit <= high:
            raise BadArgument(name, f"{value / unit:g}", f"{low:g} to {high:g}")
    record, train, held = _record(logs, held_out, train_until, own_zeros, step)
    laws = offered(record)
    noise = sensor_noise
    noisy = record.with_noise(noise, np.random.default_rng(1)) if noise else None
    judged = judge(record, train, held, laws, progress, noisy)
    best = chosen(judged, record)
    record = record.rezeroed(best.law.predicted(record))
    probings = () if probe_every is None else (_probed(probe_every, u, record, held, best),)
    names = tuple(tuple(Path(path).name for path in paths) for paths in (logs, held_out))
    return DriftLaws(
        record=record,
        train=train,
        held=held,
        judged=tuple(judged),
        best=best,
        probings=probings,
        logs=(names[0], names[1]),
        sensor_noise=noise,
    )


def _check(count: int, is_held_out: bool, train_until: float | None, own_zeros: bool) -> None:
    """Refuse arguments that do not go together; raises DesignError."""
    if train_until is not None and (is_held_out or count > 1):
        raise DesignError("expected --train-until with one log, or --held-out LOG.csv with several")
    if own_zeros and not is_held_out:
        raise DesignError("expected several logs and --held-out LOG.csv with --own-zeros")
    if count > 1 and not is_held_out:
        raise DesignError("expected --held-out LOG.csv, since there are several logs")


def _record(
    logs: Sequence[str | Path],
    held_out: Sequence[str | Path],
    train_until: float | None,
    own_zeros: bool,
    step: float,
) -> tuple[DriftRecord, IntArray, IntArray]:
    """All hours, and the rows to learn from and to hold out."""
    paths = [str(path) for path in (*logs, *held_out)]
    records = [read_log(path, step) for path in paths]
    check_alike(records, paths)
    record = joined(records, own_zeros)
    if held_out:
        count = sum(len(r) for r in records[: len(logs)])
    else:
        since = record.time - record.time[0]
        until = (1.0 - HELD_OUT_SHARE) * since[-1] if train_until is None else train_until
        count = int(np.searchsorted(since, until))
    if count < MIN_ROWS or len(record) - count < 2:
        raise DesignError(
            f"{count} rows to fit and {len(record) - count} held out: "
            f"expected {MIN_ROWS} and 2 at least (steps of {record.step / MINUTE:g} min)"
        )
    train = np.arange(count)
    record = varying(record, train)
    ahead = lead(record)
    if ahead:
        record = replace(record, remarks=(*record.remarks, clock_line(ahead)))
    return record, train, np.arange(count, len(record))


def _probed(every: float, u: float, record: DriftRecord, held: IntArray, best: Judged) -> str:
    """What probing the drift in held-out hours leaves, as a sentence."""
    rows_between = max(1, round(every / record.step))
    rows = held[::rows_between]
    if record.zeros is not None:  # the first probing in a log determines its zero
        firsts = rows[np.unique(record.zeros[rows], return_index=True)[1]]
        record = record.rezeroed(best.law.predicted(record), firsts)
    result = predict_with_probings(best, record, rows, u / UM)
    return kept_line(result, record, held, rows_between * record.step)


@dataclass(frozen=True, eq=False, repr=False)
class DriftPrediction(Displayed):
    """The drift of a log by an earlier law; `predict_drift` returns it.

    Example:
        >>> learn_drift(["drift.csv"]).save("laws")
        >>> predict_drift("laws/thermal.json", "drift.csv").save("prediction")
    """

    record: DriftRecord  # the log
    law: str  # what the law is called
    predicted: Array  # displacements, (N, K), units of the record
    u: Array  # their standard uncertainties, (N, K)

    def save(self, folder: str | Path, force: bool = False) -> None:
        """Write drift.csv and its picture into a folder, whole or not at all."""
        with results_folder(folder, force, SOMETIMES) as place:
            write_prediction(place / "drift.csv", self.record, self.predicted, self.u)
            (place / "pictures").mkdir()
            drawn = draw_drift(self.record, self.predicted, self.u, has_measured=False)
            save(drawn, place / "pictures" / "drift.png")


def predict_drift(
    law: str | Path, log: str | Path, probed: str | Path | None = None, u: float = 1.0 * UM
) -> DriftPrediction:
    """The drift of a log by an earlier law, with what was probed meanwhile.

    Args:
        law: thermal.json of `learn_drift`.
        log: Temperatures and speeds over time.
        probed: File of drifts probed on standards.
        u: Standard uncertainty of a probed drift where the file states none, mm.

    Raises:
        BadFile: A file that cannot be read, or a log without the sensors of the law.

    Example:
        >>> learn_drift(["drift.csv"]).save("laws", force=True)
        >>> predict_drift("laws/thermal.json", "drift.csv").predicted.shape
        (97, 1)
    """
    if not 1e-3 <= u / UM <= 1e3:
        raise BadArgument("u_um", f"{u / UM:g}", "0.001 to 1000")
    saved = read_law(law)
    record = read_log(log, saved.step, needs_displacement=False)
    missing = [d for d in saved.drives if d not in record.drives]
    if missing:
        raise BadFile(log, "columns", f"no {', '.join(missing)}", f"the drives of {law}")
    if abs(record.step - saved.step) > 0.01 * saved.step:
        found = f"a reading every {record.step:g} s"
        raise BadFile(log, "time", found, f"every {saved.step:g} s or faster")
    record = replace(
        record,
        components=saved.components,
        units=saved.units,
        displacement=np.zeros((len(record), len(saved.components))),
        drives=saved.drives,
        drive=record.columns(saved.drives),
    )
    judged = saved.judged()
    if probed is None:
        predicted, spread = judged.law.predicted(record), judged.u(record)
    else:
        result = _with_probings(probed, record, judged, u)
        predicted, spread = result.predicted, result.u
    return DriftPrediction(record, law_title(saved.name), predicted, spread)


def _with_probings(
    path: str | Path, record: DriftRecord, judged: Judged, u: float
) -> ProbedPrediction:
    """The prediction with the probings of a file."""
    rows, values, stated = read_probed(path, record)
    displacement = record.displacement.copy()
    displacement[rows] = values
    known = replace(record, displacement=displacement)
    return predict_with_probings(judged, known, rows, u / UM if stated is None else stated)
