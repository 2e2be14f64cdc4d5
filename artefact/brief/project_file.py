"""Project file (TOML, format "project/1"): the standard and its machine."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

from pydantic import Field

from matstd.artefact.brief.brief import Brief, StudySettings
from matstd.artefact.brief.contradictions import (
    Faults,
    as_written,
    body_faults,
    design_machine,
    material_faults,
    standard_faults,
    table_key,
)
from matstd.artefact.brief.errors_table import ErrorsTable, amplitude_slips, expected_errors
from matstd.artefact.brief.standard_tables import (
    BlankTable,
    LimitsTable,
    MaterialTable,
    ScanTable,
    StandardTable,
    workspace_ranges,
)
from matstd.artefact.brief.task_file import Task, read_task
from matstd.artefact.brief.workshop_tables import (
    ProbeTable,
    TableTable,
    WorkshopTable,
    check_workshop,
    checked_probe,
    checked_probes,
)
from matstd.artefact.reach import Body, Solid, round_table
from matstd.artefact.seat import middle_room
from matstd.artefact.tool import Probe
from matstd.artefact.worth import Calibration
from matstd.sensitivity.montecarlo import MACHINES_A_BATCH
from matstd.twin.errors import BadFile
from matstd.twin.files import SetupTable, Table, checked, read_toml, refuse_unit_slips
from matstd.twin.machine import Chain
from matstd.twin.record import Setup
from matstd.twin.text import toml_value
from matstd.twin.units import DEG, UM, URAD, doubtful_length

RENAMED_KEYS = {
    "standard.drawn_machines": "standard.robust_machines",
    "standard.worst_share": "standard.robust_share",
    "standard.material": "material.name",
    "standard.density_kg_m3": "material.density_kg_m3",
    "standard.expansion_per_K": "material.expansion_1_K",
}
"""Present keys by keys of older files, which are still accepted."""


class MonteCarloTable(Table):
    """`[montecarlo]`: number of random machines, and when to stop."""

    draws: int = Field(default=2000, ge=100)
    """number of random machines; with `digits` the largest number, 20480 or more"""
    digits: int = Field(default=0, ge=0, le=3)
    """draw until so many digits of the standard deviation are stable at every pose (JCGM 101,
    7.9.4); 0 for exactly `draws`"""
    tolerance_um: float = Field(default=float("inf"), gt=0.0, examples=[100.0])
    """permissible volumetric error; the share of machines beyond it is reported at every pose"""


class CalibrationTable(Table):
    """`[calibration]`: standard uncertainties of place, rotations and form."""

    patch_um: float = Field(default=1.0, ge=0.0, le=100.0)
    """uncertainty of every coordinate of a freeform face"""
    patch_urad: float = Field(default=10.0, ge=0.0, le=1000.0)
    """uncertainty of every rotation of a freeform face"""
    ball_um: float = Field(default=0.3, ge=0.0, le=100.0)
    """uncertainty of every coordinate of a ball centre"""
    scale_ppm: float = Field(default=1.0, ge=0.0, le=1000.0)
    """uncertainty of all lengths, one error that all features share: scales and temperature of the
    CMM; it enters the proof on the twin and the fits of its runs"""
    form_um: float = Field(default=0.3, ge=0.0)
    """uncertainty of the surface of a freeform face at a point, alike over 6 mm; counts where
    families of features are compared"""

    def calibration(self) -> Calibration:
        """In base units."""
        return Calibration(
            patch=self.patch_um * UM,
            patch_tilt=self.patch_urad * URAD,
            ball=self.ball_um * UM,
            scale=self.scale_ppm * 1e-6,
            form=self.form_um * UM,
        )


class SimulationTable(Table):
    """`[simulation]`: the proof on the twin."""

    noise_um: float = Field(default=1.0, gt=0.0, le=100.0)
    """standard deviation of one simulated touch"""
    machines: int = Field(default=3, ge=1, le=50)
    """number of random machines that are probed and identified"""
    visits: int = Field(default=10, ge=2, le=50)
    """number of times that the first of them probes the standard, clamped anew, for the
    uncertainty of the task"""
    body_degC: float = Field(default=22.0, ge=0.0, le=50.0)  # noqa: N815
    """temperature of the standard in this proof, as its thermometer reads; runs state it, and the
    growth is corrected"""
    body_u_K: float = Field(default=0.3, ge=0.0, le=20.0)  # noqa: N815
    """standard uncertainty of that reading. The piece is at another temperature at random, and
    differs from its stated expansion and scale by their uncertainties"""


class ProjectTable(Table):
    """The whole file."""

    format: str = Field(examples=["project/1"])
    """kind and version of the file, `"project/1"`"""
    machine: str = Field(examples=["machine.toml"])
    """path of the machine file, relative to this file"""
    seed: int = Field(ge=0, examples=[1])
    """seed of all random numbers; the same seed gives the same poses, features and touches (their
    order within a visit may differ from one kind of processor to another)"""
    confirmed: list[str] = Field(default_factory=list, examples=[["probe.length_mm"]])
    """keys of this file whose values look like a mistake and are meant, such as a probe of 30 mm;
    they are not asked about"""
    control: str = "itnc530"
    """control of the programs: a name, or a [dialect file](dialect.md), relative to this file"""
    task: str | None = Field(default=None, examples=["task.toml"])
    """a [task file](task.md), relative to this file: a measuring task on workpieces, whose
    uncertainty is evaluated on the twin"""
    probe: ProbeTable
    """the touch probe in the spindle"""
    workshop: WorkshopTable = WorkshopTable()
    """surroundings of the standard, and the control"""
    workspace: dict[str, object] = Field(default_factory=dict)
    """readings of interest"""
    montecarlo: MonteCarloTable = MonteCarloTable()
    """random machines of the maps"""
    errors: ErrorsTable = ErrorsTable()
    """expected errors of the machine"""
    standard: StandardTable = StandardTable()
    """the standard to be designed"""
    material: MaterialTable = MaterialTable()
    """its material"""
    blank: BlankTable = BlankTable()
    """its blank"""
    limits: LimitsTable = LimitsTable()
    """limits of workshop, probe and table"""
    setup: dict[str, SetupTable] = Field(default_factory=lambda: {"a": SetupTable()})
    """position of the standard on the table, as in a [run](measurements.md#run). It is designed
    for the first set-up. In every further one the same positions are touched again, at those table
    poses of the first at which they are reachable"""
    scan: ScanTable | None = None
    """how the control scans a wavy face; without it faces are touched"""
    calibration: CalibrationTable = CalibrationTable()
    """expected uncertainties of the features of the standard"""
    simulation: SimulationTable = SimulationTable()
    """the virtual test"""


def read_project(path: str | Path, montecarlo: Mapping[str, float] | None = None) -> Brief:
    """Read a project with its machine, its task and the bodies of its workshop.

    Args:
        montecarlo: Keys of `[montecarlo]` that replace those of the file.

    Raises:
        BadFile: File, key, what stood there, what was expected.
    """
    path = Path(path)
    data = read_toml(path, "project/1")
    renamed = _rename_keys(data)
    if montecarlo and isinstance(data.setdefault("montecarlo", {}), dict):
        data["montecarlo"] |= montecarlo
    remarks = [f"{path}: {old} is now called {new} and was read as such" for new, old in renamed]
    try:
        table = checked(ProjectTable, data, path)
        # first: a number in a wrong unit also contradicts other keys
        refuse_unit_slips(table, path, _doubtful_probes(table, path), table.confirmed)
        return _resolved(table, path, tuple(remarks))
    except BadFile as error:
        raise as_written(error, dict(renamed)) from error


def _doubtful_probes(table: ProjectTable, path: Path) -> Iterator[BadFile]:
    """Probes of a length that is usual in another unit."""
    further = {f"workshop.probes.{i}": probe for i, probe in enumerate(table.workshop.probes)}
    for key, probe in {"probe": table.probe, **further}.items():
        length = probe.length_mm
        if length is not None and (question := doubtful_length(length)) is not None:
            yield BadFile(path, f"{key}.length_mm", f"{length:g}", f"mm; {question}")


def _resolved(table: ProjectTable, path: Path, remarks: tuple[str, ...]) -> Brief:
    """The project in base units; raises BadFile with all contradictions of its keys."""
    machine_path = path.parent / table.machine
    chain = design_machine(table.machine, named_in=path)
    wanted, shop = table.standard, table.workshop
    faults = Faults((*standard_faults(wanted, path), *material_faults(table.material, path)))
    with faults.collected():
        ranges, poses = workspace_ranges(table.workspace, chain, path)
    with faults.collected():
        study = _study(table, path)
    probes: tuple[Probe, ...] = ()
    with faults.collected():
        first = checked_probe(table.probe, path).probe()
        probes = (first, *(probe.probe() for probe in checked_probes(shop, path)))
    with faults.collected():
        errors = expected_errors(table.errors, chain, path)
    face, setups = None, list[Setup]()
    with faults.collected():
        setups = _setups(table, path)
        face = _table_face(table, path)
        bodies = _bodies(table, chain, path)
    if face is not None:
        known = (table_key(shop), 2.0 * min(face.half_size))
        ball = probes[0].radius if probes else 0.0
        faults += body_faults(table.blank, table.limits, table.material, ball, known, path)
    faults.refuse()
    assert face is not None
    # screws and pads must stand on the table in every set-up
    room = min(middle_room(face, setup.T_table_artefact) for setup in setups)
    limits = table.limits.limits(probes[0].radius, room)
    return Brief(
        chain=chain,
        ranges=ranges,
        errors=errors,
        setups=tuple(setups),
        options=wanted.options(
            table.simulation.noise_um * UM,
            table.calibration.calibration(),
            None if table.scan is None else table.scan.scan(),
        ),
        task=_task(table, ranges, path),
        probes=probes,
        table=face,
        bodies=bodies,
        ball=None if shop.ball is None else shop.ball.ball(face.high),
        blank=table.blank.blank(table.material.material(), limits),
        overhang=table.limits.overhang_mm,
        riser=table.limits.riser_mm,
        first_mode=table.limits.first_mode_Hz,
        programs=shop.settings(table.control),
        study=replace(study, poses=poses),
        seed=table.seed,
        down=wanted.down,
        author=wanted.author,
        organisation=wanted.organisation,
        approved=wanted.approved,
        date=wanted.date,
        path=path,
        machine_path=machine_path,
        remarks=(*remarks, *dict.fromkeys(map(str, amplitude_slips(errors, path)))),
    )


def _study(table: ProjectTable, path: Path) -> StudySettings:
    """Random machines of maps and proof; stable digits need two batches of them."""
    wanted, proof = table.montecarlo, table.simulation
    if wanted.digits and wanted.draws < 2 * MACHINES_A_BATCH:
        raise BadFile(
            path,
            "montecarlo.draws",
            f"{wanted.draws} with digits = {wanted.digits}",
            f"{2 * MACHINES_A_BATCH} or more: stable digits need two batches",
        )
    return StudySettings(
        draws=wanted.draws,
        digits=wanted.digits,
        tolerance=wanted.tolerance_um * UM,
        machines=proof.machines,
        visits=proof.visits,
        body_temperature=proof.body_degC,
        body_u=proof.body_u_K,
    )


def _bodies(table: ProjectTable, chain: Chain, path: Path) -> tuple[Body, ...]:
    """Clamps, fixtures and covers, each on the table or on an axis that carries the workpiece."""
    carriers = chain.carrying_axes
    for i, body in enumerate(table.workshop.bodies):
        if body.on and body.on not in carriers:
            expected = f"one that carries the workpiece: {', '.join(carriers) or 'none'}"
            raise BadFile(path, f"workshop.bodies.{i}.on", f"axis {body.on}", expected)
    return tuple(body.body(path.parent) for body in table.workshop.bodies)


def _rename_keys(data: dict[str, Any]) -> list[tuple[str, str]]:
    """Rename keys of older files; present and written name of each."""
    renamed = []
    for old, new in RENAMED_KEYS.items():
        (table, key), (new_table, new_key) = old.split("."), new.split(".")
        had = data.get(table)
        if not isinstance(had, dict) or key not in had:
            continue
        wanted = data.setdefault(new_table, {})
        if isinstance(wanted, dict) and new_key not in wanted:
            wanted[new_key] = had.pop(key)
            renamed.append((new, old))
    return renamed


def _setups(table: ProjectTable, path: Path) -> list[Setup]:
    """Set-ups, the first for the design; their programs carry their names."""
    if not table.setup:
        raise BadFile(path, "setup", "no set-up", "one at least, [setup.a]")
    letters: list[str] = []
    for name in table.setup:
        short = name.upper()
        is_name = re.fullmatch(r"[A-Z0-9_]{1,6}", short) and short not in letters
        if len(table.setup) > 1 and not is_name:
            expected = "1 to 6 letters or digits, as no other set-up has them: names of programs"
            raise BadFile(path, "setup", repr(name), expected)
        letters.append(short)
    return [setup.setup(name) for name, setup in table.setup.items()]


def _task(table: ProjectTable, workspace: Mapping[str, tuple[float, float]], path: Path) -> Task:
    """The task, which must lie within the workspace and the slopes of the faces."""
    if table.task is None:
        return Task()
    file = path.parent / table.task
    task, steepest = read_task(file), table.limits.max_slope_deg
    if task.slope[0] > steepest * DEG:
        raise BadFile(file, "slope_deg", f"{task.slope[0] / DEG:g} and more",
                      f"some within limits.max_slope_deg = {steepest:g} of {path}")  # fmt: skip
    sharpest = 2e3 / table.limits.min_concave_radius_mm  # waves are about as convex as concave
    if task.curvature[0] * 1e3 > sharpest:
        raise BadFile(file, "curvature_1_m", f"{task.curvature[0] * 1e3:g} and more",
                      f"some up to {sharpest:.4g}, twice what limits.min_concave_radius_mm of "
                      f"{path} allows")  # fmt: skip
    for letter, (low, high) in task.rotary.items():
        key = f"poses.{letter}_deg"
        if letter not in workspace:
            there = ", ".join(f"{axis}_deg" for axis in sorted(workspace) if axis in "ABC")
            raise BadFile(file, key, "an axis that the machine has not", there or "no poses")
        least, most = workspace[letter]
        if low > most or high < least:
            raise BadFile(file, key, f"{low / DEG:g} to {high / DEG:g}",
                          f"some of workspace.{letter} of {path}")  # fmt: skip
    return task


def _table_face(table: ProjectTable, path: Path) -> Solid:
    """The table, stated at most once."""
    check_workshop(table.workshop, table.setup, path)
    stated = table.workshop.table
    if stated is None:
        return round_table(table.limits.table_radius_mm)
    if "table_radius_mm" in table.limits.model_fields_set:
        raise BadFile(path, "limits.table_radius_mm", f"{table.limits.table_radius_mm:g}",
                      "no such key beside [workshop.table]")  # fmt: skip
    return stated.solid()


COMMENT = 46  # column at which comments begin

_OTHERS: dict[str, type[Table]] = {"setup.a": SetupTable, "workshop.table": TableTable}
"""Tables within tables."""


def project_text(tables: Mapping[str, Mapping[str, object]]) -> str:
    """A commented project file.

    Args:
        tables: Values by key, by table; "" are the keys of no table. `[workspace]` takes any axis.
    """
    out = ""
    for name, values in tables.items():
        out += f"\n[{name}]\n" if name else ""
        known = _model(name).keys() if name != "workspace" else {}
        for key, value in values.items():
            unit = "degrees" if key[0] in "ABC" else "mm"
            what = f"readings of interest, {unit}" if name == "workspace" else known[key].short
            if key == "format":
                what = "kind and version of the file"
            out += f"{f'{key} = {toml_value(value)}':<{COMMENT}} # {what}\n"
    return out


def _model(name: str) -> type[Table]:
    """The model of a table of a project."""
    if not name or name in _OTHERS:
        return _OTHERS.get(name, ProjectTable)
    kind = ProjectTable.model_fields[name].annotation
    found = next((k for k in (kind, *get_args(kind)) if isinstance(k, type)), None)
    assert found is not None
    assert issubclass(found, Table)
    return found
