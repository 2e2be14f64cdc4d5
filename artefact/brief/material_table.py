"""`[material]` of a project file: stated values, completed by the usual ones of the name."""

from pathlib import Path

from pydantic import Field

from matstd.artefact.body import Material
from matstd.twin.elastic import material_names
from matstd.twin.errors import BadFile
from matstd.twin.files import Table
from matstd.twin.units import KG_M3

STEEL = "X40Cr14 (1.2083), hardened"
"""Material of a standard unless another is stated."""


class MaterialTable(Table):
    """`[material]` of the standard."""

    name: str = STEEL
    density_kg_m3: float | None = Field(default=None, gt=0.0)
    expansion_1_K: float | None = Field(default=None, ge=0.0, lt=1e-3)  # noqa: N815
    expansion_u_1_K: float | None = Field(default=None, ge=0.0, lt=1e-3)  # noqa: N815
    modulus_MPa: float | None = Field(default=None, ge=1e3, le=1.2e6)  # noqa: N815
    poisson: float = Field(default=0.3, gt=0.0, lt=0.5)
    hardness: str = Field(default="", max_length=40)

    def material(self, path: Path) -> Material:
        """In base units; what is not stated has the usual value of the name.

        Raises:
            BadFile: Density or expansion of a name without usual values.
        """
        usual = Material.usual_of(self.name)
        for key in ("density_kg_m3", "expansion_1_K"):
            if usual is None and getattr(self, key) is None:
                raise BadFile(
                    path,
                    f"material.{key}",
                    f"no value beside name = '{self.name}'",
                    f"that of this material, or a name with usual values: {_names()}",
                )
        density, expansion, u = self.density_kg_m3, self.expansion_1_K, self.expansion_u_1_K
        if usual is not None:
            density = usual.density / KG_M3 if density is None else density
            if expansion is None:
                expansion, u = usual.expansion, usual.u_expansion if u is None else u
        assert density is not None
        assert expansion is not None
        return Material(
            self.name,
            density * KG_M3,
            expansion,
            u_expansion=u,
            modulus=self.modulus_MPa,
            poisson=self.poisson,
            hardness=self.hardness or ("" if usual is None else usual.hardness),
        ).with_usual_modulus()


def _names() -> str:
    return ", ".join(name.replace("-", " ") for name in material_names())
