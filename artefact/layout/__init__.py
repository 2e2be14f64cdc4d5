"""Standards that could be made on a blank: sites, the body they make, and other artefacts.

In: a `Blank` with its limits. Out: `Site` candidates with smooth shapes, which of them stand beside
each other, and whole standards. A further rival is one more entry in `rivals`.
"""

from artefact.layout.candidates import (
    CONTROL,
    RINGS,
    STEEPEST,
    TALLEST,
    random_sites,
    strength,
)
from artefact.layout.rival_artefacts import rivals, with_spheres
from artefact.layout.side_by_side import most_side_by_side, neighbour_gaps
from artefact.layout.sites import Blank, Fittings, Site, patch_of_site, standard_from_sites

__all__ = [
    "CONTROL",
    "RINGS",
    "STEEPEST",
    "TALLEST",
    "Blank",
    "Fittings",
    "Site",
    "most_side_by_side",
    "neighbour_gaps",
    "patch_of_site",
    "random_sites",
    "rivals",
    "standard_from_sites",
    "strength",
    "with_spheres",
]
