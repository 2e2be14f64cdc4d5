"""diagnosis.json ("diagnosis/1") and comparison.json: results for other programs."""

from collections.abc import Sequence
from itertools import zip_longest
from typing import Any

import numpy as np

from matstd.diagnosis.answer import (
    Comparison,
    Detectable,
    Diagnosis,
    GroupResidual,
    Plan,
    RunErrors,
    Step,
    Trend,
)
from matstd.diagnosis.choice import Choice
from matstd.diagnosis.faults import DescriptionFault
from matstd.diagnosis.files.geometry_table import UNITS, geometry_table, number_table
from matstd.diagnosis.files.law_file import learnt_table
from matstd.diagnosis.files.parts_table import parts_table, promise_table, repeatability_table, um
from matstd.diagnosis.files.plan_file import planned
from matstd.diagnosis.fit import Fit, file_unit
from matstd.diagnosis.geometry import Estimate
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import Condition, Region, Side, Wrong
from matstd.twin.numbers import significant
from matstd.twin.units import UM, URAD

FORMAT = "diagnosis/1"
COMPARISON = "comparison/1"


def diagnosis_table(result: Diagnosis, remarks: Sequence[str] = ()) -> dict[str, Any]:
    """Everything of `diagnosis.json`, in the units that stand in its names."""
    choice = {} if result.choice is None else {"choice": choice_table(result.choice)}
    trend = {} if result.trend is None else {"trend": trend_table(result.trend)}
    laws = {} if result.laws is None else {"learnt": learnt_table(result.laws)}
    return {
        "format": FORMAT,
        "touches": len(result.run),
        "u_um": um(float(np.median(result.run.u))),
        "verdict": result.verdict.value,
        "headline": {
            "effects": [one.effect.name for one in result.parts.headline],
            "laws": [] if result.laws is None else [one.law.name for one in result.laws.laws],
            "withdrawn": [effect.name for effect in result.withdrawn],
        },
        "parts": parts_table(result.parts),
        "repeatability": repeatability_table(result.parts.repeatability),
        "promise": promise_table(result.promise),
        "promise_before": promise_table(result.promise_before),
        "policy": POLICY.table(),
        "steps": [_step(step) for step in result.steps],
        "candidates": [
            {
                "effect": c.effect,
                "kind": c.kind,
                "p_value": c.p_value,
                "rms_um": um(c.rms),
                "test_rms_um": um(c.test_rms),
            }
            for c in result.candidates
        ],
        "nearest": [
            {"effect": o.effect, "p_value": o.p_value, "test_rms_um": um(o.test_rms)}
            for o in result.nearest
        ],
        "repeat_lines": [int(line) for line in result.run.line[result.repeat]],
        "where": _where(result.where),
        "depends_on": [{"variable": d.variable, "p_value": d.p_value} for d in result.depends_on],
        "detectable": [_detectable(d) for d in result.detectable],
        "next_measurement": [_plan(p) for p in result.plans],
        "geometry": geometry_table(result.geometry),
        "description_faults": fault_table(result.faults),
        "remarks": list(remarks),
        **choice,
        **trend,
        **laws,
    }


def comparison_table(
    found: Comparison, structure: Sequence[str] = (), remarks: Sequence[str] = ()
) -> dict[str, Any]:
    """Everything of `comparison.json`, in the units that stand in its names.

    Args:
        structure: Sentences on what its residual varies with, in the order of `found.structure`.
    """
    worst = found.worst
    noise = found.fit.noise
    learnt = {} if found.learnt is None else {"learnt": _errors(found.learnt)}
    return {
        "format": COMPARISON,
        "touches": len(found.run),
        "u_um": um(float(np.median(found.run.u))),
        "measured_rms_um": um(found.rms_measured),
        "rms_um": um(found.rms),
        "chi2_ratio": significant(found.chi2_ratio),
        "worst": {
            "line": int(found.run.line[worst]),
            "residual_um": um(float(found.residual[worst])),
            "normalised": significant(float(found.normalised[worst])),
        },
        "replicates": None
        if noise.replicates is None
        else {
            "scatter_um": um(noise.replicates * float(np.median(found.run.u))),
            "degrees_of_freedom": noise.replicates_dof,
        },
        "repeatability": repeatability_table(found.repeatability),
        **({} if found.promise is None else {"promise": promise_table(found.promise)}),
        "expected_um": um(found.expected),
        "gross_errors": [int(line) for line in found.run.line[found.fit.gross.rows]],
        "where": _where(found.where),
        "depends_on": [
            {"variables": list(s.variables), "p_value": s.p_value} | ({"words": w} if w else {})
            for s, w in zip_longest(found.structure, structure)
        ],
        "poses": [_group(g) for g in found.poses],
        "features": [_group(g) for g in found.features],
        "geometry": geometry_table(found.geometry),
        "description_faults": fault_table(found.faults),
        "remarks": list(remarks),
        **learnt,
    }


