"""Tables of a project file: the standard, its blank and its limits.

Contradictions are rejected before any work is done.
"""

from pathlib import Path
from typing import Literal

from pydantic import Field

from matstd.artefact.body import Base, Limits, Material
from matstd.artefact.brief.brief import PlacementOptions
from matstd.artefact.hidden import Scan
from matstd.artefact.layout import Blank, Fittings
from matstd.artefact.worth import Calibration, CriterionOptions, TouchOptions
from matstd.twin.errors import BadFile
from matstd.twin.files import Pair, Table
from matstd.twin.units import DEG, KG_M3, UM

BASE_THICKNESS = 30.0
"""Thickness of the plate of every standard, mm."""

CORNER_RADIUS = 25.0
"""Corner radius of that plate, mm."""


FEWEST_PATCHES = 3
"""Smallest number of patches of a standard."""

STEEL = "X40Cr14 (1.2083), hardened"
"""Material of the default density and expansion."""

FINISHING_RADIUS = 3.0
"""Radius of the finishing ball-end mill, mm; smaller concave radii cannot be made."""

LEAST_SIDE = 160.0
"""Smallest side of a base, mm."""

_MIN_SLOT_PITCH = 20.0  # mm between two slots of a table, ISO 299

_HIGHEST_SPHERE = 130.0 / 220.0
"""Centre of the highest sphere above the seat, as a share of the blank's height."""


class StandardTable(Table):
    """`[standard]`: size of the standard and design criterion."""

    name: str = "FFS-1"
    serial: str = ""
    author: str = "not stated"
    organisation: str = "not stated"
    patches: int = Field(default=6, ge=FEWEST_PATCHES, le=16)
    balls: int = Field(default=13, ge=3, le=25)
    touches: int = Field(default=480, ge=100, le=2000)
    proof_touches: int = Field(default=110, ge=30, le=1000)
    poses: int = Field(default=30, ge=8, le=100)
    criterion: Literal["I", "G", "D", "A", "E"] = "I"
    potential: float = Field(default=0.3, ge=0.0, le=0.95)
    robust_machines: int = Field(default=0, ge=0, le=100)
    robust_share: float = Field(default=1.0, gt=0.0, le=1.0)
    down: Literal["+X", "-X", "+Y", "-Y", "+Z", "-Z"] = "-Z"
    family: Literal["auto", "faces", "flat", "wavy"] = "faces"
    goal: Literal["prove", "identify"] = "prove"

    def options(
        self, noise: float, calibration: Calibration, scan: Scan | None = None
    ) -> PlacementOptions:
        """The options in base units; noise in mm."""
        return PlacementOptions(
            name=self.name,
            serial=self.serial,
            patches=self.patches,
            balls=self.balls,
            noise=noise,
            criterion=CriterionOptions(
                name=self.criterion,
                potential=self.potential,
                robust_machines=self.robust_machines,
                robust_share=self.robust_share,
                calibration=calibration,
            ),
            choice=TouchOptions(self.touches, self.poses, self.proof_touches),
            family=self.family,
            goal=self.goal,
            scan=scan,
        )


class ScanTable(Table):
    """`[scan]`: how the control scans a wavy face; without it faces are touched."""

    lines_mm: float = Field(default=5.0, ge=0.5, le=50.0)
    pitch_mm: float = Field(default=2.5, ge=0.05, le=20.0)
    noise_um: float = Field(default=2.0, gt=0.0)
    memory_mm: float = Field(default=1.0, ge=0.0, le=50.0)
    feed_mm_min: float = Field(default=1000.0, gt=0.0)

    def scan(self) -> Scan:
        """In base units."""
        return Scan(
            between=self.lines_mm,
            pitch=self.pitch_mm,
            u=self.noise_um * UM,
            memory=self.memory_mm,
            feed=self.feed_mm_min,
        )


class MaterialTable(Table):
    """`[material]` of the standard."""

    name: str = STEEL
    density_kg_m3: float = Field(default=7800.0, gt=0.0)
    expansion_1_K: float = Field(default=10.5e-6, ge=0.0, lt=1e-3)  # noqa: N815
    expansion_u_1_K: float | None = Field(default=None, ge=0.0, lt=1e-3)  # noqa: N815
    modulus_MPa: float | None = Field(default=None, ge=1e3, le=1.2e6)  # noqa: N815
    poisson: float = Field(default=0.3, gt=0.0, lt=0.5)

    def material(self) -> Material:
        """In base units, with the usual modulus of a known name where none is stated."""
        return Material(
            self.name,
            self.density_kg_m3 * KG_M3,
            self.expansion_1_K,
            u_expansion=self.expansion_u_1_K,
            modulus=self.modulus_MPa,
            poisson=self.poisson,
        ).with_usual_modulus()


class BlankTable(Table):
    """`[blank]`: sides of the base and height of the whole, mm."""

    base_mm: Pair = (280.0, 280.0)
    height_mm: float = Field(default=220.0, ge=120.0, le=400.0)

    def blank(self, material: Material, limits: Limits) -> Blank:
        """The blank with fittings that suit its height."""
        return Blank(
            base=base_of(self.base_mm),
            fittings=Fittings(highest_sphere=round(_HIGHEST_SPHERE * self.height_mm, 1)),
            material=material,
            height=self.height_mm,
            limits=limits,
        )


