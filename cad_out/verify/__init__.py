"""What was built, measured anew from the files."""

from cad_out.verify.conformity import Conformity, measure
from cad_out.verify.export import export_standard

__all__ = ["Conformity", "export_standard", "measure"]
