"""Page of `matstd uncertainty`: budget, face by face, visits."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matstd.diagnosis.task import TaskUncertainty
from matstd.report.pages.page import write_page
from matstd.report.task import budget_rows
from matstd.twin.units import UM


def write_uncertainty_page(
    path: str | Path,
    task: str,
    standard: str,
    sentence: str,
    found: Mapping[str, TaskUncertainty],
    lines: Sequence[str],
    runs: Sequence[tuple[str, int]],
    remarks: Sequence[str],
) -> None:
    """Write the page, which stands alone.

    Args:
        path: HTML file; its tables go beside it.
        task: What is measured.
        standard: Name of what was measured.
        sentence: How much was measured.
        found: Budgets by what results are corrected with.
        lines: Sentences on them.
        runs: Name and number of touches of every visit.
        remarks: On the runs and the model.
    """
    by_face = [
        (name, [(face, mean / UM, spread / UM) for face, mean, spread in budget.by_face])
        for name, budget in found.items()
    ]
    write_page(
        path,
        "uncertainty.html",
        task=task,
        standard=standard,
        sentence=sentence,
        budgets=budget_rows(found),
        lines=lines,
        by_face=by_face,
        runs=runs,
        remarks=remarks,
    )