class LimitsTable(Table):
    """`[limits]` of cutter, probe and table."""

    min_concave_radius_mm: float = Field(default=12.0, gt=0.0)
    max_slope_deg: float = Field(default=45.0, gt=0.0, lt=90.0)
    gap_mm: float = Field(default=1.0, ge=0.0)
    max_mass_kg: float = Field(default=60.0, gt=0.0)
    table_radius_mm: float = Field(default=160.0, gt=0.0)
    slot_pitch_mm: float = Field(default=0.0, ge=0.0)
    overhang_mm: float | None = Field(default=None, ge=0.0)
    riser_mm: float = Field(default=0.0, ge=0.0)

    def limits(self, ball_radius: float, table_radius: float) -> Limits:
        """In base units.

        Args:
            ball_radius: Of the probe, mm.
            table_radius: Of the disc about the axis of the standard that lies on the table, mm.
        """
        return Limits(
            min_concave_radius=self.min_concave_radius_mm,
            max_slope=self.max_slope_deg * DEG,
            ball_radius=ball_radius,
            gap=self.gap_mm,
            max_mass=self.max_mass_kg,
            table_radius=table_radius,
            slot_pitch=self.slot_pitch_mm,
        )


def base_of(sides: tuple[float, float]) -> Base:
    """The plate of a standard with these sides, mm."""
    return Base((0.5 * sides[0], 0.5 * sides[1]), CORNER_RADIUS, BASE_THICKNESS)


def check_standard(wanted: StandardTable, path: Path) -> None:
    """Reject keys of `[standard]` that contradict each other.

    Raises:
        BadFile: The key and what it contradicts.
    """
    if wanted.robust_share < 1.0 and not wanted.robust_machines:
        raise BadFile(
            path,
            "standard.robust_share",
            f"{wanted.robust_share:g} with robust_machines = 0",
            "drawn machines of which that share is the worst, or no such key",
        )
    if wanted.poses * 2 > wanted.touches:
        raise BadFile(
            path,
            "standard.poses",
            f"{wanted.poses} with touches = {wanted.touches}",
            "two touches or more for every table pose",
        )


def check_material(material: MaterialTable, path: Path) -> None:
    """Reject another material with the default density or expansion.

    Raises:
        BadFile: The key that is missing.
    """
    for key in ("density_kg_m3", "expansion_1_K"):
        if material.name != STEEL and key not in material.model_fields_set:
            raise BadFile(
                path,
                f"material.{key}",
                f"no value beside name = '{material.name}'",
                f"that of this material; the default is that of {STEEL}",
            )


_TABLE_KEYS = "workshop.table or limits.table_radius_mm"


def check_body(
    blank: BlankTable,
    limits: LimitsTable,
    material: MaterialTable,
    ball_mm: float,
    table_radius_mm: float,
    path: Path,
) -> None:
    """Reject a blank and limits that no standard can meet.

    Raises:
        BadFile: The key and what it contradicts.
    """
    sides, table = blank.base_mm, 2.0 * table_radius_mm
    if min(sides) < LEAST_SIDE:
        raise BadFile(path, "blank.base_mm", list(sides), "160 mm or more either way")
    if table < 160.0:
        raise BadFile(
            path,
            _TABLE_KEYS,
            f"a table of {table:g} mm",
            "160 mm or more, the smallest base of a standard",
        )
    if max(sides) > table:
        raise BadFile(
            path,
            "blank.base_mm",
            list(sides),
            f"a blank no larger than the table, {table:g} mm ({_TABLE_KEYS})",
        )
    if ball_mm > limits.min_concave_radius_mm:
        raise BadFile(
            path,
            "limits.min_concave_radius_mm",
            f"{limits.min_concave_radius_mm:g} with a ball of probe.radius_mm = {ball_mm:g}",
            "a radius that the ball fits into",
        )
    if limits.min_concave_radius_mm < FINISHING_RADIUS:
        raise BadFile(
            path,
            "limits.min_concave_radius_mm",
            f"{limits.min_concave_radius_mm:g}",
            f"{FINISHING_RADIUS:g} mm or more: a finishing cutter of {2 * FINISHING_RADIUS:g} mm",
        )
    if 0.0 < limits.slot_pitch_mm < _MIN_SLOT_PITCH:
        raise BadFile(
            path,
            "limits.slot_pitch_mm",
            f"{limits.slot_pitch_mm:g}",
            f"{_MIN_SLOT_PITCH:g} mm or more, or 0 where screws may stand anywhere",
        )
    base = sides[0] * sides[1] * BASE_THICKNESS * material.density_kg_m3 * KG_M3
    if base > limits.max_mass_kg:
        raise BadFile(
            path,
            "limits.max_mass_kg",
            f"{limits.max_mass_kg:g}",
            f"more than {base:.1f} kg, which the base of the blank weighs by itself",
        )
