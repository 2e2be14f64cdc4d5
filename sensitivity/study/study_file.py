"""A study as files: tables, sections, and the figures of the Monte Carlo with their precision."""

from pathlib import Path
from typing import Any

import numpy as np

from matstd.sensitivity.study.machine_study import Study, pose_columns, statistics_columns
from matstd.twin.files import write_whole, written_whole
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.text import csv_text
from matstd.twin.units import UM, URAD


def write_study(study: Study, folder: str | Path, statement: str) -> None:
    """Write the data of a study into a folder; `matstd.report.maps.study_maps.draw_maps` draws it.

    `poses.csv` (readings and statistics of the volumetric error with their standard errors by
    sampling), `sensitivity.csv` (S a column a parameter), `shares.csv` (of the variance of the
    deviation), `total_effects.csv` (on the length |d|, by simulation), `trajectory.csv`,
    `sections.npz`, and `montecarlo.json`: draws, seed and precision with the figures over the
    workspace.

    Args:
        folder: Made where it does not exist; files in it are replaced.
        statement: The sampling in one sentence, kept beside its figures.
    """
    folder, symbols = Path(folder), study.chain.symbols
    readings = pose_columns(study.chain, study.q)
    table = readings | statistics_columns(study.volumetric, study.closed)
    write_whole(folder / "poses.csv", _table_text(table))
    unit = [URAD / UM if s.is_angular else 1.0 for s in symbols]
    S = {s.name: study.sensitivity[:, i] * unit[i] for i, s in enumerate(symbols)}
    write_whole(folder / "sensitivity.csv", _table_text(readings | S))
    shares = {s.name: study.shares[:, i] for i, s in enumerate(symbols)}
    write_whole(folder / "shares.csv", _table_text(readings | shares))
    if study.total:
        some = {name: column[: study.total.total.shape[1]] for name, column in readings.items()}
        for i, s in enumerate(symbols):
            some |= {s.name: study.total.total[i], f"{s.name}_u": study.total.u[i]}
        write_whole(folder / "total_effects.csv", _table_text(some))
    if study.path:
        way = study.path.trajectory
        table = {"share_of_way": way.along} | pose_columns(study.chain, way.q)
        table |= statistics_columns(study.path.volumetric, study.path.closed)
        table |= {f"errors_of_{e.axis}_um": e.size / UM for e in study.path.effects}
        write_whole(folder / "trajectory.csv", _table_text(table))
    _write_sections(study, folder / "sections.npz")
    write_json(folder / "montecarlo.json", _summary(study, statement))


def _summary(study: Study, statement: str) -> dict[str, Any]:
    """Draws, seed, precision, and the figures over the workspace."""
    v, s = study.volumetric, study.volumetric.stability
    worst = pose_columns(study.chain, study.worst_pose[None])
    stability = s and {
        "digits": s.digits,
        "is_stable": s.is_stable,
        "batches": s.batches,
        "over_tolerance": s.ratio,
    }
    out: dict[str, Any] = {
        "format": "montecarlo/1",
        "statement": statement,
        "draws": v.draws,
        "seed": v.seed,
        "achieved_um": v.achieved / UM,
        "stability": stability,
        "poses": len(study.q),
        "worst_pose": {column: float(values[0]) for column, values in worst.items()},
        "mean_um": _over(v.mean / UM),
        "sd_um": _over(v.sd / UM),
    }
    for i, level in enumerate(v.levels):
        out[f"p{100 * level:g}_um"] = _over(v.quantile[i] / UM)
    if np.isfinite(v.tolerance):
        out |= {"tolerance_um": v.tolerance / UM, "exceedance": _over(v.exceedance)}
    out["share_of_variance"] = dict(study.ranking())
    if study.total:
        names = [symbol.name for symbol in study.chain.symbols]
        # poses share the machines, so averaging over them does not reduce this uncertainty
        u = np.sqrt((study.total.u**2).mean(axis=1))
        out["total_effect_on_length"] = {
            "machines": study.total.machines,
            "seed": study.total.seed,
            "poses": study.total.total.shape[1],
            "mean": dict(zip(names, study.total.total.mean(axis=1).tolist(), strict=True)),
            "u_at_one_pose": dict(zip(names, u.tolist(), strict=True)),
        }
    mean_off, worst_off = study.tail
    out["p95_against_normal"] = {"mean": mean_off, "worst": worst_off}
    out["first_order_against_exact_um"] = study.exact.rms / UM
    return out


def _over(values: Array) -> dict[str, float]:
    """A statistic over the poses."""
    return {"mean": float(values.mean()), "worst": float(values.max())}


def _write_sections(study: Study, path: Path) -> None:
    """Sections as arrays: readings in mm and rad, deviations in mm."""
    arrays: dict[str, Array] = {}
    for s in study.sections:
        n = len(s.first)
        name = "".join(s.axes)
        arrays |= {
            f"{name}_first": s.first,
            f"{name}_second": s.second,
            f"{name}_mean": s.volumetric.mean.reshape(n, n),
            f"{name}_p95": s.volumetric.p95.reshape(n, n),
            f"{name}_recurrence": s.volumetric.recurrence.reshape(n, n),
        }
    with written_whole(path) as part, part.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)


def _table_text(table: dict[str, Array]) -> str:
    """Columns of numbers as CSV with seven digits."""
    rows = np.stack(list(table.values()), axis=1)
    return csv_text(table, ([f"{v:.7g}" for v in row] for row in rows))
