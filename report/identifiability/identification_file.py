"""identification.json: estimates, their uncertainties, and what cannot be determined."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matstd.diagnosis.accuracy import Proof
from matstd.diagnosis.fit import Estimable, Fit, estimable
from matstd.report.identifiability.identifiability_words import combination_words, freedom_words
from matstd.report.numbers import shown
from matstd.twin.files.whole import write_json
from matstd.twin.units import UM

FORMAT = "identification/1"


def identification_table(
    fit: Fit, known: Estimable, proofs: Sequence[Proof] = ()
) -> dict[str, Any]:
    """All of `identification.json`, with proofs on simulated machines if there are any."""
    units = [parameter.unit for _, parameter in fit.parameters]
    out: dict[str, Any] = {
        "format": FORMAT,
        "touches": int(fit.used.sum()),
        "gross_errors": [int(line) for line in fit.run.line[fit.gross.rows]],
        "rms_um": fit.rms / UM,
        "test_rms_um": fit.test_rms / UM,
        "noise_over_stated": fit.noise.factor,
        "parameters": known.found.parameters,
        "rank": known.found.rank,
        "effective_parameters": known.effective,
        "condition_number": known.found.condition_prior,
        "determined": [_value(d.name, d.value, d.u, d.unit) for d in known.determined],
        "combinations": [
            _value(
                combination_words(fit.names, units, c.weights, c.importance), c.value, c.u, c.unit
            )
            | {"prior_over_posterior": c.gain}
            for c in known.combinations
        ],
        "never_seen": [freedom_words(f, fit.model.chain) for f in known.freedoms],
    }
    if proofs:
        out["volumetric_error"] = [
            {
                "before_rms_um": p.rms_before / UM,
                "after_rms_um": p.rms_after / UM,
                "times_smaller": p.factor,
                "stated_u_rms_um": p.rms_u / UM,
                "within_2u": p.covered,
                "poses": len(p.before),
            }
            for p in proofs
        ]
    return out


def _value(name: str, value: float, u: float, unit: str) -> dict[str, Any]:
    label, factor = shown(unit)
    return {"name": name, "value": value / factor, "u": u / factor, "unit": label}


def write_identification(path: str | Path, fit: Fit, proofs: Sequence[Proof] = ()) -> Estimable:
    """Write identification.json, whole or not at all; returns what the fit determines."""
    known = estimable(fit)
    write_json(path, identification_table(fit, known, proofs))
    return known
