"""Compensation: the model of a machine goes back to its control.

In: a `SavedModel`, or a machine with errors that are known, and the `State` that it works in. Out:
tables of controls (`write_tables`) and compensated programs (`compensated`), with what each leaves
(`VerifiedTables`, `Compensated`) and the uncertainty that the model has.

    errors = MachineErrors.of_model(read_model("model.toml"))
    datum = datum_of(errors.chain, {"Z": -200.0}, 160.0)
    corrects = partial(correction, errors)
    result_of(errors, corrects, workspace(errors.chain, {}), datum)

Every compensation ends in readings that are added (`CorrectionFunction`), and is judged in one
way: by the exact twin (`deviation_after`). `field` has the errors and their inverse, `tables` what
controls hold, `programs` part programs, `service` corrects while the machine moves, `linuxcnc`
gives that to a control.
"""

PARTS = ("field", "tables", "part_programs", "programs", "service", "linuxcnc")
"""From bottom to top: each imports only from those before it."""
