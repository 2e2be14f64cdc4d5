"""The path of a scan as a table: every point with its normal and the readings that bring the ball.

A plain CSV for controls and programs that scan by a list of points. Lines run forth and back over
the face; a point that machine or probe cannot reach, or at which the probe above its ball comes
near anything, ends its line, so that a new number begins.
"""

from pathlib import Path

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.hidden.scan_lines import EDGE, Scan, can_be_scanned
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth import each_at
from matstd.twin.files import write_whole
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import DEG


def scan_path(
    face: FreeformPatch, scan: Scan, poses: Array, reach: ProbeReach, standard: Standard
) -> tuple[Requests, IntArray]:
    """Points of the lines at table poses (K, R), rad, in order, and the line of each, from 1."""
    a, b = (half - EDGE for half in face.half_size)
    across = np.linspace(-a, a, int(2.0 * a // scan.between) + 1)
    along = np.linspace(-b, b, int(2.0 * b // scan.pitch) + 1)
    uv = np.stack(np.meshgrid(across, along, indexing="ij"), axis=-1)
    uv[1::2] = uv[1::2, ::-1]
    grid = uv.reshape(-1, 2)
    line = np.repeat(np.arange(len(across)), len(along))
    parts, numbers, last = list[Requests](), list[IntArray](), 0
    for pose in poses:
        wanted = each_at(face, grid, pose[None])
        kept = np.flatnonzero(can_be_scanned(wanted, reach, standard))
        begins = (np.diff(kept, prepend=-2) > 1) | (np.diff(line[kept], prepend=-1) != 0)
        parts.append(wanted[kept])
        numbers.append(last + np.cumsum(begins))
        last += int(begins.sum())
    return joined(parts), np.concatenate(numbers)


def write_scan_path(
    path: Path, face: FreeformPatch, scan: Scan, poses: Array, reach: ProbeReach, standard: Standard
) -> int:
    """Write the path; returns its number of points."""
    points, line = scan_path(face, scan, poses, reach, standard)
    readings, chain = reach.readings(points), reach.chain
    unit = [1.0 if chain.link(name).kind == "linear" else DEG for name in chain.axes]
    names = [
        f"{name}_{'mm' if one == 1.0 else 'deg'}"
        for name, one in zip(chain.axes, unit, strict=True)
    ]
    head = ["line", "x_mm", "y_mm", "z_mm", "nx", "ny", "nz", *names]
    table = np.column_stack([points.point, points.normal, readings / unit])
    rows = [
        ",".join([str(number), *(f"{value + 0.0:.6f}" for value in row)])
        for number, row in zip(line.tolist(), table.tolist(), strict=True)
    ]
    comment = (
        f"# scan of {face.name}: contact points and normals in the artefact frame, readings with "
        f"the ball of {reach.radius:g} mm on them; feed {scan.feed:g} mm/min; come to the first "
        "point of a line, and leave its last, along the tool axis, which is free"
    )
    write_whole(path, "\n".join([comment, ",".join(head), *rows]) + "\n")
    return len(points)
