"""What a compensated program leaves, in sentences."""

from collections.abc import Iterator

import numpy as np

from matstd.compensation.programs import Compensated
from matstd.report.numbers import digits
from matstd.twin.numbers import rms, rms_length
from matstd.twin.units import MINUTE, NM, UM


def program_lines(name: str, done: Compensated) -> Iterator[tuple[str, bool]]:
    """Lines on the console, and whether each is the first.

    Args:
        name: Of the file that was written.
    """
    motions, points = len(done.program.motions), len(done.q)
    yield f"{name}: {motions} motions as {points} lines", True
    before, after = (rms_length(field[done.is_stated]) / UM for field in (done.before, done.after))
    worst = np.linalg.norm(done.after[done.is_stated], axis=1).max() / UM
    words = f"tool point at line ends {digits(before)} -> {digits(after)} µm rms"
    words += f" (worst {digits(worst)} µm)"
    if done.u.any() and rms(done.u) > NM:
        words += f"; the model is known to {digits(rms(done.u) / UM, 2)} µm there"
    yield f"- {words}", False
    if done.is_cut:
        row = int(np.nanargmax(done.between))
        words = f"between line ends up to {digits(done.worst_between / UM)} µm off the path"
        words += f" (line {done.program.motions[done.motion[row]].line})"
        words += f"; divided until {digits(done.tolerance / UM)} µm are left"
        if done.worst_between > done.tolerance:
            words += ", but where a reversal or a load changes the correction at once"
        yield f"- {words}", False
    if len(done.leans):
        most = digits(done.leans.max() / UM)
        yield (
            f"- {len(done.leans)} holes by cycles, right at their bottom; lean {most} µm at most",
            False,
        )
    added = np.abs(done.added[:, done.program.frame.linear]).max() / UM
    minutes = digits(done.elapsed[-1] / MINUTE)
    yield f"- largest correction {digits(added)} µm; {minutes} min of motion", False
    if done.unmoved:
        lines = ", ".join(str(line) for line in done.unmoved)
        yield f"- left as they are, in coordinates of the machine or before a place: {lines}", False
