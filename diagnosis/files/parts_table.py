"""The three parts of a verdict, repeatability and promises, for the files of results."""

from typing import Any

import numpy as np

from matstd.diagnosis.accuracy import Promise, Repeatability, Scatter
from matstd.diagnosis.answer import NamedEffect, Remainder, VerdictParts
from matstd.twin.numbers import significant
from matstd.twin.units import UM


def parts_table(parts: VerdictParts) -> dict[str, Any]:
    """`geometry`, `named` and `remains` of diagnosis.json."""
    geometry = parts.geometry
    return {
        "geometry": {
            "scatter_um": um(geometry.left),
            "changed": [row.symbol for row in geometry.changed],
            "beyond_expected": [row.symbol for row in geometry.beyond],
            "description_hints": [hint.fault.value for hint in geometry.hints],
        },
        "named": [_named(one) for one in parts.named],
        "remains": _remains(parts.remains),
    }


def _named(one: NamedEffect) -> dict[str, Any]:
    """One named effect with its weight and its closest rival."""
    rival = one.runner_up
    return {
        "effect": one.effect.name,
        "explained_um": um(one.explained),
        "share": significant(one.share),
        "in_headline": one.is_headline,
        "runner_up": None if rival is None else rival.effect.name,
        "runner_up_log10_odds": None if rival is None else _log10(rival.log_odds),
        "unrecorded_drift_log10_odds": None
        if one.against_drift is None
        else _log10(one.against_drift),
    }


def _log10(log_odds: float) -> float:
    return significant(log_odds / float(np.log(10.0)))


def _remains(left: Remainder) -> dict[str, Any]:
    return {
        "is_real": left.is_real,
        "size_um": um(left.size),
        "share": significant(left.share),
        "scatter_um": um(left.scatter),
        "lack_of_fit_p": left.lack_of_fit,
        "depends_on": [list(pattern.variables) for pattern in left.patterns],
    }


def repeatability_table(found: Repeatability) -> dict[str, Any]:
    """Stated noise and what repeats show of it."""
    return {
        "stated_um": um(found.stated),
        "replicates": _scatter(found.replicates),
        "revisits": _scatter(found.revisits),
        "near_neighbours": _scatter(found.neighbours),
    }


def _scatter(found: Scatter | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {"scatter_um": um(found.size), "degrees_of_freedom": found.dof}


def promise_table(found: Promise) -> dict[str, Any]:
    """Errors to expect at the same touches and elsewhere."""
    return {
        "same_touches_um": um(found.same),
        "elsewhere_um": um(found.elsewhere),
        "domains": [{"domain": d.name, "ratio": significant(d.ratio)} for d in found.domains],
    }


def um(value: float | None) -> float | None:
    """A length in mm as a figure of a file in µm; None stays None."""
    return None if value is None else significant(value / UM)
