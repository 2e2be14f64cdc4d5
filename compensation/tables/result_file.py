"""What tables correct and leave, as `compensation.json` ("compensation/1")."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from matstd.compensation.field import MachineErrors, Result
from matstd.compensation.tables.formats import VerifiedTables
from matstd.compensation.tables.header import Header
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.numbers import in_um, rms_length

FORMAT = "compensation/1"


def write_table_results(
    path: str | Path, errors: MachineErrors, head: Header, verified: Sequence[VerifiedTables]
) -> None:
    """Write the figures of every format, µm over the workspace, relative to the datum."""
    data = {
        "format": FORMAT,
        "model": head.model,
        "machine": head.machine,
        "datum": head.datum,
        "state": head.state,
        "not_of_the_machine": list(errors.left_out),
        "tables": [_table(p, errors.chain) for p in verified],
    }
    write_json(path, data)


def _table(verified: VerifiedTables, chain: Chain) -> dict[str, Any]:
    result = verified.result
    return {
        "control": verified.format,
        "files": list(verified.files),
        **figures(result),
        "interpolation_um": in_um(verified.interpolation),
        "interpolation_holds": "over the workspace" if verified.by_name else "along the axes",
        "left_out": list(verified.left_out),
        "not_held": [
            {
                "error": x.name,
                "before_um": in_um(x.before),
                "rms_um": in_um(x.rms),
                "u_um": in_um(x.u),
            }
            for x in result.left
        ],
        "acceptance": {
            "readings": _readings(chain, verified.acceptance.q),
            "without_um": [in_um(v) for v in verified.acceptance.without],
            "with_um": [in_um(v) for v in verified.acceptance.with_table],
            "wrong_sign_um": [in_um(v) for v in verified.acceptance.wrong_sign],
            "u_um": [in_um(v) for v in verified.acceptance.u],
        },
    }


def figures(result: Result) -> dict[str, Any]:
    """Before and after, with what the uncertainty of the model adds."""
    return {
        "poses": len(result.q),
        "before_rms_um": in_um(rms_length(result.before)),
        "before_worst_um": in_um(np.linalg.norm(result.before, axis=1).max()),
        "after_rms_um": in_um(rms_length(result.after)),
        "after_worst_um": in_um(np.linalg.norm(result.after, axis=1).max()),
        "model_u_um": in_um(result.u_rms),
        "tool_u_um": in_um(result.u_tool),
        "expected_rms_um": in_um(result.expected),
    }


def _readings(chain: Chain, q: Array) -> dict[str, float]:
    links = [chain.link(name) for name in chain.programmed_axes]
    values = [float(q[chain.axis_index(link.name)]) / link.unit for link in links]
    return {link.column: round(v, 4) + 0.0 for link, v in zip(links, values, strict=True)}
