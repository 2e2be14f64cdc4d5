"""Tables of controls: made from the errors of a machine, written, read back and played.

In: `MachineErrors` and a `Datum`. Out: the files of a format and, from what was read back of them,
`VerifiedTables`: what they correct, what they cannot hold, and the one-point test of their sign.
Tables hold errors by name (`iso230`; `heidenhain` an axis's own alone) or corrections over single
axes (`sinumerik`, `linuxcnc`). A new control is a module with `write` and `read` and a line in
`formats.FORMATS`.
"""

from matstd.compensation.tables.by_name import point_spacing
from matstd.compensation.tables.formats import (
    FORMATS,
    Harmful,
    VerifiedTables,
    refuse_harmful,
    verify_tables,
    write_tables,
)
from matstd.compensation.tables.header import Header, hashed, header_of
from matstd.compensation.tables.result_file import write_table_results

__all__ = [
    "FORMATS",
    "Harmful",
    "Header",
    "VerifiedTables",
    "hashed",
    "header_of",
    "point_spacing",
    "refuse_harmful",
    "verify_tables",
    "write_table_results",
    "write_tables",
]
