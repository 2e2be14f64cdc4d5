"""Tables of controls: made from the errors of a machine, written, read back and played.

In: `MachineErrors` and a `Datum`. Out: the files of a format and, from what was read back of them,
`VerifiedTables`: what they correct, what they cannot hold, and the one-point test of their sign.
Tables hold errors by name (`iso230`; `heidenhain` an axis's own alone) or corrections over single
axes (`sinumerik`, `linuxcnc`). A new control is a module with `write` and `read` and a line in
`formats.FORMATS`.
"""

from matstd.compensation.tables.by_name import point_spacing as point_spacing
from matstd.compensation.tables.formats import FORMATS as FORMATS
from matstd.compensation.tables.formats import Harmful as Harmful
from matstd.compensation.tables.formats import VerifiedTables as VerifiedTables
from matstd.compensation.tables.formats import refuse_harmful as refuse_harmful
from matstd.compensation.tables.formats import verify_tables as verify_tables
from matstd.compensation.tables.formats import write_tables as write_tables
from matstd.compensation.tables.header import Header as Header
from matstd.compensation.tables.header import hashed as hashed
from matstd.compensation.tables.header import header_of as header_of
from matstd.compensation.tables.result_file import write_table_results as write_table_results
