"""Writer of model files ("model/2"): what a fit has learnt, for another day and another run."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from matstd.diagnosis.accuracy import Promise, promise
from matstd.diagnosis.files.curve_table import curve_entries
from matstd.diagnosis.files.determined import Determined, determined_text
from matstd.diagnosis.files.model_file import (
    FORMAT,
    SavedModel,
    parameter_keys,
    parsed_model,
    probes_of,
)
from matstd.diagnosis.fit import Fit, Learnt, Reported, inner_unit
from matstd.diagnosis.geometry import GeometryRow, standing, state_of_standing
from matstd.diagnosis.regression import Memory
from matstd.twin.frames import Array
from matstd.twin.library import owner_of
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, columns, inner_values
from matstd.twin.numbers import rms
from matstd.twin.units import UM


def model_text(
    fit: Fit,
    run_name: str,
    before: SavedModel | None = None,
    made_with: str = "",
    promised: Promise | None = None,
    reported: Mapping[str, Sequence[Reported]] | None = None,
    determined: Sequence[GeometryRow | Determined] = (),
    shares: Mapping[str, float] | None = None,
) -> str:
    """Text of a model file; set-ups of the standard stay with their run.

    Of several runs the machine is written as it is in the last one.

    Args:
        run_name: Name of the run file, for a later reader of the model.
        before: Model whose estimates the fit began with; None if it began with none.
        made_with: Name and version of the program, for the same reader.
        promised: Errors to expect of it as they were reported; None for those of the fit alone.
        reported: Sizes of effects as reported, by name.
        determined: Quantities that the run determines.
        shares: Shares of effects between which the run does not distinguish, by name.
    """
    import tomli_w

    learnt = Learnt.of(fit)
    L = state_of_standing(fit.model, len(fit.run.touches.runs) - 1)
    theta = L @ learnt.estimates.mean
    factors: list[float] = []
    entries = []
    for effect in standing(fit.model):
        keys = parameter_keys(effect)
        start = len(factors)
        entry: dict[str, Any] = {"name": effect.name}
        inner = _inner_values(fit, effect)
        if inner:
            entry["inner"] = inner
        if (share := (shares or {}).get(effect.name, 1.0)) < 1.0:
            entry["share"] = share
        values = theta[start : start + len(keys)]
        entry["estimate"] = {key: float(v) / f for (key, f), v in zip(keys, values, strict=True)}
        numbers = (reported or {}).get(effect.name, ())
        if numbers:
            entry["told"] = [_reported_entry(r) for r in numbers]
        if owner_of(effect) != "machine":
            entry["run"] = fit.run.fingerprint
            entry["share_um"] = _share(fit, effect, values) / UM
        factors += [factor for _, factor in keys]
        entries.append(entry)
    scale = np.array(factors)
    covariance = L @ learnt.covariance @ L.T
    shown = covariance / np.outer(scale, scale)
    curves = curve_entries(standing(fit.model), theta, covariance)
    tables = {
        "machine": _machine(fit.model.chain),
        "source": _source(fit, run_name, before, made_with, promised or promise(fit)),
        "effect": entries,
        **({"curve": curves} if curves else {}),
    }
    # top-level keys stand before tables in TOML, so the covariance goes before what it is about
    root = _root(L @ learnt.from_inner / scale[:, None])
    head = f'format = "{FORMAT}"\n{determined_text(determined)}{_triangle(shown)}{root}'
    return head + tomli_w.dumps(tables)


def model_of(fit: Fit) -> SavedModel:
    """What a model file would keep of a fit, without a file."""
    return parsed_model(model_text(fit, "run"), "model.toml", fit.model.effects)


def _source(
    fit: Fit, run_name: str, before: SavedModel | None, made_with: str, promised: Promise
) -> dict[str, Any]:
    """What the estimates rest upon."""
    earlier = before.source.learnt_from if before else []
    return {
        "run": run_name,
        "touches": int(fit.used.sum()),
        "noise_um": float(np.median(fit.u)) / UM,
        "gross_errors": [int(line) for line in fit.run.line[fit.gross.rows]],
        "revision": before.source.revision + 1 if before else 1,
        "learnt_from": [*earlier, *fit.run.fingerprints],
        "made_with": made_with,
        "held_out_um": float(promised.same) / UM,
        "elsewhere_um": float(promised.elsewhere) / UM,
        "held_out_gross_errors": [int(line) for line in fit.run.line[fit.gross_test_rows]],
        "probes": [list(probe) for probe in probes_of(fit.run.touches)],
        "machine_hash": fit.model.chain.fingerprint,
        **({} if fit.run.date is None else {"began": fit.run.date}),
        **({"standard": fit.run.standard} if fit.run.standard else {}),
        **({} if fit.memory is None else {"memory": _memory(fit.memory)}),
    }


def _share(fit: Fit, effect: Effect, theta: Array) -> float:
    """What an effect makes at the touches used that no set-up can take up, rms, mm."""
    touches = fit.run.touches[fit.used]
    moved = columns([effect], fit.run.touches)[fit.used] @ theta
    free = columns(fit.setups, touches)
    left = moved - free @ np.linalg.lstsq(free, moved, rcond=None)[0]
    return rms(left)


def _reported_entry(number: Reported) -> dict[str, Any]:
    """A number of an effect as reported."""
    u = {} if number.u is None else {"u": number.u}
    return {
        "quantity": number.quantity,
        "unit": number.unit,
        "value": number.value,
        **u,
        "role": number.role.value,
        "bound": number.bound,
    }


def _memory(memory: Memory) -> dict[str, Any]:
    """What the noise remembers, as in the file."""
    return {
        "correlation": memory.correlation,
        "step_s": memory.step,
        "by_place": memory.by_place,
        "is_filtered": memory.is_filtered,
    }


def _inner_values(fit: Fit, effect: Effect) -> dict[str, float]:
    """Inner parameters in the units of files."""
    out = {}
    for inner, value in inner_values(effect, fit.run.touches):
        suffix, factor = inner_unit(inner)
        out[f"{inner.name}{suffix}"] = value / factor
    return out


def _triangle(covariance: Array) -> str:
    """Lower triangle of a covariance as a TOML array, a line a row."""
    note = "# covariance of the estimates below: lower triangle, a row a parameter, their units\n"
    return note + _array("covariance", [row[: i + 1] for i, row in enumerate(covariance)])


def _root(root: Array) -> str:
    """The part of inner parameters as a TOML array; nothing where there is none."""
    if root.shape[1] == 0:
        return ""
    note = "# of it that of uncertain inner parameters: root times its transpose\n"
    return note + _array("from_inner", list(root))


def _array(key: str, rows: Sequence[Array]) -> str:
    lines = ("  [" + ", ".join(repr(float(v)) for v in row) + "]," for row in rows)
    return f"{key} = [\n" + "\n".join(lines) + "\n]\n"


def _machine(chain: Chain) -> dict[str, Any]:
    """A machine as in a machine file."""
    axes: dict[str, dict[str, Any]] = {}
    for link in chain.links:
        if link.kind == "fixed":
            continue
        axes[link.name] = {
            "range": [float(v) / link.unit for v in link.range],
            "point": [float(v) for v in link.point],
            "direction": [float(v) for v in link.direction],
        }
        for key, value in (("pitch", link.pitch), ("expected", link.expected)):
            if value is not None:
                axes[link.name][key] = value
    origin = [float(v) for v in chain.table_origin]
    return {
        "name": chain.name,
        "chain": chain.notation,
        "axis": axes,
        "workpiece": {"origin": origin},
    }
