"""Tables of a project file: the standard, its material, its blank and its limits; the workspace."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from matstd.artefact.body import Base, Limits, Material
from matstd.artefact.brief.brief import Goal, PlacementOptions
from matstd.artefact.hidden import Scan
from matstd.artefact.layout import Blank, Fittings
from matstd.artefact.reach import TABLE_RADIUS
from matstd.artefact.worth import Calibration, CriterionOptions, TouchOptions
from matstd.twin.elastic import MATERIALS
from matstd.twin.errors import BadFile, UnknownAxis
from matstd.twin.files import Pair, Table
from matstd.twin.machine import Chain
from matstd.twin.units import DEG, KG_M3, UM, meant_in_radians

STEEL = "X40Cr14 (1.2083), hardened"  # material of a standard unless another is stated


class MaterialTable(Table):
    """`[material]` of the standard."""

    name: str = STEEL
    """name, for the drawing"""
    density_kg_m3: float | None = Field(default=None, ge=500.0, le=23e3, examples=[7800.0])
    """density. Default: that of the name, see below"""
    expansion_1_K: float | None = Field(default=None, ge=0.0, le=3e-4, examples=[10.5e-6])  # noqa: N815
    """coefficient of expansion about 20 °C, 1/K. Default: that of the name"""
    expansion_u_1_K: float | None = Field(default=None, ge=0.0, le=3e-4, examples=[1e-6])  # noqa: N815
    """its standard uncertainty, 1/K. Default: that of the name, of a stated expansion a tenth"""
    modulus_MPa: float | None = Field(default=None, ge=1e3, le=1.2e6, examples=[200e3])  # noqa: N815
    """Young's modulus. Default: that of the name"""
    poisson: float = Field(default=0.3, gt=0.0, lt=0.5)
    """Poisson's ratio, for a stated modulus"""
    hardness: str = Field(default="", max_length=40)
    """hardness, for the drawing. Default: that of the name"""

    @property
    def missing(self) -> tuple[str, ...]:
        """Keys that a name without usual values has to state, and does not."""
        if Material.usual_of(self.name) is not None:
            return ()
        needed = ("density_kg_m3", "expansion_1_K")
        return tuple(key for key in needed if getattr(self, key) is None)

    @property
    def density(self) -> float:
        """Stated or usual density, kg/mm3; 0 where there is none."""
        if self.density_kg_m3 is not None:
            return self.density_kg_m3 * KG_M3
        usual = Material.usual_of(self.name)
        return 0.0 if usual is None else usual.density

    def material(self) -> Material:
        """In base units, of a table in which nothing is missing."""
        usual = Material.usual_of(self.name)
        expansion, u = self.expansion_1_K, self.expansion_u_1_K
        if expansion is None:
            assert usual is not None
            expansion, u = usual.expansion, usual.u_expansion if u is None else u
        return Material(
            self.name,
            self.density,
            expansion,
            u_expansion=u,
            modulus=self.modulus_MPa,
            poisson=self.poisson,
            hardness=self.hardness or ("" if usual is None else usual.hardness),
        ).with_usual_modulus()


def names_with_values() -> str:
    """Names of materials with usual values."""
    return ", ".join(name.replace("-", " ") for name in MATERIALS)


BASE_THICKNESS = 30.0  # thickness of the plate of every standard, mm
CORNER_RADIUS = 25.0  # corner radius of that plate, mm


FEWEST_PATCHES = 3  # smallest number of patches of a standard

FINISHING_RADIUS = 3.0
"""Radius of the finishing ball-end mill, mm; smaller concave radii cannot be made."""

LEAST_SIDE = 160.0  # smallest side of a base, mm
LEAST_HEIGHT = 120.0  # smallest height of a standard, mm

_HIGHEST_SPHERE = 130.0 / 220.0
"""Centre of the highest sphere above the seat, as a share of the blank's height."""


