"""Material of a standard: as stated, completed by the usual values of its name."""

import re
from dataclasses import dataclass, replace

from matstd.twin.elastic import Material as UsualMaterial
from matstd.twin.elastic import material as usual


@dataclass(frozen=True, slots=True)
class Material:
    """Material of the standard."""

    name: str = "X40Cr14 (1.2083), hardened"
    density: float = 7.8e-6  # in kg/mm^3
    expansion: float = 10.5e-6  # coefficient of linear thermal expansion, 1/K
    u_expansion: float | None = None  # its standard uncertainty, 1/K; None where it is not stated
    modulus: float | None = None  # Young's, N/mm^2; None where it is not known
    poisson: float = 0.3
    modulus_source: str = "stated"
    modulus_share: float = 0.0  # relative standard uncertainty of the modulus; 0 where it is stated
    hardness: str = ""  # as the drawing states it; empty where it is not known

    @staticmethod
    def usual_of(name: str) -> UsualMaterial | None:
        """Usual properties of a named material; None where the name is unknown.

        Only the words before a bracket or comma count, and only as a whole: "X40Cr14 (1.2083),
        hardened" and "Cast iron" are known, "steel-filled epoxy" is not.
        """
        return usual(_word(name))

    def with_usual_modulus(self) -> "Material":
        """With the usual modulus of the named material, unless one is stated."""
        known = self.usual_of(self.name)
        if self.modulus is not None or known is None:
            return self
        source = f"usual value of {_word(self.name)}: {known.source}"
        return replace(
            self,
            modulus=known.young,
            poisson=known.poisson,
            modulus_source=source,
            modulus_share=known.share,
        )


def _word(name: str) -> str:
    word = re.split(r"[(,]", name)[0].strip().casefold().replace(" ", "-")
    return {"aluminum": "aluminium"}.get(word, word)


STEEL = Material().with_usual_modulus()
