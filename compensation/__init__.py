"""Compensation: the model of a machine goes back to its control.

In: a `SavedModel`, or a machine with errors that are known, and the `State` that it works in. Out:
tables of controls (`write_tables`) and compensated programs (`compensated`), with what each leaves
(`Played`, `Compensated`) and the uncertainty that the model has.

    errors = MachineErrors.of_model(read_model("model.toml"))
    datum = datum_of(errors.chain, {"Z": -200.0}, 160.0)
    corrects = partial(correction, errors)
    result_of(errors, corrects, workspace(errors.chain, {}), datum)

Every compensation ends in one thing, readings that are added (`Corrects`), and is judged in one
way: played on the exact twin (`played`). `field` has the errors and their inverse, `tables` what
controls hold, `programs` part programs, `service` corrects while the machine moves, `linuxcnc`
gives that to a control.
"""

from matstd.compensation.field import (
    Datum,
    MachineErrors,
    Result,
    State,
    correction,
    datum_of,
    result_of,
    workspace,
)
from matstd.compensation.part_programs import Frame, read_part_program
from matstd.compensation.programs import Compensated, compensated
from matstd.compensation.tables import FORMATS, Played, play_tables, write_tables

PARTS = ("field", "tables", "part_programs", "programs", "service", "linuxcnc")
"""From bottom to top: each imports only from those before it."""

__all__ = [
    "FORMATS",
    "Compensated",
    "Datum",
    "Frame",
    "MachineErrors",
    "Played",
    "Result",
    "State",
    "compensated",
    "correction",
    "datum_of",
    "play_tables",
    "read_part_program",
    "result_of",
    "workspace",
    "write_tables",
]
