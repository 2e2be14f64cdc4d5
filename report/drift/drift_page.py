"""The page of a thermal drift: the laws compared, the chosen one over time."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.diagnosis.drift import DriftRecord, JudgedLaws
from matstd.report.drift.drift_words import law_title, law_words, units_word
from matstd.report.layout import KeyFigure, Page, Picture, Section, Table, write_page
from matstd.report.numbers import digits, percent, sentence, span
from matstd.report.style import BLUE, FAINT, INK, NEUTRAL, WASH, Figure, figure, plain, series
from matstd.twin.frames import Array, IntArray
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


def draw_laws(found: JudgedLaws) -> Figure:
    """One step, left out and held out of every law, as bars."""
    judged = found.judged
    drawn = figure(1.2 + 0.45 * len(judged))
    ax = drawn.subplots()
    y = np.arange(len(judged))[::-1]
    for k, (label, name) in enumerate(
        (("one step ahead", "one_step"), ("left-out blocks", "left_out"), ("held out", "free_run"))
    ):
        values = [found.record.together(getattr(j, name)) for j in judged]
        colour = (NEUTRAL, FAINT, series(0))[k]
        ax.barh(y + 0.27 - 0.27 * k, values, height=0.25, color=colour, label=label)
    names = [law_title(j.name) + (" (chosen)" if j is found.best else "") for j in judged]
    ax.set_yticks(y, names)
    ax.set_xlabel("error in µm or µrad, rms over components")
    ax.legend(fontsize=8, frameon=False)
    plain(ax, "x")
    return drawn


_CHOICE = (
    "The choice is made within the training hours. Every law, with its orders, sensors and "
    "weights, is estimated again without each of four blocks and predicts that block as a free "
    "run. The held-out hours do not influence the choice. One step ahead, with the reading of "
    "{step} before given, every law looks good, and so does holding the last value, which is no "
    "law."
)
_MEANS = (
    "From the recorded drives alone the law predicts hours that it has not seen to {left} {unit}; "
    "a constant would leave {constant} {unit}. It holds within the drives of its training."
)
_NEXT = (
    "Predict another day (`matstd thermal --law`), and correct with it in `matstd compensate` or "
    "`matstd serve`."
)
_FOOT = (
    "Uncertainties are standard uncertainties (k = 1): residual and uncertainty of the "
    "coefficients, times the factor by which the blocks left out exceeded these. u grows where "
    "the drives leave the range of the training. Components: {components}. Drives: {drives}."
)


def write_drift_page(
    folder: str | Path, found: JudgedLaws, title: str, probings: Sequence[str] = ()
) -> None:
    """Write `report.html` and its pictures into a folder; the title names the logs."""
    record, best, held = found.record, found.best, found.held
    predicted, u = best.law.predicted(record), best.u(record)
    inside = np.abs((predicted - record.displacement) / u)[held] < 2.0
    unit, hours = units_word(record), record.step / HOUR
    constant = next(record.together(j.free_run) for j in found.judged if j.name == "constant")
    free_run = digits(record.together(best.free_run))
    drift = draw_drift(record, predicted, u, held)
    measured = "Measured drift, and the free run of the chosen law with ± 2 u."
    step_ahead = "A small error one step ahead is no evidence for a law."
    page = Page(
        heading=f"Thermal drift of {title}",
        lead=f"{law_title(best.name)}: {law_words(best, record)}.",
        means=_MEANS.format(left=free_run, constant=digits(constant), unit=unit),
        next=_NEXT,
        key=[
            KeyFigure(
                f"{digits(constant)} → {free_run} {unit}",
                "held-out hours, free run: a constant; the chosen law",
            ),
            KeyFigure(
                f"{digits(record.together(best.left_out))} {unit}",
                "the chosen law in blocks left out of its training",
            ),
            KeyFigure(percent(float(inside.mean())), "of the held-out readings within ± 2 u"),
            KeyFigure(
                f"{digits(len(found.train) * hours)} h + {digits(len(held) * hours)} h",
                "training; held out",
            ),
        ],
        sections=[
            Section(
                notes=record.remarks, pictures=[Picture("pictures/drift.png", measured, drift)]
            ),
            Section(
                "Comparison of the laws",
                sentences=[_CHOICE.format(step=span(record.step))],
                table=_laws(found),
                pictures=[Picture("pictures/laws.png", step_ahead, draw_laws(found))],
            ),
            *_probed(probings),
        ],
        foot=[
            _FOOT.format(components=", ".join(record.components), drives=", ".join(record.drives))
        ],
    )
    write_page(Path(folder) / "report.html", page)


def _laws(found: JudgedLaws) -> Table:
    """Errors of every law over all components, and those of the held-out hours by component."""
    record, judged = found.record, found.judged
    has_noise = any(j.noisy is not None for j in judged)
    noise = ["with noise"] if has_noise else []
    none = ["–"] * len(record.components)
    first = digits(record.together(found.hold))
    rows = [["last value held", first, "–", "–", *[""] * has_noise, *none]]
    for j in judged:
        cells = [digits(record.together(v)) for v in (j.one_step, j.left_out, j.free_run)]
        noisy = "" if j.noisy is None else digits(record.together(j.noisy))
        each = [digits(v) for v in j.free_run / record.size]
        rows.append([law_title(j.name), *cells, *[noisy] * has_noise, *each])
    columns = ("law", "one step", "left out", "held out", *noise, *record.components)
    caption = (
        f"Root mean square error, {units_word(record)}: over all components; then the held-out "
        "hours by component"
    )
    chosen = [1 + k for k, j in enumerate(judged) if j is found.best]
    return Table(columns, rows, caption, chosen)


def _probed(probings: Sequence[str]) -> list[Section]:
    words = [sentence(line) for line in probings]
    return [Section("With occasional probing", sentences=words)] if words else []
