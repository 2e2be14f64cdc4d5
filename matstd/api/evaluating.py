"""Logs of a control made measurements."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from matstd.api.machines import chain_of
from matstd.api.probing import save_run, stated_body
from matstd.api.standards import standard_of
from matstd.artefact.body import Standard
from matstd.diagnosis.remarks import body_sizes
from matstd.importers import ScanLog, read_scan_log
from matstd.probe_paths.campaign import (
    ball_changes,
    check_as_programmed,
    check_changes,
    effective_radii,
    read_heights,
    read_program_of,
    sag_remarks,
    with_program_lines,
)
from matstd.probe_paths.campaign import evaluate as evaluate_parts
from matstd.probe_paths.control import LogPart, ReadProgram, read_log
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.scans import STRETCH, ScanNoise, ScanPoints, evaluate_scan
from matstd.report.numbers import um
from matstd.report.words import ball_lines, remark_sentence
from matstd.twin.display import Displayed
from matstd.twin.errors import BadArgument, BadFile, DesignError, NotEnoughData
from matstd.twin.files import read_sensors
from matstd.twin.frames import Array, apply
from matstd.twin.machine import Chain, inverse_linear
from matstd.twin.record import Run, Setup, with_body
from matstd.twin.units import UM


@dataclass(frozen=True, eq=False, repr=False)
class Evaluation(Displayed):
    """Logs of a control made measurements; `evaluate` returns it.

    Example:
        >>> found = evaluate(["logs/MS_A_1.TXT"], "standard.toml", "machine.toml")
        >>> found.save("evaluated.csv", "machine.toml")
    """

    measured: Run | None  # the measurements; None where the logs have touches on a ball alone
    chain: Chain  # the machine
    probe_remarks: tuple[str, ...]  # what the logs say of the probe
    remarks: tuple[str, ...] = ()  # what else the user should know

    @property
    def run(self) -> Run:
        """The measurements; raises NotEnoughData where the logs have none."""
        if self.measured is None:
            raise NotEnoughData("the logs hold no measurements, expected those of a program")
        return self.measured

    def save(self, path: str | Path, machine: str | Path) -> None:
        """Write the run file, which names the machine file, whole or not at all.

        Args:
            path: Run file.
            machine: Machine file as it is seen from the current folder; the run file has it as seen
                from its own.

        Raises:
            BadFile: There is no such machine file.
        """
        save_run(path, self.run, machine)


def evaluate(
    logs: Sequence[str | Path],
    standard: Standard | str | Path,
    machine: Chain | str | Path,
    *,
    u: float = 1.0 * UM,
    z: Literal["gauge", "tip"] = "gauge",
    probe_limit: float = 10.0 * UM,
    programs: str | Path | None = None,
    sensors: str | Path | None = None,
    body_temperature: float | None = None,
    body_u: float | None = None,
) -> Evaluation:
    """Measurements from the logs that probing programs left on a control.

    Args:
        logs: Of all probes and set-ups, in any order.
        standard: As calibrated; beside its file may stand a folder `programs`.
        machine: The machine.
        u: Standard uncertainty of one touch, mm.
        z: What Z the control returns from cycle 4: of the spindle gauge point, or of the pole of
            the ball.
        probe_limit: What the ball of the workshop may have moved between two of its logs, mm.
        programs: Folder of the programs that the logs are compared with.
        sensors: File with temperatures by the clock of the control.
        body_temperature: Of the standard while it was probed, degC.
        body_u: Its standard uncertainty, K.

    Raises:
        BadFile: A log that cannot be read, or that another program wrote.
        DesignError: The probe has changed between two logs.

    Example:
        >>> found = evaluate(["logs/MS_A_1.TXT"], "standard.toml", "machine.toml")
        >>> len(found.run)
        33
    """
    if not 1e-3 <= u / UM <= 1000.0:
        raise BadArgument("u_um", f"{u / UM:g}", "an uncertainty from 0.001 to 1000 µm")
    if not 0.0 < probe_limit < float("inf"):
        raise BadArgument("probe_limit_um", f"{probe_limit / UM:g}", "more than 0 µm")
    chain, piece = chain_of(machine), standard_of(standard)
    parts = [part for path in logs for part in read_log(path, chain.rotary_axes)]
    known: dict[str, ReadProgram] = {}
    if programs is not None or not isinstance(standard, Standard):
        known = _checked_programs(programs, standard, piece, parts, chain)
    dialect = Dialect(result_height=z)
    changes = ball_changes(parts, piece, chain, u, dialect)
    first = [part for part in parts if part.is_first]
    heights = [read_heights(part, piece, chain) for part in first]
    planned = [(part.radius, part.heading.probe.radius) for part in first]
    radii = effective_radii(parts, chain, u, dialect)
    of_probe = tuple(ball_lines(changes, probe_limit, heights, radii, planned))
    # logs of the ball or of the commissioning program alone answer for the probe, and hold no run
    if not any(part.is_measuring for part in parts) and of_probe:
        return Evaluation(None, chain, of_probe)
    # only now: a run that shall be evaluated needs one probe, the words above report any change
    check_changes(changes, probe_limit)
    run = with_program_lines(evaluate_parts(parts, piece, chain, u, dialect), known)
    twice: list[str] = []
    if sensors is not None:
        record = read_sensors(sensors)
        twice = [name for name in run.touches.temperature if name in record.temperature]
        run = record.joined(run, min(part.begin for part in parts))
    run = with_body(run, stated_body(piece, body_temperature, body_u))
    if not changes and any(part.is_ball for part in parts):
        once = "the ball was measured once: whether the probe has changed is not known"
        of_probe = (*of_probe, once)
    remarks = (
        *(remark_sentence(size) for size in body_sizes(run.touches)),
        *run.remarks,
        *(f"T_{name}_degC: that of {sensors} counts, not the log's" for name in twice),
        *(
            f"{part.path}: {part.program} stopped after {len(part.number)} touches"
            for part in parts
            if not part.is_complete
        ),
    )
    return Evaluation(run, chain, of_probe, remarks)


def _checked_programs(
    folder: str | Path | None,
    standard: Standard | str | Path,
    piece: Standard,
    parts: Sequence[LogPart],
    chain: Chain,
) -> dict[str, ReadProgram]:
    """The programs that wrote logs, where they are at hand; the logs agree with them."""
    place = Path(str(standard)).parent / "programs" if folder is None else Path(folder)
    names = {part.program for part in parts if part.is_measuring}
    files = [f for f in place.glob("*") if f.stem in names and f.suffix in (".H", ".ngc")]
    if folder is not None and not files:
        raise DesignError(f"--programs {place}: found none of {', '.join(sorted(names))}")
    programs = {file.stem: read_program_of(piece, file, chain) for file in files}
    check_as_programmed(parts, programs, chain)
    return programs


def evaluate_scan_log(
    log: str | Path,
    standard: Standard | str | Path,
    machine: Chain | str | Path,
    face: str,
    radius: float,
    length: float,
    *,
    setup: Setup | None = None,
    frame: str = "machine",
    u: float = 1.0 * UM,
    body_temperature: float | None = None,
    body_u: float | None = None,
) -> Evaluation:
    """Measurements from the log of a scan of one freeform face.

    Args:
        log: See `matstd.importers.points.scan_log`.
        face: Name of the scanned face.
        radius: Of the ball, mm.
        length: From the gauge point to its centre, mm.
        setup: Where the standard is believed to stand; None for the origin of the table.
        frame: What the coordinates are: `machine` readings of the axes, `standard` of the ball in
            the frame of the standard.
        u: Standard uncertainty of the probe beside the noise that the scan shows, mm.
        body_temperature: Of the standard while it was scanned, degC.
        body_u: Its standard uncertainty, K.

    Raises:
        BadFile: A log that cannot be read, has gaps or points that are not on the face.
    """
    if not 0.0 < radius < 50.0:
        raise BadArgument("radius_mm", f"{radius:g}", "radius of the ball, 0 to 50 mm")
    chain, piece, stands = chain_of(machine), standard_of(standard), setup or Setup("a")
    read = read_scan_log(log)
    points = _points(read, chain, length, stands, frame)
    run, noise = evaluate_scan(points, piece, face, chain, radius, length, stands, u)
    run = with_body(run, stated_body(piece, body_temperature, body_u))
    return Evaluation(run, chain, (), (_worth(noise, len(run)), *sag_remarks(piece), *run.remarks))


def _points(read: ScanLog, chain: Chain, length: float, stands: Setup, frame: str) -> ScanPoints:
    """The log on a machine."""
    q: Array = np.zeros((len(read.row), len(chain.axes)))
    for letter, angle in read.rotary.items():
        if letter in chain.axes:
            q[:, chain.axis_index(letter)] = angle
    if frame == "standard":
        q = inverse_linear(chain, apply(stands.T_table_artefact, read.position), q, length)
    else:
        others = [name for name in chain.linear_axes if name not in "XYZ"]
        if others:
            raise BadFile(
                read.path, "x, y, z", f"no column of {', '.join(others)}",
                "coordinates of the ball in the frame of the standard (--frame standard)",
            )  # fmt: skip
        for i, letter in enumerate("XYZ"):
            if letter in chain.axes:
                q[:, chain.axis_index(letter)] = read.position[:, i]
    return ScanPoints(
        path=read.path,
        row=read.row,
        line=read.line,
        is_numbered=read.is_numbered,
        q=q,
        deflection=read.deflection,
        time=read.time,
    )


def _worth(noise: ScanNoise, rows: int) -> str:
    """Points, their noise and its correlation, and the rows that they became."""
    return (
        f"{noise.points} points on {noise.lines} lines became {rows} rows, means of "
        f"{STRETCH:g} mm: a point has a noise of {um(noise.u)}, neighbours {noise.pitch:.2f} mm "
        f"apart a correlation of {noise.alike:.2f}, a row {um(noise.u_mean)} (waves of the probe "
        "over longer distances are not in it)"
    )
