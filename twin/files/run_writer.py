"""Writer of run files (CSV with a TOML head in comments, format "run/1")."""

import io
import json
from pathlib import Path

import numpy as np

from matstd.twin.errors import ShapeMismatch
from matstd.twin.files.pose_file import reading_columns
from matstd.twin.files.run_columns import FORCE, NORMAL, POINT, PROGRAM, RADIUS, TARGET
from matstd.twin.files.whole import write_whole
from matstd.twin.frames import Array, fixed_xyz_angles
from matstd.twin.record import BODY, Instrument, Run, Touches, implied_approach
from matstd.twin.text import csv_text, toml_value
from matstd.twin.units import DEG, UM


def write_run(path: str | Path, run: Run, machine: str) -> None:
    """Write a run file, whole or not at all; `read_run` gives the same measurements back.

    Args:
        run: Measurements with one stated uncertainty or one a row; their deviations are written as
            from the standard at 20 degC, for the reader to take its growth off.
        machine: Path of the machine file as it shall stand in the head (relative to `path`).
    """
    write_whole(path, run_text(run, machine))


def run_text(run: Run, machine: str) -> str:
    """Text of a run file."""
    t = run.touches
    common_u = bool(np.all(run.u == run.u[0]))
    out = io.StringIO()
    out.write('# format = "run/1"\n')
    out.write(f'# machine = "{machine}"\n')
    probe = (
        f"radius_mm = {float(t.radius[0])!r}, length_mm = {max(float(t.length[0]), 0.0) + 0.0!r}"
    )
    if t.offset[0].any() and not _has_targets(run):
        probe += f", offset_mm = {toml_value(t.offset[0].tolist())}"
    out.write(f"# probe = {{ {probe} }}\n")
    if t.instrument is not Instrument.TOUCH_PROBE:
        out.write(f'# instrument = "{t.instrument.value}"\n')
    if common_u:
        out.write(f"# u_um = {float(run.u[0]) / UM:.12g}\n")
    if run.date is not None:
        out.write(f"# date = {run.date.isoformat(timespec='seconds')}\n")
    if run.standard:
        out.write(f"# stamp = {json.dumps(run.standard, ensure_ascii=False)}\n")
    out.write(_body_line(t))
    for setup in t.setups:
        T = setup.T_table_artefact
        angles = np.round(fixed_xyz_angles(T[:3, :3]) / DEG, 10) + 0.0  # no minus before a zero
        out.write(f"# [setup.{setup.name}]\n")
        out.write(f"# origin_mm = [{', '.join(f'{v:.9f}' for v in T[:3, 3])}]\n")
        out.write(f"# rotation_deg = [{', '.join(f'{v:.10f}' for v in angles)}]\n")
        if setup.fixing is not None:
            out.write(f"# fixing_mm = {[float(v) for v in setup.fixing]}\n")
        if setup.run:
            out.write(f"# run = {json.dumps(setup.run, ensure_ascii=False)}\n")
    columns = _columns_out(run, common_u)
    return out.getvalue() + csv_text(columns, zip(*columns.values(), strict=True))


def _body_line(touches: Touches) -> str:
    """The size of the standard in the head, if stated; raises ShapeMismatch for several."""
    bodies = {s.body for s in touches.setups}
    body = bodies.pop()
    if bodies:
        raise ShapeMismatch("set-ups of several standards, expected a run file for each")
    if body is None:
        return ""
    line = f"expansion_1_K = {body.alpha!r}, expansion_u_1_K = {body.u_alpha!r}"
    if body.is_known and BODY not in touches.temperature:
        line += f", body_degC = {float(touches.body_temperature[0])!r}"
    line += f", body_u_K = {body.u_temperature!r}"
    if body.u_scale:
        line += f", scale_u_ppm = {float(f'{1e6 * body.u_scale:.12g}')!r}"
    return f"# standard = {{ {line} }}\n"


def _has_targets(run: Run) -> bool:
    """Whether every row states its target: there are several, or it stands behind the gauge point.

    No probe has a negative length, but the reflector of an arm may stand on either side.
    """
    t = run.touches
    return bool(np.any(t.target != t.target[0]) or np.any(t.length < 0.0))


def _cells(values: Array, digits: int) -> list[str]:
    return [f"{v:.{digits}f}" for v in values]


def _columns_out(run: Run, common_u: bool) -> dict[str, list[str]]:
    """Cells of every column."""
    t = run.touches
    columns: dict[str, list[str]] = {
        "feature": list(t.feature),
        "setup": [t.setups[i].name for i in t.setup],
        "pose": [str(i) for i in t.pose],
        "time_s": _cells(t.time, 3),
    }
    names = reading_columns(t.chain)
    for axis in t.chain.programmed_axes:
        column, factor = names[axis]
        columns[column] = _cells(
            t.q[:, t.chain.axis_index(axis)] / factor, 7 if factor == 1.0 else 9
        )
    columns |= {p: _cells(t.point[:, i], 7) for i, p in enumerate(POINT)}
    columns |= {n: _cells(t.normal[:, i], 12) for i, n in enumerate(NORMAL)}
    columns |= {f"dir{axis}": _cells(t.last_move(axis), 0) for axis in _stated_directions(run)}
    columns |= {f"T_{sensor}_degC": _cells(v, 3) for sensor, v in t.temperature.items()}
    columns |= {f"V_{name}": [f"{v:.9g}" for v in values] for name, values in t.value.items()}
    columns |= _optional_columns(run, common_u)
    # the deviation is in the readings, but only to their digits; instruments state it themselves
    columns["dev_um"] = _cells(run.raw_deviation / UM, 6)
    return columns


def _stated_directions(run: Run) -> list[str]:
    """Axes whose last motion the reader would not know: rotary ones, and of instruments others."""
    t = run.touches
    implied = implied_approach(t)
    differs = np.any(implied != t.approach, axis=0)
    return [a for i, a in enumerate(t.chain.axes) if a in t.chain.rotary_axes or differs[i]]


def _optional_columns(run: Run, common_u: bool) -> dict[str, list[str]]:
    """Cells of the columns that not every run has."""
    t = run.touches
    columns: dict[str, list[str]] = {}
    if _has_targets(run):
        columns |= {name: _cells(t.target[:, i], 6) for i, name in enumerate(TARGET)}
    if np.any(t.radius != t.radius[0]):
        columns[RADIUS] = _cells(t.radius, 6)
    if t.spindle_rpm is not None:
        columns["spindle_rpm"] = [f"{v:g}" for v in t.spindle_rpm]
    if t.force is not None:
        columns |= {name: [f"{v:g}" for v in t.force[:, i]] for i, name in enumerate(FORCE)}
    if not common_u:
        columns["u_um"] = [f"{v / UM:.12g}" for v in run.u]
    if run.repeat is not None:
        columns["repeat"] = [str(v) for v in run.repeat]
    recorded = {"split": run.split, **{name: getattr(run, name) for name in PROGRAM}}
    columns |= {
        name: [str(v) for v in values]
        for name, values in recorded.items()
        if np.any(values.astype(bool))
    }
    return columns
