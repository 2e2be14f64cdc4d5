"""Budgets of a measuring task as sentences and as rows of a table."""

from collections.abc import Mapping
from typing import Any

from matstd.diagnosis.task import LEVEL, TaskUncertainty, Visits, guarded
from matstd.report.numbers import digits, percent
from matstd.twin.units import UM

FEW_VISITS = 10
"""Cycles that ISO 15530-3 asks for at least."""

FEW_DOF = 5.0
"""Degrees of freedom below which U owes a quarter of its size to what is not known of it."""


def task_lines(
    budgets: Mapping[str, TaskUncertainty], tolerance: float | None, visits: Visits
) -> list[str]:
    """The budgets, what they leave of a tolerance, and what has to be known of them.

    Args:
        budgets: By what results are corrected with.
        tolerance: Width of the zone, mm; None for none.
        visits: That they rest upon, for what was left out.
    """
    lines = [_budget_sentence(name, one) for name, one in budgets.items()]
    if tolerance is not None:
        lines += [decision_sentence(name, one, tolerance) for name, one in budgets.items()]
    one = next(iter(budgets.values()))
    if one.faces == 1:
        lines.append(
            "one face: U holds for workpieces where it stood; how the machine's errors differ "
            "elsewhere is not in it"
        )
    if one.poses == 1:
        lines.append("one table pose: U holds at it; what turning the table changes is not in it")
    if (few := min(budgets.values(), key=lambda b: b.dof)).dof < FEW_DOF:
        lines.append(
            f"{_count(one.faces, 'face')}, {_count(one.poses, 'table pose')} and {one.visits} "
            f"visits hardly tell how far errors differ, so k is {digits(few.k)}; more of them make "
            "U smaller"
        )
    if one.visits < FEW_VISITS:
        lines.append(
            f"{one.visits} visits; ISO 15530-3 asks for {FEW_VISITS} or more on different days, "
            "the standard clamped anew"
        )
    if one.u_w == 0.0:
        lines.append(
            "nothing is stated of the workpieces, u_w is 0: their form, roughness and expansion "
            "are not in U ([workpiece] of the task)"
        )
    if visits.lost:
        lines.append(f"{visits.lost} places that not every visit has were left out")
    if visits.gross:
        lines.append(f"{visits.gross} places with a gross error in some visit were left out")
    return lines


def _budget_sentence(name: str, one: TaskUncertainty) -> str:
    """The expanded uncertainty with everything that it is made of."""
    return (
        f"{name}: U = {_um(one.U)} ({percent(LEVEL)}, k = {digits(one.k)}, "
        f"{digits(one.dof, 2)} degrees of freedom) for results corrected by b = "
        f"{one.bias / UM:+z.2f} µm, {_um(one.U_uncorrected)} for others; u_cal {_um(one.u_cal)}, "
        f"u_p {_um(one.u_p)}, u_b {_um(one.u_b)}, u_w {_um(one.u_w)}"
    )


def decision_sentence(name: str, one: TaskUncertainty, tolerance: float) -> str:
    """What may be said of a workpiece by the rule of ISO 14253-1."""
    zone = guarded(tolerance, one.u, one.dof)
    told = f"{name}, tolerance {_um(tolerance)} (± {digits(0.5 * tolerance / UM)} µm): "
    beyond = f"beyond ± {_um(zone.rejected)} nonconformity"
    if zone.accepted <= 0.0:
        return f"{told}no deviation proves conformity, {beyond} (ISO 14253-1)"
    return (
        f"{told}corrected deviations within ± {_um(zone.accepted)} prove conformity, {beyond} "
        f"(ISO 14253-1); {percent(zone.share)} of the tolerance is left"
    )


def budget_rows(budgets: Mapping[str, TaskUncertainty]) -> list[dict[str, Any]]:
    """Rows of the table of budgets, µm."""
    return [
        {
            "name": name,
            "b": f"{one.bias / UM:+z.2f}",
            "u_cal": digits(one.u_cal / UM),
            "u_p": digits(one.u_p / UM),
            "u_b": digits(one.u_b / UM),
            "u_w": digits(one.u_w / UM),
            "k": digits(one.k),
            "dof": digits(one.dof, 2),
            "U": digits(one.U / UM),
            "U_uncorrected": digits(one.U_uncorrected / UM),
        }
        for name, one in budgets.items()
    ]


def measured_sentence(one: TaskUncertainty) -> str:
    """How much a budget rests upon."""
    return (
        f"{one.places} places on {_count(one.faces, 'face')} at {_count(one.poses, 'table pose')} "
        f"in {one.visits} visits"
    )


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _um(value: float) -> str:
    return f"{digits(value / UM)} µm"
