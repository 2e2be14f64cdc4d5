"""The page of `matstd uncertainty`: budget, results by face, visits."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matstd.diagnosis.task import TaskUncertainty
from matstd.report.layout import KeyFigure, Page, Section, Table, write_page
from matstd.report.numbers import plural, um
from matstd.report.numbers import sentence as as_sentence
from matstd.report.task import FEW_VISITS, budget_rows
from matstd.report.verdict import uncertainty_meaning
from matstd.twin.units import UM

_MEASURAND = (
    "Measurand: the deviation of a surface point from its nominal position, measured once, with "
    "the workpiece aligned by datum features. The budget follows from repeated measurements of the "
    "calibrated faces of {standard} (as in ISO 15530-3)."
)
_TERMS = (
    "b: mean of all deviations. U: half the interval that holds 95 % of the expected errors of the "
    "next result, corrected by b, averaged over the variances of the machine and of a visit that "
    "the visits allow (JCGM 101, 7.7); for results that are not corrected, |b| is added. k and "
    "degrees of freedom: of Student's distribution with this interval, "
    "U = k √(u_{cal}² + u_{p}² + u_{b}² + u_{w}²). u_{cal}: of b, from the calibration of the "
    "standard. u_{p}: of one visit. u_{w}: of the workpieces, as stated in the task. u_{b}: of the "
    "remaining systematic error of the machine, from its variation over the task."
)


def budget_table(budgets: Mapping[str, TaskUncertainty]) -> Table:
    """Standard uncertainties and expanded uncertainties, a row for each way of correction."""
    columns = ("results", "b", "u_{cal}", "u_{p}", "u_{b}", "u_{w}", "k", "degrees of freedom",
               "U, corrected by b", "U, not corrected")  # fmt: skip
    caption = "Standard uncertainties and expanded uncertainty U (95 %), µm"
    return Table(columns, budget_rows(budgets), caption)


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
    """Write the page, and its tables beside it.

    Args:
        sentence: How much was measured.
        found: Budgets by what results are corrected with.
        lines: Sentences on them.
        runs: Name and number of touches of every visit.
        remarks: On the runs and the model.
    """
    by_face = [_by_face(name, budget) for name, budget in found.items()]
    visits = Table(("run", "touches"), [[f"`{name}`", str(n)] for name, n in runs])
    page = Page(
        heading=f"Uncertainty of {task}",
        lead=sentence,
        means=uncertainty_meaning(found),
        next="Compare U with the tolerance: a fifth of it or less is usual. To lower U, correct "
        "results with a model (`--model`), measure more visits, or another place of the machine.",
        key=_key(found),
        sections=[
            Section(sentences=[_MEASURAND.format(standard=standard)]),
            Section("Budget", table=budget_table(found)),
            Section(sentences=[as_sentence(line) for line in lines], notes=[_TERMS]),
            Section("Results by face"),
            *by_face,
            Section("Visits", table=visits, notes=[as_sentence(line) for line in remarks]),
        ],
    )
    write_page(Path(path), page)


def _key(found: Mapping[str, TaskUncertainty]) -> list[KeyFigure]:
    """U by what results are corrected with, and on how many visits it rests."""
    known = [
        KeyFigure(f"± {um(budget.U)}", f"U of results {name} and corrected by b (95 %)")
        for name, budget in found.items()
    ]
    visits = next(iter(found.values())).visits
    few = "" if visits >= FEW_VISITS else "fair"
    asked = f"ISO 15530-3 asks for {FEW_VISITS}"
    return [*known, KeyFigure(plural(visits, "visit"), asked, few)]


def _by_face(name: str, budget: TaskUncertainty) -> Section:
    rows = [
        [face, f"{mean / UM:+.2f}", f"{spread / UM:.2f}"] for face, mean, spread in budget.by_face
    ]
    caption = f"{name}: mean deviation of the places on a face, and their standard deviation, µm"
    return Section(table=Table(("face", "mean", "spread"), rows, caption))
