"""Every point of a compensated program as CSV: where it should be, where it is without and with."""

from pathlib import Path

import numpy as np

from matstd.compensation.programs.compensation import Compensated
from matstd.twin.files import write_whole
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
