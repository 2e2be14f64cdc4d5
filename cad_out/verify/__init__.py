"""Built files, re-read and measured against the design.

In: a standard and the folder of its files. Out: a `Conformity` with every figure and its limit;
`export_standard` moves the files to their names only if all are met.
"""

from matstd.cad_out.verify.conformity import Conformity as Conformity
from matstd.cad_out.verify.export import export_standard as export_standard
