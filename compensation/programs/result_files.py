"""What a compensated program leaves: figures as JSON ("compensated-program/1"), points, shares."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.compensation.field import Share
from matstd.compensation.programs.compensation import Compensated
from matstd.twin.files import write_whole
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.numbers import in_um, rms, rms_length
from matstd.twin.record import Touches
from matstd.twin.text import csv_text
from matstd.twin.units import UM


def write_trajectory(path: str | Path, done: Compensated) -> None:
    """Write the table: lines, times, readings, what is added to them, nominal points, deviations.

    Lengths in mm, angles in degrees, additions and deviations in µm (µm of linear axes).
    """
    frame = done.program.frame
    chain = frame.chain
    links = [chain.link(a) for a in chain.programmed_axes]
    columns = [chain.axis_index(link.name) for link in links]
    names = ["line", "time_s", *(link.column for link in links)]
    names += [f"added_{a}_um" for a in "XYZ"] + [f"{c}_mm" for c in "xyz"]
    names += [f"{when}_d{c}_um" for when in ("before", "after") for c in "xyz"]
    names += ["between_um"]
    lines = np.array([m.line for m in done.program.motions])[done.motion]
    table = np.column_stack(
        [
            lines,
            done.elapsed,
            done.q[:, columns] / [link.unit for link in links],
            done.added[:, frame.linear] / UM,
            done.nominal,
            done.before / UM,
            done.after / UM,
            done.between / UM,
        ]
    )
    forms = ["%d", "%.3f", *["%.5f"] * len(links), *["%.3f"] * 3, *["%.5f"] * 3, *["%.3f"] * 7]
    rows = ([form % v for form, v in zip(forms, row, strict=True)] for row in table.tolist())
    write_whole(path, csv_text(names, rows))


def write_shares(path: str | Path, touches: Touches, whole: Array, shares: Sequence[Share]) -> None:
    """Write the table: readings, deviation of all errors together, then of each by itself, µm.

    Args:
        whole: Deviation of all together, (N, 3), mm.
    """
    chain = touches.chain
    links = [chain.link(a) for a in chain.programmed_axes]
    names = [link.column for link in links]
    readings = [touches.reading(link.name) / link.unit for link in links]
    fields = [("all", whole), *((s.name.replace(",", " "), s.field) for s in shares)]
    names += [f"{name}_d{c}_um" for name, _ in fields for c in "xyz"]
    table = np.column_stack([touches.time, *readings, *(field / UM for _, field in fields)])
    rows = (
        [f"{v:.5g}" if k > len(links) else f"{v:.5f}" for k, v in enumerate(row)] for row in table
    )
    write_whole(path, csv_text(["time_s", *names], rows))


FORMAT = "compensated-program/1"


def write_program_result(path: str | Path, done: Compensated) -> None:
    """Write its figures, µm."""
    ends = {"before": done.before[done.is_stated], "after": done.after[done.is_stated]}
    data = {
        "format": FORMAT,
        "program": done.program.path.name,
        "motions": len(done.program.motions),
        "lines": len(done.q),
        "seconds": round(float(done.elapsed[-1]), 3),
        "divided_for_um": in_um(done.tolerance),
        "at_line_ends": {
            key: {
                "rms_um": in_um(rms_length(v)),
                "worst_um": in_um(np.linalg.norm(v, axis=1).max()),
            }
            for key, v in ends.items()
        },
        "between_line_ends": {"worst_um": in_um(done.worst_between) if done.is_cut else None},
        "model_u_um": in_um(rms(done.u)),
        "tool_u_um": in_um(done.u_tool),
        "largest_correction_um": in_um(np.abs(done.added[:, done.program.frame.linear]).max()),
        "lines_left_as_they_are": list(done.unmoved),
    }
    write_json(path, data)
