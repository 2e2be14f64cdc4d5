"""Touches to be made, as tables with the columns of a run file; the next visit in `law.json`."""

from typing import Any

import numpy as np

from matstd.diagnosis.answer import Plan
from matstd.diagnosis.next_visit import RivalPower, VisitPlan
from matstd.twin.files import reading_columns
from matstd.twin.record import Touches
from matstd.twin.text import csv_text
from matstd.twin.units import UM


def planned(touches: Touches) -> list[dict[str, Any]]:
    """Touches to be made, with the columns of a run file."""
    names = reading_columns(touches.chain)
    out = []
    for i in range(len(touches)):
        row: dict[str, Any] = {
            "feature": str(touches.feature[i]),
            "setup": touches.setups[touches.setup[i]].name,
            "pose": int(touches.pose[i]),
            "time_s": round(float(touches.time[i]), 1),
        }
        for axis in touches.chain.programmed_axes:
            column, factor = names[axis]
            row[column] = round(float(touches.reading(axis)[i]) / factor, 6)
        row |= {f"p{c}_mm": round(float(touches.point[i, k]), 6) for k, c in enumerate("xyz")}
        row |= {f"n{c}": round(float(touches.normal[i, k]), 9) for k, c in enumerate("xyz")}
        row |= {f"dir{axis}": int(touches.last_move(axis)[i]) for axis in touches.chain.rotary_axes}
        out.append(row)
    return out


def plan_text(plan: Plan) -> str:
    """A plan as a table with the columns of a run file, for writing the program."""
    rows = planned(plan.touches)
    head = f"# to distinguish {plan.distinguishes[0]} from {plan.distinguishes[1]}\n"
    return head + csv_text(rows[0], (row.values() for row in rows))


def visit_table(plan: VisitPlan) -> dict[str, Any]:
    """What a visit distinguishes, and how it spends its time."""
    schedule, touches = plan.schedule, plan.touches
    time = np.zeros(1) if touches is None else touches.time
    return {
        "touches": 0 if touches is None else len(touches),
        "poses": 0 if touches is None else len(np.unique(touches.pose)),
        "duration_s": round(float(time[-1]), 1),
        "warm_up_s": schedule.warm_up if touches else 0.0,
        "pause_s": schedule.pause if touches else 0.0,
        "pause_after_touch": plan.pause_after,
        "slowness": schedule.slowness if touches else 1.0,
        "power": plan.power,
        "rivals": [_rival(one) for one in plan.rivals],
        "alike": [effect.name for effect in plan.alike],
        "refusal": plan.refusal.value if plan.refusal else None,
    }


def _rival(one: RivalPower) -> dict[str, Any]:
    return {
        "law": one.effect.name,
        "log_odds_against": one.log_odds,
        "separation": one.separation,
        "difference_um": one.difference / UM,
        "log_odds_expected": one.expected,
        "power": one.power,
        "is_unseen": one.is_unseen,
    }


def visit_text(plan: VisitPlan) -> str:
    """The touches in their order, the schedule in the first line; "" where none are planned."""
    if plan.touches is None or plan.law is None:
        return ""
    rows = planned(plan.touches)
    stop = "" if plan.pause_after is None else f" after touch {plan.pause_after}"
    head = (
        f"# to distinguish {plan.law.name} from its rivals; "
        f"warm_up_s = {plan.schedule.warm_up:g}, pause_s = {plan.schedule.pause:g}{stop}, "
        f"slowness = {plan.schedule.slowness:g}\n"
    )
    return head + csv_text(rows[0], (row.values() for row in rows))
