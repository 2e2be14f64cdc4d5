"""law.json ("law/1"): laws that were learnt, for other programs."""

from typing import Any

import numpy as np

from matstd.diagnosis.files.plan_file import visit_table
from matstd.diagnosis.fit import file_unit
from matstd.diagnosis.laws import Estimate, Learning, LearntLaw, SecondRun, amplitudes, places
from matstd.diagnosis.next_visit import VisitPlan
from matstd.twin.laws import Law
from matstd.twin.units import DEG, UM

FORMAT = "law/1"

_PLACES = {"mm": ("mm", 1.0), "rad": ("deg", DEG), "s": ("s", 1.0)}
"""Unit of a parameter of a shape in files, and one of it in the base unit."""


def law_table(
    learning: Learning, run_name: str, visit: VisitPlan, second: SecondRun | None = None
) -> dict[str, Any]:
    """Everything of `law.json`, in the units that stand in its names."""
    fit, policy = learning.after, learning.policy
    table: dict[str, Any] = {
        "format": FORMAT,
        "run": run_name,
        "touches": len(fit.run),
        "noise_um": float(np.median(fit.u)) / UM,
        "stated_noise_um": float(np.median(fit.run.u)) / UM,
        "gross_errors": [int(line) for line in fit.run.line[fit.gross.rows]],
        "laws": [
            _law(learning, one, name)
            for one, name in zip(learning.laws, learning.effect_names, strict=True)
        ],
        "held_out": [
            {"blocks": h.what, "without_um": h.before / UM, "with_um": h.after / UM}
            for h in learning.held_out
        ],
        "next_visit": visit_table(visit),
        "policy": {name: getattr(policy, name) for name in policy.__dataclass_fields__},
    }
    if learning.refused is not None:
        refused = learning.refused
        table["refused"] = {
            "law": refused.law.name,
            "log_evidence": refused.score,
            "why": learning.refusal.value if learning.refusal else "",
        }
    if learning.instead_of:
        table["instead_of"] = _instead(learning)
    if second is not None:
        table["second_run"] = {
            "touches": second.touches,
            "without_um": second.without / UM,
            "with_um": second.learnt / UM,
            "with_kept_times_um": None if second.clocked is None else second.clocked / UM,
        }
    return table


def learnt_table(learning: Learning) -> dict[str, Any]:
    """The laws of a diagnosis, the leading numbers; `law.json` has all."""
    held_out = learning.held_out[0]
    instead = {"instead_of": _instead(learning)} if learning.instead_of else {}
    errors = {"without_um": held_out.before / UM, "with_um": held_out.after / UM}
    laws = zip(learning.laws, learning.effect_names, strict=True)
    return {"laws": [_brief(learning, one, name) for one, name in laws], **errors, **instead}


def _brief(learning: Learning, one: LearntLaw, effect: str) -> dict[str, Any]:
    """One law with its numbers and its nearest rival."""
    rival = one.second_choice
    whole = _law(learning, one, effect)
    keys = ("law", "effect", "formula", "carriers_alike", "amplitudes", "parameters")
    return {
        **{key: whole[key] for key in keys},
        "log_evidence": one.score,
        "second_choice": None if rival is None else rival.law.name,
        "second_choice_log_odds_against": None if rival is None else rival.log_odds,
    }


def _instead(learning: Learning) -> dict[str, Any]:
    """Effects of the library in whose place the laws stand."""
    return {
        "effects": [effect.name for effect in learning.instead_of],
        "log_odds_against": learning.instead_odds,
    }


def _law(learning: Learning, one: LearntLaw, effect: str) -> dict[str, Any]:
    policy = learning.policy
    return {
        "law": one.law.name,
        "effect": effect,
        "family": "*".join(f.shape.word for f in one.law.factors),
        "belongs_to": one.law.belongs_to,
        "carrier": one.law.carrier.name,
        "carriers_alike": [c.name for c in one.alike],
        "variables": [f.driver.name for f in one.law.factors],
        "formula": " times ".join(
            f"{f.shape.formula}, x = {f.driver.name}" for f in one.law.factors
        ),
        "amplitudes": [_amplitude(a) for a in amplitudes(learning, one.law)],
        "parameters": [_place(p) for p in places(learning, one.law)],
        "log_evidence": one.score,
        "log_evidence_of_curve": _finite(one.curve),
        "unrecorded_drift_log_odds_against": _finite(one.score - one.drift),
        "noise_with_memory_log_odds_against": _finite(one.score - one.memory),
        "library": None
        if one.library is None
        else {
            "effect": one.library.effect.name,
            "log_odds_against": one.library_odds,
        },
        "class": [{"law": law.name, "share": share} for law, share in one.members(policy)],
        "rivals": [
            {"law": r.law.name, "parameters": _plain(r.law), "log_odds_against": r.log_odds}
            for r in one.rivals[: policy.most_rivals]
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _plain(law: Law) -> dict[str, float]:
    """Parameters of a rival, base units."""
    return {name: float(value) for name, value in law.tuning.items()}


def _amplitude(one: Estimate) -> dict[str, Any]:
    suffix, factor = file_unit(one.unit)
    return {
        "name": one.name,
        "unit": "" if suffix == "1" else suffix,
        "value": one.value / factor,
        "u": None if one.u is None else one.u / factor,
    }


def _place(one: Estimate) -> dict[str, Any]:
    unit, factor = _PLACES.get(one.unit, (one.unit if one.unit != "1" else "", 1.0))
    return {
        "name": one.name,
        "unit": unit,
        "value": one.value / factor,
        "u": None if one.u is None else one.u / factor,
    }
