"""What every error adds along some poses, as CSV."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.compensation.field import Share
from matstd.twin.files import write_whole
from matstd.twin.frames import Array
from matstd.twin.record import Touches
from matstd.twin.text import csv_text
from matstd.twin.units import UM


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