def _errors(fit: Fit) -> dict[str, float | None]:
    """Figures by which a fit is judged."""
    return {
        "rms_um": um(fit.rms),
        "test_rms_um": um(fit.test_rms),
        "chi2_ratio": significant(fit.noise.chi2_ratio),
    }


def _step(step: Step) -> dict[str, Any]:
    """One step in which the error falls."""
    errors = _errors(step.fit)
    if step.effect is None:
        return {"effect": None, **errors}
    rivals = step.confusion.rivals if step.confusion else ()
    return {
        "effect": step.effect.name,
        "kind": step.effect.kind,
        "parameters": {r.name: significant(r.value) for r in step.reported},
        "uncertainty": {r.name: significant(r.u) for r in step.reported if r.u is not None},
        "p_value": step.p_value,
        **errors,
        "cannot_be_told_from": list(dict.fromkeys(r.effect.name for r in rivals)),
        **_alike(step),
    }


def _alike(step: Step) -> dict[str, Any]:
    """Periods that the targets cannot distinguish from that in `parameters`; nothing for most."""
    alike = step.confusion.alike if step.confusion else None
    if alike is None:
        return {}
    if alike.is_harmonic:
        return {"harmonics_alike": [significant(h) for h in alike.periods]}
    return {
        "periods_alike_mm": [significant(p) for p in alike.periods],
        "periods_beyond_mm": [significant(p) for p in alike.beyond],
        "step_mm": alike.step,
        "pitch_mm": alike.pitch,
    }


def choice_table(choice: Choice) -> dict[str, Any]:
    """Ways of choosing that were tried, each with its plain error of blocks left out."""
    return {
        "chosen": choice.best.name,
        "blocks": choice.blocks,
        "ways": [
            {
                "way": rule.name,
                "held_out_um": um(rule.error),
                "effects": [s.effect.name for s in rule.effects],
            }
            for rule in choice.rules
        ],
    }


def conditions_text(conditions: Sequence[Condition]) -> str:
    """Conditions as a file has them: `B_deg >= 60 and 0 <= time_s < 2400`."""
    parts = []
    for name in dict.fromkeys(c.variable for c in conditions):
        own = {c.side: c.bound for c in conditions if c.variable == name}
        if Side.IS in own:
            parts.append(f"{name} = {own[Side.IS]}")
        elif len(own) == 2:
            parts.append(f"{own[Side.FROM]:.6g} <= {name} < {own[Side.BELOW]:.6g}")
        else:
            parts += [f"{name} {side.value} {bound:.6g}" for side, bound in own.items()]
    return " and ".join(parts)


def _wrong(wrong: Wrong) -> dict[str, Any]:
    names = ("size_um", "uncertainty_um")
    if wrong.is_angular:
        names = ("size_urad", "uncertainty_urad")
    unit = URAD if wrong.is_angular else UM
    return {
        "carrier": wrong.carrier,
        names[0]: significant(wrong.size / unit),
        names[1]: significant(wrong.u / unit),
        "cannot_be_told_from": list(wrong.alike),
    }


def _where(found: Sequence[Region]) -> list[dict[str, Any]]:
    return [
        {
            "region": conditions_text(region.conditions),
            "error": None if region.wrong is None else _wrong(region.wrong),
            "mean_um": um(region.mean),
            "mean_u_um": um(region.u),
            "rms_um": um(region.rms),
            "touches": int(region.rows.sum()),
        }
        for region in found
    ]


