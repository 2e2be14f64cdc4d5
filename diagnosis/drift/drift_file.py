"""Results of a comparison of drift laws as JSON, from which the chosen law is read again."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matstd.diagnosis.drift.arx import ArxInputs, coefficients
from matstd.diagnosis.drift.beams import Beam, BeamLaw
from matstd.diagnosis.drift.judged import Judged, Law
from matstd.diagnosis.drift.lags import Lagged
from matstd.diagnosis.drift.linear import Inputs, LinearLaw
from matstd.diagnosis.drift.network import Network
from matstd.diagnosis.drift.plain_laws import Constant
from matstd.diagnosis.drift.record import DriftRecord
from matstd.twin.errors import BadFile
from matstd.twin.files import read_text, write_whole
from matstd.twin.frames import Array
from matstd.twin.text import csv_text, json_text
from matstd.twin.versions import versions

FORMAT = "matstd-thermal/1"
SHOWN = {"mm": "um", "rad": "urad"}
"""Unit of a component in the file."""

_INPUTS: dict[str, type] = {"lagged": Lagged, "arx": ArxInputs}
_LAWS: dict[str, type] = {"linear": LinearLaw, "constant": Constant, "network": Network}


def write_drift(
    path: str | Path,
    record: DriftRecord,
    judged: Sequence[Judged],
    best: Judged,
    said: Mapping[str, object],
) -> None:
    """Write what every law leaves, and the chosen law with all that a prediction needs.

    Args:
        path: JSON.
        record: That was learnt from.
        judged: Every law.
        best: The chosen one.
        said: Of the hours, logs and probings.
    """
    names = [f"{c}_{SHOWN[u]}" for c, u in zip(record.components, record.units, strict=True)]
    data = {
        "format": FORMAT,
        **said,
        "laws": [
            {
                "name": j.name,
                "chosen": j is best,
                "unstable_pole": j.pole,
                "one_step": _named(names, j.one_step / record.size),
                "left_out": _named(names, j.left_out / record.size),
                "free_run": _named(names, j.free_run / record.size),
                "free_run_with_noise": _named(names, j.noisy / record.size)
                if j.noisy is not None
                else None,
            }
            for j in judged
        ],
        "arx": [_equation(j, record, names) for j in judged if _is_arx(j.law)],
        "components": list(record.components),
        "units": list(record.units),
        "drives": list(record.drives),
        "step_s": record.step,
        "factor": best.factor.tolist(),
        "chosen": best.name,
        "law": _stated(best.law),
        "versions": versions(),
    }
    write_whole(path, json_text(data))


def _named(names: Sequence[str], values: Array) -> dict[str, float] | None:
    """Values by component; nothing of a law that could not be judged."""
    if not np.isfinite(values).all():
        return None
    return {n: round(float(v), 6) for n, v in zip(names, values, strict=True)}


def _is_arx(law: Law) -> bool:
    return isinstance(law, LinearLaw) and isinstance(law.inputs, ArxInputs)


def _equation(judged: Judged, record: DriftRecord, names: Sequence[str]) -> dict[str, object]:
    """The ARX law as its equation is written, in the units of the components' names."""
    law = judged.law
    assert isinstance(law, LinearLaw)
    assert isinstance(law.inputs, ArxInputs)
    found = coefficients(law, record.step)
    return {
        "equation": "y(t) = constant + sum_i a_i y(t-i) + sum_jk b_jk T_j(t-k+1)",
        "step_s": record.step,
        "drives": list(law.inputs.drives),
        "poles": list(law.inputs.poles(record.step)),
        "time_constants_s": list(law.inputs.time_constants),
        "a": found.a.tolist(),
        "constant": dict(zip(names, (found.constant / record.size).tolist(), strict=True)),
        "b": {n: (found.b[..., k] / record.size[k]).tolist() for k, n in enumerate(names)},
    }


def _stated(law: Law) -> dict[str, Any]:
    """A law as tables of numbers."""
    if isinstance(law, BeamLaw):
        rest = None if law.rest is None else _stated(law.rest)
        beams = [b.model_dump() for b in law.beams]
        own = {"beams": beams, "rest": rest, "offset": law.offset.tolist()}
        return {"kind": "beams", **own, "residual": law.residual.tolist(), "memory": law.memory}
    kind = next(word for word, known in _LAWS.items() if isinstance(law, known))
    out: dict[str, Any] = {"kind": kind}
    for name, value in vars(law).items():
        if name == "inputs":
            word = next(w for w, known in _INPUTS.items() if isinstance(value, known))
            out[name] = {"kind": word, **vars(value)}
        elif name == "weights":
            out[name] = [[part.tolist() for part in member] for member in value]
        elif name == "scale":  # of a constant column, which counts for nothing
            out[name] = [v if np.isfinite(v) else None for v in value.tolist()]
        else:
            out[name] = value.tolist() if isinstance(value, np.ndarray) else value
    return out


