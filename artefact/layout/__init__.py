"""Standards that could be made on a blank: sites, candidates, and artefacts that people have."""

from artefact.layout.candidates import (
    CONTROL,
    STEEPEST,
    TALLEST,
    neighbours_fit,
    random_sites,
    strength,
)
from artefact.layout.rivals import rivals
from artefact.layout.sites import Fittings, Frame, Site, patch_of_site, standard_from_sites

__all__ = [
    "CONTROL",
    "STEEPEST",
    "TALLEST",
    "Fittings",
    "Frame",
    "Site",
    "neighbours_fit",
    "patch_of_site",
    "random_sites",
    "rivals",
    "standard_from_sites",
    "strength",
]
