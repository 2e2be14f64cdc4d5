"""A compensated program and its remaining error, in sentences."""

from collections.abc import Iterator

import numpy as np

from matstd.compensation.programs import Compensated
from matstd.report.numbers import digits, um
from matstd.twin.numbers import rms_length
from matstd.twin.units import MINUTE, NM, UM


def program_lines(name: str, done: Compensated) -> Iterator[tuple[str, bool]]:
    """Lines on the console, and whether each is the first."""
    motions, points = len(done.program.motions), len(done.q)
    yield f"{name}: {motions} motions as {points} lines", True
    before, after = (rms_length(field[done.is_stated]) / UM for field in (done.before, done.after))
    worst = np.linalg.norm(done.after[done.is_stated], axis=1).max() / UM
    words = f"tool point at line ends {digits(before)} -> {digits(after)} µm rms"
    words += f" (worst {digits(worst)} µm)"
    if done.u.any() and rms_length(done.u[:, None]) > NM:
        words += f"; the uncertainty of the model is {um(rms_length(done.u[:, None]), 2)} there"
    yield f"- {words}", False
    if done.is_cut:
        row = int(np.nanargmax(done.between))
        words = f"between line ends up to {digits(done.worst_between / UM)} µm off the path"
        words += f" (line {done.program.motions[done.motion[row]].line})"
        words += f"; lines were divided down to {digits(done.tolerance / UM)} µm"
        if done.worst_between > done.tolerance:
            words += ", except where a reversal or a load changes the correction abruptly"
        yield f"- {words}", False
    if len(done.leans):
        most = digits(done.leans.max() / UM)
        yield (
            f"- {len(done.leans)} holes by cycles, exact at their bottom; lean at most {most} µm",
            False,
        )
    added = np.abs(done.added[:, done.program.frame.linear]).max() / UM
    minutes = digits(done.elapsed[-1] / MINUTE)
    yield f"- largest correction {digits(added)} µm; {minutes} min of motion", False
    if done.unmoved:
        lines = ", ".join(str(line) for line in done.unmoved)
        yield f"- lines not compensated (machine coordinates, or no position yet): {lines}", False