@dataclass(frozen=True, eq=False)
class SavedLaw:
    """The chosen law of an earlier comparison.

    Attributes:
        name: Of the law.
        law: As it was fitted.
        factor: By which left-out blocks missed more than residual and leverage say, (K,).
        drives: That it wants in a log.
        components: That it predicts.
        units: Of each, "mm" or "rad".
        step: Of its rows, s.
    """

    name: str
    law: Law
    factor: Array
    drives: tuple[str, ...]
    components: tuple[str, ...]
    units: tuple[str, ...]
    step: float

    def judged(self) -> Judged:
        """As one of the laws of a comparison, nothing known of its errors but the factor."""
        nothing = np.full(len(self.components), np.nan)
        return Judged(
            name=self.name,
            law=self.law,
            one_step=nothing,
            left_out=nothing,
            free_run=nothing,
            noisy=None,
            factor=self.factor,
        )


def read_law(path: str | Path) -> SavedLaw:
    """The chosen law of a `thermal.json`.

    Raises:
        BadFile: No such file, one that has been changed so that no law can be made of it, or an
            unstable one.
    """
    try:
        data = json.loads(read_text(path))
        if data["format"] != FORMAT:
            raise BadFile(path, "format", repr(data["format"]), f"'{FORMAT}'")
        return SavedLaw(
            name=data["chosen"],
            law=_stable(_law(data["law"]), path),
            factor=np.array(data["factor"], dtype=float),
            drives=tuple(data["drives"]),
            components=tuple(data["components"]),
            units=tuple(data["units"]),
            step=float(data["step_s"]),
        )
    except json.JSONDecodeError as error:
        raise BadFile(path, f"line {error.lineno}", error.msg, "a thermal.json of ours") from None
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        if isinstance(error, BadFile):
            raise
        raise BadFile(path, "law", repr(error)[:200], "a thermal.json as matstd wrote it") from None


def _stable(law: Law, path: str | Path) -> Law:
    """A law whose poles lie inside the unit circle; raises BadFile."""
    inner = law.rest if isinstance(law, BeamLaw) else law
    inputs = getattr(inner, "inputs", None)
    taus = getattr(inputs, "time_constants", ()) or [t for _, t in getattr(inputs, "places", ())]
    for tau in taus:
        if not 0.0 <= tau < np.inf or (tau == 0.0 and hasattr(inputs, "time_constants")):
            found = f"a time constant of {tau:g} s: an unstable law"
            raise BadFile(path, "law", found, "time constants above zero")
    return law


def _law(data: dict[str, Any]) -> Law:
    """A law from its tables."""
    data = dict(data)
    kind = data.pop("kind")
    if kind == "beams":
        rest = None if data["rest"] is None else _law(data["rest"])
        assert rest is None or isinstance(rest, LinearLaw)
        beams = tuple(Beam.model_validate(b) for b in data["beams"])
        offset, residual = np.array(data["offset"]), np.array(data["residual"])
        return BeamLaw(
            beams=beams, rest=rest, offset=offset, residual=residual, memory=float(data["memory"])
        )
    if "inputs" in data:
        data["inputs"] = _inputs(dict(data["inputs"]))
    if "weights" in data:
        data["weights"] = tuple(tuple(np.array(p) for p in m) for m in data["weights"])
    if "scale" in data:
        data["scale"] = [np.inf if v is None else v for v in data["scale"]]
    for name, value in data.items():
        if isinstance(value, list):
            data[name] = tuple(value) if name == "drives" else np.array(value, dtype=float)
    return _LAWS[kind](**data)


def _inputs(data: dict[str, Any]) -> Inputs:
    known = _INPUTS[data.pop("kind")]
    own = {k: tuple(map(_pair, v)) if isinstance(v, list) else v for k, v in data.items()}
    return known(**own)


def _pair(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def write_prediction(path: str | Path, record: DriftRecord, predicted: Array, u: Array) -> None:
    """Write a predicted drift with its standard uncertainty as a table over time.

    Args:
        path: CSV.
        record: Whose rows were predicted.
        predicted: (N, K), base units.
        u: (N, K).
    """
    names = [f"{c}_{SHOWN[x]}" for c, x in zip(record.components, record.units, strict=True)]
    head = ["time_s", *names, *(f"u_{n}" for n in names)]
    each = zip(record.time, predicted / record.size, u / record.size, strict=True)
    rows = ([f"{t:.0f}", *(f"{v:.4f}" for v in (*row, *spread))] for t, row, spread in each)
    write_whole(path, csv_text(head, rows))