def _detectable(found: Detectable) -> dict[str, Any]:
    """Smallest detectable size of one effect.

    A length has its size in `smallest_um`; any other parameter has its size in a key of its own
    unit, and in `smallest_um` the largest deviation of a touch that it then causes. Null where the
    model in use imitates the effect.
    """
    suffix, factor = file_unit(found.unit)
    own = None if found.size is None else significant(found.size / factor)
    scanned = {
        f"{s.quantity}_{s.unit}" if s.unit else s.quantity: [
            significant(s.low),
            significant(s.high),
        ]
        for s in found.scanned
    }
    where = {"scanned": scanned} if scanned else {}
    if suffix == "um":
        return {"effect": found.effect.name, "smallest_um": own, **where}
    largest = um(found.largest)
    return {"effect": found.effect.name, "smallest_um": largest, f"smallest_{suffix}": own, **where}


def _plan(plan: Plan) -> dict[str, Any]:
    """A plan of touches, each with the columns of a run file."""
    return {"tells_apart": list(plan.distinguishes), "touches": planned(plan.touches)}


def _group(group: GroupResidual) -> dict[str, Any]:
    return {
        "name": group.name,
        "touches": group.touches,
        "mean_um": um(group.mean),
        "rms_um": um(group.rms),
        "normalised_rms": significant(group.normalised),
    }


def fault_table(faults: Sequence[DescriptionFault]) -> list[dict[str, Any]]:
    """Every mistake with its numbers and what undoing it does; lengths in mm, angles in rad."""
    return [_fault(f) | {"cannot_be_told_from": [_fault(a) for a in f.alike]} for f in faults]


def _fault(fault: DescriptionFault) -> dict[str, Any]:
    return {
        "mistake": fault.fault.value,
        "axes": list(fault.axes),
        "chain": fault.notation or None,
        "numbers": [number_table(n) for n in fault.numbers],
        "log_odds": significant(fault.log_odds),
        "test_rms_um": [significant(v / UM) for v in fault.test_rms],
        "errors_over_expected": [significant(v) for v in fault.widened],
    }


def trend_table(trend: Trend) -> dict[str, Any]:
    """Every run with its errors, and every quantity of the geometry run by run."""
    return {
        "runs": [_run(run, i in trend.changed) for i, run in enumerate(trend.runs)],
        "quantities": [_row(trend, k) for k, row in enumerate(trend.rows) if any(row.course)],
    }


def _run(run: RunErrors, has_changed: bool) -> dict[str, Any]:
    return {
        "run": run.name,
        "touches": run.touches,
        "is_held_out": run.is_held_out,
        "has_changed": has_changed,
        "rms_um": um(run.rms),
        "test_rms_um": um(run.test_rms),
        "left_out_rms_um": um(run.left_out),
    }


def _row(trend: Trend, k: int) -> dict[str, Any]:
    """One quantity; what a run does not determine is null."""
    row, later = trend.rows[k], range(1, len(trend.runs))
    suffix, factor = UNITS[row.unit]
    best = {i: trend.known_best(i)[k] for i in later}
    changes = [None, *(best[i].steps[i - 1] for i in later)]
    return {
        "quantity": row.quantity.value,
        "symbol": row.symbol,
        "axes": list(row.axes),
        f"value_{suffix}": [_number(e, factor) for e in row.course],
        f"value_uncertainty_{suffix}": [_u(e, factor) for e in row.course],
        f"change_{suffix}": [_number(e, factor) for e in changes],
        f"change_uncertainty_{suffix}": [_u(e, factor) for e in changes],
        "has_changed_into": [trend.runs[i].name for i in later if best[i].has_changed_into(i)],
    }


def _number(estimate: Estimate | None, factor: float) -> float | None:
    return None if estimate is None else significant(estimate.value / factor)


def _u(estimate: Estimate | None, factor: float) -> float | None:
    return None if estimate is None else significant(estimate.u / factor)
