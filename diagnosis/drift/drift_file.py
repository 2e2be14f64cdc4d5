"""Results of a comparison of drift laws as JSON, from which the chosen law is read again."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matstd.diagnosis.drift.constant import Constant
from matstd.diagnosis.drift.judged import Judged, JudgedLaws, Law
from matstd.diagnosis.drift.lags import Lagged
from matstd.diagnosis.drift.linear import LinearLaw
from matstd.diagnosis.drift.record import DriftRecord
from matstd.twin.errors import BadFile
from matstd.twin.files import read_text, write_whole
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.text import csv_text
from matstd.twin.versions import versions

FORMAT = "matstd-thermal/1"
SHOWN = {"mm": "um", "rad": "urad"}  # unit of a component in the file

_LAWS: dict[str, type] = {"linear": LinearLaw, "constant": Constant}


def write_drift(path: str | Path, found: JudgedLaws, said: Mapping[str, object]) -> None:
    """Write what every law leaves, and the chosen law with all that a prediction needs."""
    record, best = found.record, found.best
    names = [f"{c}_{SHOWN[u]}" for c, u in zip(record.components, record.units, strict=True)]
    data = {
        "format": FORMAT,
        **said,
        "laws": [
            {
                "name": j.name,
                "chosen": j is best,
                "one_step": _named(names, j.one_step / record.size),
                "left_out": _named(names, j.left_out / record.size),
                "free_run": _named(names, j.free_run / record.size),
                "free_run_with_noise": _named(names, j.noisy / record.size)
                if j.noisy is not None
                else None,
            }
            for j in found.judged
        ],
        "components": list(record.components),
        "units": list(record.units),
        "drives": list(record.drives),
        "step_s": record.step,
        "factor": best.factor.tolist(),
        "chosen": best.name,
        "law": _stated(best.law),
        "versions": versions(),
    }
    write_json(path, data)


def _named(names: Sequence[str], values: Array) -> dict[str, float] | None:
    """Values by component; nothing of a law that could not be judged."""
    if not np.isfinite(values).all():
        return None
    return {n: round(float(v), 6) for n, v in zip(names, values, strict=True)}


def _stated(law: Law) -> dict[str, Any]:
    """A law as tables of numbers."""
    kind = next(word for word, known in _LAWS.items() if isinstance(law, known))
    out: dict[str, Any] = {"kind": kind}
    for name, value in vars(law).items():
        if name == "inputs":
            out[name] = {"kind": "lagged", "places": value.places}
        elif name == "scale":  # of a constant column, which counts for nothing
            out[name] = [v if np.isfinite(v) else None for v in value.tolist()]
        else:
            out[name] = value.tolist() if isinstance(value, np.ndarray) else value
    return out


@dataclass(frozen=True, eq=False)
class SavedLaw:
    """The chosen law of an earlier comparison."""

    name: str
    law: Law
    factor: Array  # by which left-out blocks missed more than residual and leverage say, (K,)
    drives: tuple[str, ...]
    components: tuple[str, ...]
    units: tuple[str, ...]  # of each, "mm" or "rad"
    step: float  # of its rows, s

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
            law=_law(data["law"], path),
            factor=np.array(data["factor"], dtype=float),
            drives=tuple(data["drives"]),
            components=tuple(data["components"]),
            units=tuple(data["units"]),
            step=float(data["step_s"]),
        )
    except json.JSONDecodeError as error:
        raise BadFile(path, error.lineno, error.msg, "a thermal.json of ours") from None
    except (
        KeyError,
        TypeError,
        ValueError,
        OverflowError,
        AttributeError,
        RecursionError,
    ) as error:
        if isinstance(error, BadFile):
            raise
        raise BadFile(path, "law", repr(error)[:200], "a thermal.json as matstd wrote it") from None


def _law(data: dict[str, Any], path: str | Path) -> Law:
    """A law from its tables."""
    data = dict(data)
    kind = data.pop("kind")
    if kind not in _LAWS or ("inputs" in data and data["inputs"]["kind"] != "lagged"):
        found = f"a law of kind '{data['inputs']['kind'] if kind in _LAWS else kind}'"
        raise BadFile(path, "law", found, "a law of this version: learn it anew from the logs")
    if "inputs" in data:
        data["inputs"] = _inputs(data["inputs"]["places"], path)
    if "scale" in data:
        data["scale"] = [np.inf if v is None else v for v in data["scale"]]
    for name, value in data.items():
        if isinstance(value, list):
            data[name] = np.array(value, dtype=float)
    return _LAWS[kind](**data)


def _inputs(places: list[tuple[str, float]], path: str | Path) -> Lagged:
    """Drives with their time constants; raises BadFile for one that does not settle."""
    for _, tau in places:
        if not 0.0 <= tau < np.inf:
            found = f"a time constant of {tau:g} s: an unstable law"
            raise BadFile(path, "law", found, "time constants above zero")
    return Lagged(tuple((name, tau) for name, tau in places))


def write_prediction(path: str | Path, record: DriftRecord, predicted: Array, u: Array) -> None:
    """Write a predicted drift with its standard uncertainty as a table over time.

    Args:
        predicted: (N, K), base units.
        u: (N, K).
    """
    names = [f"{c}_{SHOWN[x]}" for c, x in zip(record.components, record.units, strict=True)]
    head = ["time_s", *names, *(f"u_{n}" for n in names)]
    each = zip(record.time, predicted / record.size, u / record.size, strict=True)
    rows = ([f"{t:.0f}", *(f"{v:.4f}" for v in (*row, *spread))] for t, row, spread in each)
    write_whole(path, csv_text(head, rows))
