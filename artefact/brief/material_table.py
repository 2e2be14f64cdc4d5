"""`[material]` of a project file: stated values, completed by the usual ones of the name."""

from pydantic import Field

from matstd.artefact.body import Material
from matstd.twin.elastic import material_names
from matstd.twin.files import Table
from matstd.twin.units import KG_M3

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
    return ", ".join(name.replace("-", " ") for name in material_names())
