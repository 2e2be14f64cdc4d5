"""Standards: read, calibrated, drawn behind their touches; what visits to one say of a task."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from matstd.api.runs import Runs, is_learnt_from, listed, read_run
from matstd.api.saved import extended
from matstd.artefact import body
from matstd.artefact.body import Standard, write_standard
from matstd.artefact.brief import Task, read_task
from matstd.artefact.certify import (
    Allowed,
    CalibrationFit,
    check_places,
    farthest_off,
    fit_calibration,
    merged_orientations,
    read_cmm_points,
    with_verdicts,
)
from matstd.artefact.worth import Calibration as KnownPlaces
from matstd.cad_out.details import CALIBRATED
from matstd.diagnosis.files import SavedModel, check_machine, read_model, write_uncertainty
from matstd.diagnosis.fit import Prior
from matstd.effect_kinds import register_effects
from matstd.report.machine import drawing_triangles, standard_bodies, thinned
from matstd.report.pages import Budgets, write_uncertainty_page
from matstd.report.task import refusal_sentence
from matstd.report.words import remark_sentence
from matstd.stages import cmm
from matstd.stages.budgets import UNCORRECTED, budgets
from matstd.twin.display import Displayed
from matstd.twin.errors import BadArgument, DesignError, NotConforming
from matstd.twin.files import results_folder
from matstd.twin.frames import Array
from matstd.twin.model import Model
from matstd.twin.record import Run
from matstd.twin.units import UM

Probed = Standard | str | Path | None
"""A standard, the path of its file, or that of a drawing of the piece (STL, OBJ, PLY, STEP)."""

BESIDE = "standard.toml"
"""File that is taken where it lies beside the run and has the stamp of the run."""


def read_standard(path: str | Path) -> Standard:
    """A standard, as designed or as calibrated (docs/formats/standard.md).

    Raises:
        BadFile: File, key, what stood there, what was expected.

    Example:
        >>> standard = read_standard("standard.toml")
        >>> standard.known is None
        True
    """
    return body.read_standard(path)


def standard_of(standard: Standard | str | Path) -> Standard:
    """A standard, read where a path is given."""
    return standard if isinstance(standard, Standard) else read_standard(standard)


@dataclass(frozen=True, repr=False)
class Calibration(Displayed, CalibrationFit):
    """A calibrated standard and what its calibration found; `calibrate` returns it.

    Example:
        >>> found = calibrate("standard.toml", "cmm.csv")
        >>> found.save("calibrated.toml")
        >>> read_standard("calibrated.toml").known is None
        False
    """

    refusal: str = ""  # why the standard does not conform to its drawing; "" where it does

    def check(self) -> None:
        """Raise NotConforming where the standard does not conform to its drawing."""
        if self.refusal:
            raise NotConforming(self.refusal)

    def save(self, path: str | Path, cad: str | Path | None = None, force: bool = False) -> None:
        """Write the calibrated standard, whole or not at all.

        Args:
            path: Standard file.
            cad: Folder for STEP, STL, 3MF and glTF of the standard as it is; None for none.
            force: Replace files that the folder holds.

        Raises:
            DesignError: The folder is not empty.
        """
        if cad is not None:
            from matstd.cad_out.verify import export_standard  # the CAD kernel takes seconds

            with results_folder(cad, force) as place:
                export_standard(self.standard, place)
        write_standard(path, self.standard)


def calibrate(
    standard: Standard | str | Path,
    points: str | Path | Sequence[str | Path],
    *,
    u: float = 0.3 * UM,
    u_feature: float = 0.3 * UM,
    body_u: float = 0.5,
    u_scale: float = 1e-6,
    waviness: float = 0.5 * UM,
    accept: bool = False,
) -> Calibration:
    """The standard as a coordinate measuring machine (CMM) found it, judged by its drawing.

    Args:
        standard: As designed.
        points: File with the points of the CMM (docs/calibration.md), or one file for every
            orientation of the standard on its table.
        u: Standard uncertainty of one point, mm.
        u_feature: Of the place of a feature by what its points share (squareness and stylus of the
            CMM), as its certificate has it, mm.
        body_u: Standard uncertainty of the temperature of the standard while it was measured, K.
        u_scale: Relative standard uncertainty of the scales of the CMM, as its certificate has it.
        waviness: Assumed root mean square of short waves along a direction of a face that no dense
            line of points shows, mm.
        accept: Take a standard that does not conform to its drawing.

    Raises:
        BadFile: A file that cannot be read, points in other units or far from every feature.
        NotEnoughData: Too few points on a feature, or too few balls.
        NotConforming: The standard does not conform to its drawing.

    Example:
        >>> found = calibrate("standard.toml", "cmm.csv", u=0.5 * UM)
        >>> any(verdict.is_refused for verdict in found.verdicts)
        False
    """
    if not 0.0 <= waviness / UM <= 100.0:
        raise BadArgument("waviness_um", f"{waviness / UM:g}", "0 to 100 µm")
    for name, value in (("u_um", u), ("u_feature_um", u_feature)):
        if not 0.001 <= value / UM <= 100.0:
            raise BadArgument(name, f"{value / UM:g}", "an uncertainty from 0.001 to 100 µm")
    if not 0.0 <= body_u <= 20.0:
        raise BadArgument("body_u_K", f"{body_u:g}", "0 to 20 K")
    if not 0.0 <= u_scale <= 1e-3:
        raise BadArgument("scale_u_ppm", f"{1e6 * u_scale:g}", "0 to 1000 ppm")
    nominal = as_designed(standard)
    files = [points] if isinstance(points, str | Path) else list(points)
    read = [read_cmm_points(one, nominal) for one in files]
    measured, u_shared = merged_orientations(nominal, read, u, u_feature)
    found = fit_calibration(nominal, measured, u, u_shared, waviness)
    found, causes = with_verdicts(nominal, found, Allowed(CALIBRATED, u_shared, body_u, u_scale))
    refusal = ""
    if any(v.is_refused for v in found.verdicts):
        refusal = f"{', '.join(map(str, files))}: {refusal_sentence(found.verdicts, causes)}"
    out = extended(Calibration, found, refusal=refusal)
    if not accept:
        out.check()
    return out


def cmm_program(standard: Standard | str | Path, orientation: float = 0.0) -> str:
    """The DMIS program that takes the points of a calibration on a CMM.

    Args:
        standard: As designed.
        orientation: By which it is turned about z on the table of the CMM, degrees; the mean of
            four orientations is free of squareness and of differences of scales of the CMM.

    Raises:
        NotReachable: A feature that no stylus reaches.

    Example:
        >>> cmm_program("standard.toml").count("PTMEAS/") > 100
        True
    """
    return cmm.cmm_program(as_designed(standard), orientation)


def as_designed(standard: Standard | str | Path) -> Standard:
    """A standard that was not calibrated; raises DesignError for another."""
    nominal = standard_of(standard)
    if nominal.known is not None:
        name = nominal.name if isinstance(standard, Standard) else standard
        raise DesignError(
            f"{name}: calibrated with {nominal.known.source} already, expected the "
            "standard as designed"
        )
    return nominal


@dataclass(frozen=True, eq=False, repr=False)
class TaskBudget(Budgets):
    """Uncertainty of a measuring task; `uncertainty` returns it.

    Example:
        >>> found = uncertainty(["monday.csv", "friday.csv"], "standard.toml")
        >>> found.sentence
        '25 places on 4 faces at 4 table poses in 2 visits'
    """

    def save(self, path: str | Path) -> None:
        """Write the budgets as JSON, whole or not at all."""
        write_uncertainty(path, self.task.name, self.found, self.task.tolerance)

    def page(self, path: str | Path) -> None:
        """Write an HTML page, with its tables beside it."""
        write_uncertainty_page(path, self)


def uncertainty(
    runs: Runs,
    standard: Standard | str | Path,
    task: Task | str | Path | None = None,
    model: SavedModel | str | Path | None = None,
) -> TaskBudget:
    """Expanded uncertainty of a measuring task, from visits to calibrated faces (ISO 15530-3).

    Args:
        runs: Visits to one standard, two or more.
        standard: What was measured, calibrated or as designed.
        task: What is to be measured on workpieces; whatever was touched on the faces without it.
        model: Of an earlier run, with which results are corrected.

    Raises:
        BadFile: A file that cannot be read, or a run of another standard.
        NotEnoughData: Too few visits or places.

    Example:
        >>> found = uncertainty(["monday.csv", "friday.csv"], "standard.toml")
        >>> found.save("uncertainty.json")
    """
    register_effects()
    given = listed(runs)
    names = [f"run {i}" if isinstance(v, Run) else v for i, v in enumerate(given, start=1)]
    seen = [one if isinstance(one, Run) else read_run(one) for one in given]
    _check_visits(names, seen)
    piece = standard_of(standard)
    for name, one in zip(names, seen, strict=True):
        check_places(piece, one.touches, name)
    remarks = [f"{name}: {r}" for name, one in zip(names, seen, strict=True) for r in one.remarks]
    remarks += piece.remarks
    models: dict[str, tuple[Model, Prior] | None] = {UNCORRECTED: None}
    if model is not None:
        saved = model if isinstance(model, SavedModel) else read_model(model, runs=seen)
        called = saved.source.run if isinstance(model, SavedModel) else str(model)
        for one in seen:
            check_machine(saved, one.touches.chain, called)
        models[f"with {called}"] = saved.model, saved.estimates
        remarks += [remark_sentence(one) for one in saved.of_other_runs]
        remarks += [
            f"{called} has learnt from {name}: a visit proves more where it had no part in it"
            for name, one in zip(names, seen, strict=True)
            if is_learnt_from(saved, one)
        ]
    task = read_task(task) if isinstance(task, str | Path) else task or Task()
    found, visits = budgets(seen, piece, KnownPlaces(), task, models)
    sizes = tuple(zip(names, map(len, seen), strict=True))
    return TaskBudget(
        task=task, standard=piece, found=found, visits=visits, runs=sizes, remarks=tuple(remarks)
    )


def _check_visits(names: list[str], runs: list[Run]) -> None:
    """Refuse one measurement that is given twice; raises DesignError."""
    prints = [one.fingerprint for one in runs]
    for k, fingerprint in enumerate(prints):
        if fingerprint in prints[:k]:
            raise DesignError(
                f"{names[k]}: the same measurements as {names[prints.index(fingerprint)]}, "
                "expected every visit once"
            )


def probed_body(probed: Probed, runs: Runs, run: Run) -> tuple[Run, Array | None]:
    """The run, and triangles of what was probed, artefact frame, (T, 3, 3), mm; None for unknown.

    A run without a stamp is compared with the features of the standard, and remarks that nothing
    else ties them together.

    Args:
        probed: As the user states it; without it the file of the standard beside the run.

    Raises:
        BadFile: A file that is no standard and no drawing.
        DesignError: Another standard than the run was measured on.
    """
    if probed is None:
        standard = _beside(listed(runs), run)
        return run, None if standard is None else _triangles(standard)
    if not isinstance(probed, Standard) and Path(probed).suffix.lower() != ".toml":
        return run, thinned(drawing_triangles(Path(probed)))
    standard = probed if isinstance(probed, Standard) else read_standard(probed)
    name = standard.name if isinstance(probed, Standard) else probed
    if run.standard and standard.stamp != run.standard:
        raise DesignError(
            f"{name}: standard {standard.stamp}, expected that of the run, {run.standard}"
        )
    if not run.standard and run.touches.instrument.is_ball_on_standard:
        off = farthest_off(standard, run.touches, name)
        said = (
            f"the run has no stamp, so nothing ties it to standard {standard.stamp}: its "
            f"{len(run)} touches lie on the features that they name, within {off / UM:.0f} µm"
        )
        run = replace(run, remarks=(*run.remarks, said))
    return run, _triangles(standard)


def _triangles(standard: Standard) -> Array:
    return thinned(np.concatenate([corners for _, _, corners in standard_bodies(standard)]))


def _beside(given: Sequence[Run | str], run: Run) -> Standard | None:
    """The standard of a run whose file lies in the folder of the run."""
    for one in given:
        path = Path(one).parent / BESIDE if isinstance(one, str) else None
        if path is not None and run.standard and path.is_file():
            standard = read_standard(path)
            return standard if standard.stamp == run.standard else None
    return None
