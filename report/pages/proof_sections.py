"""Sections of a design page on simulated machines: proof of the model, uncertainty of a task."""

from collections.abc import Sequence

from matstd.report.layout import Picture, Section, Table
from matstd.report.numbers import digits, percent, plural, sentence, um
from matstd.report.pages.design_result import Design, Proven
from matstd.report.pages.uncertainty_page import budget_table
from matstd.report.plots import draw_proof
from matstd.report.task import task_lines
from matstd.twin.units import UM

_PROOF = (
    "Random machines were drawn from the same error distributions, probed on the exact twin by the "
    "emitted programs with {noise} noise per touch, and identified from the resulting log alone. "
    "The prediction of each model was then compared with the true error of the machine at {poses} "
    "poses of your workspace and at {poses} of the probed volume, the box that the ball reaches on "
    "the standard. None of these poses was probed."
)
_PICTURE = (
    "Left: volumetric error at the poses of your workspace, without a model, and as the identified "
    "model fails to predict it. Right: the unpredicted error over its stated standard uncertainty."
)
_TASK = (
    "Task: {task}. Measurand: the deviation of a surface point from its nominal position, measured "
    "once, with the workpiece aligned by datum features. {places} places on {faces} calibrated "
    "faces at {poses} were probed on the twin of the first machine in {visits} visits (ISO "
    "15530-3). The true standard differs from its calibration within the stated uncertainty and is "
    "clamped anew for each visit; the model was identified from the balls alone."
)
_REAL = "For real runs: `matstd uncertainty RUN.csv … --standard standard.toml --model MODEL.toml`."


def worst_machine(machines: Sequence[Proven]) -> Proven:
    """The machine whose error in the workspace is predicted worst."""
    return max(machines, key=lambda m: m.in_workspace.rms_after)


def proof_sections(design: Design) -> list[Section]:
    """Volumetric error of random machines before and after, with its stated uncertainty."""
    rows = [
        [
            str(machine.seed + 1),
            where,
            digits(p.rms_before / UM),
            digits(p.rms_after / UM),
            digits(p.rms_u / UM),
            digits(p.factor, 2),
            percent(p.covered),
        ]
        for machine in design.machines
        for where, p in (("your workspace", machine.in_workspace), ("probed volume", machine.proof))
    ]
    columns = ("machine", "where", "volumetric error, µm rms", "not predicted, µm rms")
    more = ("stated uncertainty, µm rms", "ratio", "within twice the uncertainty")
    poses, noise = len(design.machines[0].proof.before), um(design.brief.noise)
    drawn = draw_proof([m.in_workspace for m in design.machines])
    return [
        Section(
            "Proof on simulated machines",
            sentences=[_PROOF.format(noise=noise, poses=poses)],
            table=Table((*columns, *more), rows),
            pictures=[Picture("proof.png", _PICTURE, drawn)],
        )
    ]


def task_sections(design: Design) -> list[Section]:
    """Uncertainty of the user's task on the first machine."""
    budgets, task = design.budgets, design.brief.task
    first = next(iter(budgets.values()))
    words = _TASK.format(
        task=task.name,
        places=first.places,
        faces=first.faces,
        poses=plural(first.poses, "table pose"),
        visits=first.visits,
    )
    lines = task_lines(budgets, task.tolerance, design.visits)[len(budgets) :]
    return [
        Section(
            "Uncertainty of a measuring task",
            sentences=[words],
            table=budget_table(budgets),
            notes=[*map(sentence, lines), _REAL],
        )
    ]