class StandardTable(Table):
    """`[standard]`: size of the standard and design criterion."""

    name: str = "FFS-1"
    """type, stated in programs and on the drawing"""
    serial: str = ""
    """serial number"""
    author: str = "not stated"
    """person responsible for the design; header of the STEP file"""
    organisation: str = "not stated"
    """organisation of the author"""
    approved: str = Field(default="not stated", max_length=28)
    """who approved the drawing, for its title block (ISO 7200)"""
    date: str = Field(default="not stated", max_length=18)
    """date of issue of the drawing, such as `"2026-11-23"`"""
    patches: int = Field(default=6, ge=FEWEST_PATCHES, le=16)
    """number of freeform faces, for verification; more faces are smaller"""
    balls: int = Field(default=13, ge=3, le=25)
    """number of precision balls on posts, for identification; fewer if there is no room"""
    touches: int = Field(default=480, ge=100, le=2000)
    """number of identifying touches, all on balls"""
    proof_touches: int = Field(default=110, ge=30, le=1000)
    """number of proving touches, distributed evenly over the freeform faces, at the same table
    poses (22 to 23 minutes on the example and the trunnion machine; `report.html` states yours)"""
    poses: int = Field(default=30, ge=8, le=100)
    """number of table poses, with two or more touches each"""
    criterion: Literal["I", "G", "D", "A", "E"] = "I"
    """criterion for faces, poses and touches: `I` mean variance of the predicted tool point, `G`
    its maximum, `D` volume of the uncertainty region, `A` mean variance of the errors, `E`
    variance of the least well determined error pattern"""
    potential: float = Field(default=0.3, ge=0.0, le=0.95)
    """share of the criterion for effects that the model may lack"""
    robust_machines: int = Field(default=0, ge=0, le=100)
    """number of random machines over whose sizes of errors the criterion is averaged; 0 for the
    expected sizes"""
    robust_share: float = Field(default=1.0, gt=0.0, le=1.0)
    """share of them, the worst, that are averaged"""
    down: Literal["+X", "-X", "+Y", "-Y", "+Z", "-Z"] = "-Z"
    """direction of weight in machine coordinates, `-Y` for a horizontal machine; the sag of the
    standard depends on it"""
    family: Literal["auto", "balls", "faces", "flat", "wavy"] = "faces"
    """features that prove the model: `faces` (small freeform faces), `flat` (flat pads in their
    places), `wavy` (one large wavy face), `balls` (as many further balls) or `auto`: the one that
    wins, see [design](../design.md#which-features)"""
    goal: Goal = "prove"
    """goal of `auto`: `prove` for the family that shows unmodelled effects best, `identify` for the
    one that leaves least unknown in the workspace, `worst` for least at its worst pose, `minutes`
    for the best signal of unmodelled effects in the same time, `price` for the cheapest. A wavy
    face asked for by name may cost 35 % of the identification for `prove`, 5 % otherwise"""

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
    """distance of two lines"""
    pitch_mm: float = Field(default=2.5, ge=0.05, le=20.0)
    """distance of two recorded points on a line"""
    noise_um: float = Field(default=2.0, gt=0.0)
    """standard deviation of one point"""
    memory_mm: float = Field(default=1.0, ge=0.0, le=50.0)
    """distance over which the noise falls to 1/e; points within it are not independent"""
    feed_mm_min: float = Field(default=1000.0, gt=0.0)
    """feed of the scan"""

    def scan(self) -> Scan:
        """In base units."""
        return Scan(
            between=self.lines_mm,
            pitch=self.pitch_mm,
            u=self.noise_um * UM,
            memory=self.memory_mm,
            feed=self.feed_mm_min,
        )


