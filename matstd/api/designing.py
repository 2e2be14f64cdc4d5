"""A design project in Python: what `matstd design` and `matstd sensitivity` do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.twin.compute import Progress, one_blas_thread, silent

if TYPE_CHECKING:
    from matstd.artefact.brief import Brief
    from matstd.report.pages import Design
    from matstd.sensitivity.study import Study


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities:
    """A study of the random machines of a project.

    Example:
        >>> made = Project.read("project.toml").sensitivity("study")  # doctest: +SKIP
        >>> made.study.volumetric.recurrence.shape  # doctest: +SKIP
        (2000,)
    """

    study: Study  # sensitivities, maps, random machines
    remarks: tuple[str, ...]  # what could not be drawn
    folder: Path  # with the files

    def __repr__(self) -> str:
        study = self.study
        return (
            f"Sensitivities({len(study.q)} poses of {study.chain.name}, "
            f"{len(study.chain.symbols)} parameters, in {self.folder})"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Project:
    """What is designed, for which machine: a project file, checked and resolved.

    Example:
        >>> project = Project.read("project.toml")
        >>> project
        Project(project.toml: 6 faces, 13 balls, 480 + 110 touches on Mikron HSM 600U)
        >>> made = project.design("out")  # doctest: +SKIP
        >>> made.standard.patches[0].name  # doctest: +SKIP
        'FF1'
    """

    brief: Brief  # machine, probe, workshop, blank, expected errors and wishes, in base units

    @classmethod
    def read(
        cls,
        path: str | Path,
        control: str | None = None,
        montecarlo: Mapping[str, float] | None = None,
    ) -> Project:
        """Read a project file with its machine, its task and the bodies of its workshop.

        Args:
            path: Project file.
            control: Name of a control, or a dialect file, in place of the project's.
            montecarlo: Keys of `[montecarlo]` in place of those of the file.

        Raises:
            BadFile: File, key, what stood there, what was expected.
        """
        from matstd.artefact.brief import read_project
        from matstd.probe_paths.stations import dialects_of

        brief = read_project(path, montecarlo)
        if control:  # a file is seen from the working folder, not from the project
            own = str(Path(control).resolve())
            chosen = own if own.endswith(".toml") else control
            brief = replace(brief, programs=replace(brief.programs, control=chosen))
        dialects_of(brief)  # an unknown control is refused before any work
        return cls(brief)

    @one_blas_thread()
    def design(
        self,
        out: str | Path,
        force: bool = False,
        seed: int | None = None,
        progress: Progress = silent,
        scheduler: str | None = None,
        pdf: bool = False,
    ) -> Design:
        """Design a standard: sensitivities, standard, CAD files, programs, proof and report.

        Args:
            out: Folder of the results, which appears whole or not at all.
            force: Whether results of an earlier run may be replaced.
            seed: Of all random numbers; None for that of the project.
            progress: Called with stage, done and total.
            scheduler: Address of a Dask scheduler whose workers draw the random machines.
            pdf: Whether the report is printed into report.pdf too.

        Raises:
            BadFile: A standard that does not stand on its table, a clamp that stands in it.
            NotReachable: Travels that do not reach the standard, with the nearest wishes.
            NotBuildable: Limits that no standard meets, with the nearest wishes.
        """
        from matstd.api.saved import REPORT_FILES
        from matstd.compensation.field import MachineErrors
        from matstd.options import SHEET, SHEET_FILES, asked_printer, print_report
        from matstd.probe_paths.stations import feeds_of
        from matstd.report.pages import write_design_page
        from matstd.stages.design import design
        from matstd.stages.refusals import REFUSED_REACH, REFUSED_ROOM, refusals
        from matstd.stages.sheets import write_sheets
        from matstd.twin.beside import beside, kept_beside
        from matstd.twin.files import results_folder
        from matstd.workers import connected

        brief = self.brief if seed is None else replace(self.brief, seed=seed)
        printed_by = asked_printer(pdf)
        leftovers = (*REPORT_FILES, *SHEET_FILES)
        with (
            results_folder(out, force, leftovers, [REFUSED_REACH, REFUSED_ROOM]) as folder,
            refusals(brief, folder, out),
            connected(scheduler) as workers,
            kept_beside(),
        ):
            made = design(brief, folder, progress, workers)
            progress("report", 0, 1)
            raised, sheet = brief.programs.dry_run, folder / SHEET
            tried = MachineErrors.of_errors(brief.chain, made.machines[0].errors)
            given = made.stations, feeds_of(brief), printed_by, raised, tried
            with beside(write_sheets, sheet, *given) as written:
                remarks = write_design_page(made, folder)
                print_report(folder, printed_by)
                written()
        return replace(made, remarks=tuple(remarks), folder=Path(out))

    @one_blas_thread()
    def sensitivity(
        self,
        out: str | Path,
        poses: str | Path | None = None,
        force: bool = False,
        progress: Progress = silent,
        scheduler: str | None = None,
        pdf: bool = False,
    ) -> Sensitivities:
        """Study the random machines of the project: maps, shares, Monte Carlo, report.

        Args:
            out: Folder of the results, which appears whole or not at all.
            poses: Pose file; None for poses of the project's workspace.
            force: Whether results of an earlier run may be replaced.
            progress: Called with stage, done and total.
            scheduler: Address of a Dask scheduler whose workers draw the random machines.
            pdf: Whether the report is printed into report.pdf too.
        """
        from matstd.api.saved import REPORT_FILES, page_folder
        from matstd.stages.study_run import study_project
        from matstd.workers import connected

        with page_folder(out, pdf, force, REPORT_FILES) as folder, connected(scheduler) as workers:
            study, remarks = study_project(self.brief, poses, folder, progress, workers)
        return Sensitivities(study, tuple(remarks), Path(out))

    def __repr__(self) -> str:
        brief = self.brief
        wanted, choice = brief.options, brief.options.choice
        return (
            f"Project({brief.path}: {wanted.patches} faces, {wanted.balls} balls, "
            f"{choice.touches} + {choice.proof} touches on {brief.chain.name})"
        )
