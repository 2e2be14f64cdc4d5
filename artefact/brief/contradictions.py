"""Keys of a project that contradict each other, all of them found before any work is done."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from matstd.artefact.body import Material
from matstd.artefact.brief.standard_tables import (
    BASE_THICKNESS,
    LEAST_HEIGHT,
    LEAST_SIDE,
    BlankTable,
    LimitsTable,
    MaterialTable,
    StandardTable,
    names_with_values,
)
from matstd.artefact.brief.workshop_tables import WorkshopTable
from matstd.twin.errors import BadFile
from matstd.twin.files import read_machine
from matstd.twin.machine import Chain
from matstd.twin.units import KG_M3

_IN_PROGRAMS = re.compile(r"[A-Za-z0-9_.+-]{1,24}")

_DENSITY_OFF, _EXPANSION_OFF = 0.2, 6e-6
"""By which stated values of a named material differ from its usual ones: a share, and 1/K. Alloys
of one name differ by half of that."""

MIN_SLOT_PITCH = 20.0  # smallest distance between two slots of a table, mm (ISO 299)


def design_machine(path: str | Path, named_in: Path | None = None) -> Chain:
    """Machine for which a standard can be designed: programs move it along X, Y and Z."""
    chain = read_machine(path, named_in)
    if not {"X", "Y", "Z"} <= set(chain.linear_axes):
        found = f"linear axes {', '.join(chain.linear_axes) or 'none'}"
        file = path if named_in is None else named_in.parent / path
        raise BadFile(file, "chain", found, "X, Y and Z: a design and its programs move them")
    return chain


class Faults(list[BadFile]):
    """Faults of a file that are found one after the other and reported together."""

    @contextmanager
    def collected(self) -> Iterator[None]:
        """Keep a fault that is raised inside, and go on after the block."""
        try:
            yield
        except BadFile as error:
            self.extend(faults_of(error))

    def refuse(self) -> None:
        """Raise BadFile with all faults in one line, if there are any."""
        if self:
            raise BadFile.several(self)


def faults_of(error: BadFile) -> tuple[BadFile, ...]:
    """The single faults of a refusal."""
    several = error.facts.get("faults", (error,))
    assert isinstance(several, tuple)
    return several


def as_written(error: BadFile, names: Mapping[str, str]) -> BadFile:
    """A refusal with the names that keys have in the file."""

    def named(fault: BadFile) -> BadFile:
        where = str(fault.facts["where"])
        facts = fault.facts
        found, expected = facts["found"], str(facts["expected"])
        return BadFile(str(facts["path"]), names.get(where, where), found, expected)

    return BadFile.several([named(fault) for fault in faults_of(error)])


def standard_faults(wanted: StandardTable, path: Path) -> Iterator[BadFile]:
    """Keys of `[standard]` that contradict each other, and a name that no program can state."""
    if not _IN_PROGRAMS.fullmatch(wanted.name):
        expected = "1 to 24 letters, digits, _ . + or -, as programs can state them"
        yield BadFile(path, "standard.name", repr(wanted.name), expected)
    if wanted.robust_share < 1.0 and not wanted.robust_machines:
        yield BadFile(
            path,
            "standard.robust_share",
            f"{wanted.robust_share:g} with robust_machines = 0",
            "drawn machines of which that share is the worst, or no such key",
        )
    if wanted.poses * 2 > wanted.touches:
        yield BadFile(
            path,
            "standard.poses",
            f"{wanted.poses} with touches = {wanted.touches}",
            f"two touches or more for every table pose: {wanted.touches // 2} poses at most",
        )


def material_faults(material: MaterialTable, path: Path) -> Iterator[BadFile]:
    """Density or expansion of a name without usual values, or far from its usual ones."""
    for key in material.missing:
        yield BadFile(
            path,
            f"material.{key}",
            f"no value beside name = '{material.name}'",
            f"that of this material, or a name with usual values: {names_with_values()}",
        )

    usual = Material.usual_of(material.name)
    if usual is None:
        return
    density, expansion = material.density, material.expansion_1_K
    if abs(density - usual.density) > _DENSITY_OFF * usual.density:
        found = f"{density / KG_M3:g} beside name = '{material.name}'"
        expected = f"about {usual.density / KG_M3:g}, or another name"
        yield BadFile(path, "material.density_kg_m3", found, expected)
    if expansion is not None and abs(expansion - usual.expansion) > _EXPANSION_OFF:
        found = f"{expansion:g} beside name = '{material.name}'"
        expected = f"about {usual.expansion:g}, or another name"
        yield BadFile(path, "material.expansion_1_K", found, expected)


def table_key(workshop: WorkshopTable) -> str:
    """The key that states the size of the table, as the file has it."""
    if workshop.table is None:
        return "limits.table_radius_mm"
    name = "sides_mm" if workshop.table.diameter_mm is None else "diameter_mm"
    return f"workshop.table.{name}"


def body_faults(
    blank: BlankTable,
    limits: LimitsTable,
    material: MaterialTable,
    ball_mm: float,
    table: tuple[str, float],
    path: Path,
) -> Iterator[BadFile]:
    """What no blank can meet.

    Args:
        ball_mm: Radius of the ball of the probe.
        table: The key that states the size of the table, and its smaller side.
    """
    sides, (key, width) = blank.base_mm, table
    if width < LEAST_SIDE:
        smallest = f"{LEAST_SIDE:g} x {LEAST_SIDE:g} x {LEAST_HEIGHT:g} mm"
        yield BadFile(
            path,
            key,
            f"a table of {width:g} mm",
            f"{LEAST_SIDE:g} mm or more: the smallest standard is {smallest}, so this machine is "
            "too small for the tool",
        )
    if min(sides) < LEAST_SIDE:
        yield BadFile(path, "blank.base_mm", list(sides), f"sides of {LEAST_SIDE:g} mm or more")
    if ball_mm > limits.min_concave_radius_mm:
        yield BadFile(
            path,
            "limits.min_concave_radius_mm",
            f"{limits.min_concave_radius_mm:g} with a ball of probe.radius_mm = {ball_mm:g}",
            "a radius that the ball fits into",
        )
    if 0.0 < limits.slot_pitch_mm < MIN_SLOT_PITCH:
        yield BadFile(
            path,
            "limits.slot_pitch_mm",
            f"{limits.slot_pitch_mm:g}",
            f"{MIN_SLOT_PITCH:g} mm or more, or 0 where screws may stand anywhere",
        )
    base = sides[0] * sides[1] * BASE_THICKNESS * material.density
    if base > limits.max_mass_kg:
        yield BadFile(
            path,
            "limits.max_mass_kg",
            f"{limits.max_mass_kg:g}",
            f"more than {base:.1f} kg, which the base of the blank weighs by itself",
        )