class BlankTable(Table):
    """`[blank]`: sides of the base and height of the whole, mm."""

    base_mm: Pair = (280.0, 280.0)
    """sides of the base, each 160 mm or more"""
    height_mm: float = Field(default=220.0, ge=LEAST_HEIGHT, le=400.0)
    """height above the table"""

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

    min_concave_radius_mm: float = Field(default=12.0, ge=FINISHING_RADIUS)
    """smallest concave radius, for the ball-end cutter; the ball of the probe must fit
    too"""
    max_slope_deg: float = Field(default=45.0, gt=0.0, lt=90.0)
    """largest slope of a face against the standard's z"""
    gap_mm: float = Field(default=1.0, ge=0.0)
    """gap between the ball at any touch and everything else"""
    max_mass_kg: float = Field(default=60.0, gt=0.0)
    """largest mass of the standard"""
    table_radius_mm: float = Field(default=TABLE_RADIUS, gt=0.0)
    """radius of the table's face; not together with `[workshop.table]`. The default base stands on
    the default table"""
    slot_pitch_mm: float = Field(default=0.0, ge=0.0, examples=[63.0])
    """distance between the slots of the table, which run along its x, one through the middle, 20
    or more; 0 if screws may be anywhere"""
    overhang_mm: float = Field(default=0.0, ge=0.0, examples=[40.0])
    """largest overhang of the base, corners included, beyond the edge of the table. Screws and
    their pads are on the table in every set-up, whatever overhangs"""
    riser_mm: float = Field(default=0.0, ge=0.0, examples=[80.0])
    """largest height of the seat above the table's face, on a riser or pallet. A body of
    `[[workshop.bodies]]` whose upper face is at the seat carries it without this key"""
    first_mode_Hz: float = Field(default=0.0, ge=0.0, le=10_000.0)  # noqa: N815
    """least first natural frequency of the standard on rigid screws; a design below it is refused
    before its CAD is made. 0 for any: below 500 Hz the console names it as a compromise"""

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


MAX_READING = 1e6
"""Largest plausible reading, mm or degrees; larger integers may not convert to floats."""

LEAST_WORKSPACE = 5.0
"""Smallest range of a linear axis that is of interest, mm: less is one in metres."""


def workspace_ranges(
    stated: Mapping[str, Any], chain: Chain, path: Path
) -> tuple[dict[str, tuple[float, float]], int]:
    """Ranges of readings in base units, and the number of poses; raises BadFile."""
    given = dict(stated)
    poses = given.pop("poses", 2000)
    if not isinstance(poses, int) or not 100 <= poses <= 100_000:
        raise BadFile(path, "workspace.poses", repr(poses), "a whole number, 100 to 100000")
    out = {axis: chain.link(axis).range for axis in chain.programmed_axes}
    for axis, pair in given.items():
        if axis not in chain.programmed_axes:
            raise BadFile.of(path, UnknownAxis(axis, chain.programmed_axes), within="workspace")
        low, high = _pair(pair, path, f"workspace.{axis}")
        factor = 1.0 if chain.link(axis).kind == "linear" else DEG
        travel = chain.link(axis).range
        if low * factor < travel[0] or high * factor > travel[1]:
            raise BadFile(
                path,
                f"workspace.{axis}",
                [low, high],
                f"within the travel {travel[0] / factor:g} to {travel[1] / factor:g}",
            )
        _check_unit(axis, (low, high), (travel[0] / factor, travel[1] / factor), path)
        out[axis] = (low * factor, high * factor)
    return out, poses


def _check_unit(
    axis: str, stated: tuple[float, float], travel: tuple[float, float], path: Path
) -> None:
    """Refuse a workspace in metres or radians; units of the file."""
    low, high = stated
    key, found = f"workspace.{axis}", [low, high]
    width = f"{high - low:.3g}"
    if axis[0] in "ABC":
        meant = meant_in_radians(low, high)
        if meant is not None and travel[0] <= meant[0] and meant[1] <= travel[1]:
            ends = f"[{meant[0]:g}, {meant[1]:g}]"
            raise BadFile(path, key, found, f"degrees, not {width}; is it in radians, {ends}?")
    elif 0.0 < high - low < LEAST_WORKSPACE:
        ends = f"[{1e3 * low:g}, {1e3 * high:g}]"
        raise BadFile(path, key, found, f"mm, not {width} of them; is it in metres, {ends}?")


def _pair(value: Any, path: Path, key: str) -> tuple[float, float]:
    """Two finite numbers, the smaller first."""
    is_pair = isinstance(value, list) and len(value) == 2
    if not is_pair or not all(type(v) in (int, float) and abs(v) < MAX_READING for v in value):
        raise BadFile(path, key, repr(value), "two numbers")
    low, high = float(value[0]), float(value[1])
    if not low <= high:
        raise BadFile(path, key, [low, high], "the smaller number first")
    return low, high
