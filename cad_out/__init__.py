"""CAD of a standard: a solid, STEP and STL files, their measured conformity, pictures."""

from cad_out.conformity import Conformity
from cad_out.export import export_standard

__all__ = ["Conformity", "export_standard"]
