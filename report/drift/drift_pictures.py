"""Pictures of a thermal drift: measured and predicted, and the errors of all laws."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.drift import DriftRecord, IntArray, Judged
from matstd.report.drift.drift_words import law_title, together
from matstd.report.style import BLUE, FAINT, INK, NEUTRAL, WASH, Figure, figure, plain, series
from matstd.twin.frames import Array
from matstd.twin.sampling import spread_rows
from matstd.twin.units import HOUR

DRAWN_MOMENTS = 3000  # points of a curve that are drawn at most


def draw_drift(
    record: DriftRecord,
    predicted: Array,
    u: Array,
    held: IntArray | None = None,
    has_measured: bool = True,
) -> Figure:
    """Every component over time: measured, predicted, and twice its uncertainty.

    Args:
        predicted: (N, K), base units.
        u: Standard uncertainty, (N, K).
        held: Rows that were held out, drawn on a ground of their own.
        has_measured: Whether the record has displacements to compare with.
    """
    count = len(record.components)
    drawn = figure(0.7 + 1.5 * count)
    every = np.atleast_1d(drawn.subplots(count, 1, sharex=True))
    rows = spread_rows(len(record), DRAWN_MOMENTS)
    hours = np.arange(len(record)) * record.step / HOUR  # logs stand one behind the other
    for k, ax in enumerate(every):
        size, unit = record.size[k], "µm" if record.units[k] == "mm" else "µrad"
        if held is not None:
            for run in np.split(held, np.flatnonzero(np.diff(held) > 1) + 1):
                ax.axvspan(hours[run[0]], hours[run[-1]], color=WASH, lw=0)
        low, high = ((predicted + s * 2.0 * u)[rows, k] / size for s in (-1.0, 1.0))
        ax.fill_between(hours[rows], low, high, color=BLUE, alpha=0.18, lw=0, label="± 2 u")
        if has_measured:
            y = record.displacement[rows, k] / size
            ax.plot(hours[rows], y, color=INK, lw=1.1, label="measured")
        ax.plot(hours[rows], predicted[rows, k] / size, color=BLUE, lw=1.1, label="predicted")
        ax.set_ylabel(f"{record.components[k]} in {unit}")
        plain(ax)
    every[0].legend(fontsize=8, frameon=False, ncols=3)
    every[-1].set_xlabel("time in h" + ("; held out on grey" if held is not None else ""))
    return drawn


def draw_laws(record: DriftRecord, judged: Sequence[Judged], best: Judged) -> Figure:
    """One step, left out and held out of every law, as bars."""
    drawn = figure(1.2 + 0.45 * len(judged))
    ax = drawn.subplots()
    y = np.arange(len(judged))[::-1]
    for k, (label, name) in enumerate(
        (("one step ahead", "one_step"), ("left-out blocks", "left_out"), ("held out", "free_run"))
    ):
        values = [together(getattr(j, name), record) for j in judged]
        colour = (NEUTRAL, FAINT, series(0))[k]
        ax.barh(y + 0.27 - 0.27 * k, values, height=0.25, color=colour, label=label)
    names = [law_title(j.name) + (" (chosen)" if j is best else "") for j in judged]
    ax.set_yticks(y, names)
    ax.set_xlabel("error in µm or µrad, rms over components")
    ax.legend(fontsize=8, frameon=False)
    plain(ax, "x")
    return drawn
