"""The program of a coordinate measuring machine for a standard and its drawing."""

from matstd.artefact.body import Standard
from matstd.artefact.certify import dmis_program
from matstd.cad_out.details import datum_touches, engraved_on, widths


def cmm_program(standard: Standard, orientation: float = 0.0) -> str:
    """DMIS program with datums and tolerances of the drawing, turned by `orientation` degrees."""
    engraved = engraved_on(standard)
    return dmis_program(standard, datum_touches(standard), engraved, widths(), orientation)
