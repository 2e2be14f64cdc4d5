"""Usual properties of materials, by the names that users write: `steel`, `cast-iron`, `invar`.

Expansion is the mean coefficient about 20 degC. Its standard uncertainty contains the differences
between grades of a name; a certificate of the piece has a smaller one.
"""

from dataclasses import dataclass

from matstd.twin.units import GPA, KG_M3

PPM_K = 1e-6


@dataclass(frozen=True)
class Material:
    """An elastic solid that expands."""

    young: float  # N/mm2
    poisson: float  # Poisson's ratio
    density: float  # kg/mm3
    share: float  # standard uncertainty of the modulus, as a share of it
    source: str  # source of the modulus
    expansion: float  # coefficient of linear expansion, 1/K
    u_expansion: float  # its standard uncertainty, 1/K
    expansion_source: str  # source of the expansion
    hardness: str  # usual hardness, as a drawing states it

    @property
    def shear(self) -> float:
        """Shear modulus, N/mm2."""
        return self.young / (2.0 * (1.0 + self.poisson))


MATERIALS = {
    "steel": (210.0, 0.30, 7850.0, 0.02, "EN 1993-1-1, 3.2.6"),
    "x40cr14": (200.0, 0.30, 7800.0, 0.03, "data sheet of Uddeholm Stavax ESR"),
    "cast-iron": (120.0, 0.26, 7200.0, 0.08, "EN 1561, EN-GJL-250 and 300: 103 to 137 GPa"),
    "aluminium": (70.0, 0.33, 2700.0, 0.02, "EN 1999-1-1, 3.2.5"),
    "invar": (141.0, 0.29, 8050.0, 0.04, "data sheet of Carpenter Invar 36"),
    "alumina": (370.0, 0.22, 3900.0, 0.05, "data sheet of CoorsTek AD-995"),
    "zirconia": (205.0, 0.31, 6050.0, 0.03, "suppliers of 3Y-TZP: 200 to 210 GPa"),
    "granite": (60.0, 0.25, 2900.0, 0.3, "suppliers: 30 to 90 GPa by its kind"),
    "mineral-casting": (40.0, 0.25, 2400.0, 0.1, "suppliers: 30 to 45 GPa"),
}
"""Usual Young's modulus in GPa, Poisson's ratio, density in kg/m3, standard uncertainty of the
modulus as a share of it, and its source."""

_EXPANSION = {
    "steel": (11.5, 1.2, "JCGM 100:2008, H.1.3.3: 11.5 within 2, rectangular", "as delivered"),
    "x40cr14": (10.5, 0.6, "data sheets of 1.2083: 10.5 to 11 from 20 to 100", "50 to 54 HRC"),
    "cast-iron": (10.5, 0.7, "EN 1561, annex: 10 below 20, 11.7 above it", "180 to 230 HBW"),
    "aluminium": (23.2, 0.5, "EN 1999-1-1, 3.2.5, and EN AW-5083, 6082, 7075: 23 to 24",
                  "75 to 150 HBW by its alloy"),
    "invar": (1.3, 0.4, "data sheet of Carpenter Invar 36: 0.6 to 2 by its state", "about 160 HBW"),
    "alumina": (5.4, 0.4, "NIST and suppliers of 99.5 %: 5 to 6 in a room", "about 1500 HV"),
    "zirconia": (9.8, 0.5, "suppliers of 3Y-TZP: 9 to 10.5", "about 1250 HV"),
    "granite": (6.5, 1.2, "suppliers of plates: 4.5 to 8.5 by its kind", "not specified"),
    "mineral-casting": (14.0, 1.5, "suppliers: 11 to 17 by its filler", "not specified"),
}  # fmt: skip
"""Mean coefficient of expansion about 20 degC and its standard uncertainty in 1e-6/K, its source,
and usual hardness."""


def material(word: str) -> Material | None:
    """A material by its name; None where it is unknown."""
    if word not in MATERIALS:
        return None
    young, poisson, density, share, source = MATERIALS[word]
    expansion, u_expansion, expansion_source, hardness = _EXPANSION[word]
    return Material(
        young=young * GPA,
        poisson=poisson,
        density=density * KG_M3,
        share=share,
        source=source,
        expansion=expansion * PPM_K,
        u_expansion=u_expansion * PPM_K,
        expansion_source=expansion_source,
        hardness=hardness,
    )
