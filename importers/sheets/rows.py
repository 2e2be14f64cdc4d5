"""Lines of a text that are not blank, and times of a run by the order of its rows."""

from dataclasses import replace

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.record import Run
from matstd.twin.units import DAY


def filled_lines(text: str) -> list[tuple[int, str]]:
    """Lines of a text that are not blank, stripped, with their numbers from 1."""
    return [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1) if line.strip()]


def timed_by_rows(run: Run, step: float) -> Run:
    """The run with times by the order of the rows of its table, `step` s apart.

    Readings of one row are one moment. Raises DesignError for a step out of range, or a run that
    has times.
    """
    if not 0.0 < step <= DAY:
        raise DesignError(f"--in-order {step:g}: expected seconds from 0 to {DAY:g}")
    touches = run.touches
    if np.ptp(touches.time) > 0.0:
        raise DesignError("--in-order: the table has times; expected one without")
    time = np.zeros(len(run))
    for k in np.unique(touches.run):
        rows = touches.run == k
        time[rows] = step * np.unique(run.line[rows], return_inverse=True)[1]
    return replace(run, touches=replace(touches, time=time))
