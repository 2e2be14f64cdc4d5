"""The page of `matstd uncertainty`: budget, results by face, visits."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from matstd.artefact.body import Standard
from matstd.artefact.brief import Task
from matstd.diagnosis.task import TaskUncertainty, Visits
from matstd.report.layout import KeyFigure, Page, Section, Table, write_page
from matstd.report.numbers import plural, sentence, um
from matstd.report.task import FEW_VISITS, budget_rows, measured_sentence, task_lines
from matstd.report.verdict import uncertainty_meaning
from matstd.twin.display import Displayed
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


@dataclass(frozen=True, eq=False, repr=False)
class Budgets(Displayed):
    """Budgets of a measuring task, and the visits that they rest upon."""

    task: Task  # what is measured
    standard: Standard  # what was measured
    # budgets by what results are corrected with, `as measured` first
    found: Mapping[str, TaskUncertainty]
    visits: Visits  # what the visits found
    runs: tuple[tuple[str, int], ...]  # names of the visits with their numbers of touches
    remarks: tuple[str, ...]  # on the runs and the model

    @property
    def sentence(self) -> str:
        """How much was measured."""
        return measured_sentence(next(iter(self.found.values())))

    @property
    def lines(self) -> list[str]:
        """Sentences on the budgets."""
        return task_lines(self.found, self.task.tolerance, self.visits)


def write_uncertainty_page(path: str | Path, made: Budgets) -> None:
    """Write the page, and its tables beside it."""
    found = made.found
    by_face = [_by_face(name, budget) for name, budget in found.items()]
    visits = Table(("run", "touches"), [[f"`{name}`", str(n)] for name, n in made.runs])
    page = Page(
        heading=f"Uncertainty of {made.task.name}",
        lead=made.sentence,
        means=uncertainty_meaning(found),
        next="Compare U with the tolerance: a fifth of it or less is usual. To lower U, correct "
        "results with a model (`--model`), measure more visits, or another place of the machine.",
        key=_key(found),
        sections=[
            Section(sentences=[_MEASURAND.format(standard=made.standard.name)]),
            Section("Budget", table=budget_table(found)),
            Section(sentences=[sentence(line) for line in made.lines], notes=[_TERMS]),
            Section("Results by face"),
            *by_face,
            Section("Visits", table=visits, notes=[sentence(line) for line in made.remarks]),
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
