"""The page of a thermal drift: laws beside one another, the chosen one over time."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from matstd.diagnosis.drift import (
    DriftRecord,
    IntArray,
    Judged,
)
from matstd.report.drift.drift_pictures import draw_drift, draw_laws
from matstd.report.drift.drift_words import law_title, law_words, together, units_word
from matstd.report.numbers import digits, span
from matstd.report.pages import Picture, write_page
from matstd.twin.frames import Array
from matstd.twin.units import HOUR

PAGE = "report.html"
PICTURES = "pictures"


def write_drift_page(
    folder: str | Path,
    record: DriftRecord,
    judged: Sequence[Judged],
    best: Judged,
    hold: Array,
    train: IntArray,
    held: IntArray,
    title: str,
    probings: Sequence[str] = (),
) -> None:
    """Draw the pictures and write the page, which stands alone.

    Args:
        folder: Where `report.html` and the folder `pictures` go.
        record: All hours.
        judged: Every law.
        best: The chosen one.
        hold: What holding the last value leaves one step ahead, (K,).
        train: Rows of the training part.
        held: Rows that were held out.
        title: Names of the logs.
        probings: Sentences on what probing now and then leaves.
    """
    place = Path(folder) / PICTURES
    place.mkdir(parents=True, exist_ok=True)
    predicted, u = best.law.predicted(record), best.u(record)
    draw_drift(place / "drift.png", record, predicted, u, held)
    draw_laws(place / "laws.png", record, judged, best)
    inside = np.abs((predicted - record.displacement) / u)[held] < 2.0
    write_page(
        Path(folder) / PAGE,
        "thermal.html",
        place=place,
        title=title,
        remarks=record.remarks,
        unit=units_word(record),
        components=record.components,
        drives=record.drives,
        train_hours=len(train) * record.step / HOUR,
        held_hours=len(held) * record.step / HOUR,
        step=span(record.step),
        best=best,
        best_title=law_title(best.name),
        best_words=law_words(best, record),
        left_out=together(best.left_out, record),
        free_run=together(best.free_run, record),
        constant=next(together(j.free_run, record) for j in judged if j.name == "constant"),
        inside=float(inside.mean()),
        has_noise=any(j.noisy is not None for j in judged),
        hold=[digits(v) for v in (together(hold, record), *(hold / record.size))],
        rows=[_row(j, record, j is best) for j in judged],
        probings=probings,
        drift=Picture("drift.png", "Measured, and the free run of the chosen law with ± 2 u."),
        laws_picture=Picture("laws.png", "A small error one step ahead is no evidence of a law."),
    )


def _row(judged: Judged, record: DriftRecord, is_best: bool) -> dict[str, Any]:
    """One law: its errors together, and by component."""
    return {
        "title": law_title(judged.name),
        "is_best": is_best,
        "cells": [
            digits(together(v, record)) for v in (judged.one_step, judged.left_out, judged.free_run)
        ],
        "noisy": "" if judged.noisy is None else digits(together(judged.noisy, record)),
        "components": [digits(v) for v in judged.free_run / record.size],
    }
