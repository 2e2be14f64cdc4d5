"""Budgets of a measuring task as sentences and as rows of a table."""

from collections.abc import Mapping

from matstd.diagnosis.task import LEVEL, TaskUncertainty, Visits, guarded
from matstd.report.numbers import digits, percent, plural, um
from matstd.twin.units import UM

FEW_VISITS = 10  # cycles that ISO 15530-3 asks for at least
FEW_DOF = 5.0  # degrees of freedom below which a quarter of U or more is due to its own uncertainty


def task_lines(
    budgets: Mapping[str, TaskUncertainty], tolerance: float | None, visits: Visits
) -> list[str]:
    """The budgets, the conformity limits of a tolerance (mm) and the limits of validity."""
    lines = [_budget_sentence(name, one) for name, one in budgets.items()]
    if tolerance is not None:
        lines += [decision_sentence(name, one, tolerance) for name, one in budgets.items()]
    one = next(iter(budgets.values()))
    if one.faces == 1:
        lines.append(
            "only one face: U holds for workpieces at its place and does not include how the "
            "errors of the machine differ elsewhere"
        )
    if one.poses == 1:
        lines.append(
            "only one table pose: U holds at this pose and does not include what turning the "
            "table changes"
        )
    if (few := min(budgets.values(), key=lambda b: b.dof)).dof < FEW_DOF:
        lines.append(
            f"{plural(one.faces, 'face')}, {plural(one.poses, 'table pose')} and "
            f"{one.visits} visits hardly determine how much the errors differ, so k is "
            f"{digits(few.k)}; more of them reduce U"
        )
    if one.visits < FEW_VISITS:
        lines.append(
            f"{one.visits} visits; ISO 15530-3 asks for {FEW_VISITS} or more on different days, "
            "with the standard clamped anew"
        )
    if one.u_w == 0.0:
        lines.append(
            "workpiece scatter is not included in U (u_w is 0): state form, roughness and "
            "expansion of the workpieces under [workpiece] in the task file"
        )
    if visits.lost:
        lines.append(f"{plural(visits.lost, 'place')} not measured in every visit: left out")
    if visits.gross:
        lines.append(f"{plural(visits.gross, 'place')} with a gross error in a visit: left out")
    return lines


def _budget_sentence(name: str, one: TaskUncertainty) -> str:
    """The expanded uncertainty with its contributions."""
    return (
        f"{name}: U = {um(one.U)} ({percent(LEVEL)}, k = {digits(one.k)}, "
        f"{digits(one.dof, 2)} degrees of freedom) for results corrected by b = "
        f"{one.bias / UM:+z.2f} µm, {um(one.U_uncorrected)} without this correction; u_cal "
        f"{um(one.u_cal)}, u_p {um(one.u_p)}, u_b {um(one.u_b)}, u_w {um(one.u_w)}"
    )


def decision_sentence(name: str, one: TaskUncertainty, tolerance: float) -> str:
    """Limits of conformity and nonconformity by the rule of ISO 14253-1."""
    zone = guarded(tolerance, one.u, one.dof)
    head = f"{name}, tolerance {um(tolerance)} (± {um(0.5 * tolerance)}): "
    beyond = f"nonconformity is proved beyond ± {um(zone.rejected)}"
    if zone.accepted <= 0.0:
        return f"{head}conformity cannot be proved, {beyond} (ISO 14253-1)"
    return (
        f"{head}conformity is proved for corrected deviations within ± {um(zone.accepted)}, "
        f"{beyond} (ISO 14253-1); {percent(zone.share)} of the tolerance remains"
    )


def budget_rows(budgets: Mapping[str, TaskUncertainty]) -> list[list[str]]:
    """Rows of the table of budgets: results, b, u_cal, u_p, u_b, u_w, k, dof, U twice; µm."""
    return [
        [
            name,
            f"{one.bias / UM:+z.2f}",
            *(digits(u / UM) for u in (one.u_cal, one.u_p, one.u_b, one.u_w)),
            digits(one.k),
            digits(one.dof, 2),
            digits(one.U / UM),
            digits(one.U_uncorrected / UM),
        ]
        for name, one in budgets.items()
    ]


def measured_sentence(one: TaskUncertainty) -> str:
    """The measurements on which a budget rests."""
    return (
        f"{one.places} places on {plural(one.faces, 'face')} at "
        f"{plural(one.poses, 'table pose')} in {one.visits} visits"
    )
