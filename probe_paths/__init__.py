"""From a standard to probing programs, and from their logs back to measurements.

In: a standard, a machine, a probe, a set-up and the touches that are wanted (`Requests`).
Out: programs for an iTNC 530 or another control, and from the logs that they leave a `Run`.

    Requests -> plan_touches -> TouchPlan -> make_programs -> ProgramSet (text)
    text -> read_program -> ReadProgram -> simulate (the exact twin) -> logs
    logs, from the twin or from a control -> read_log -> evaluate -> Run

Plan and simulation meet in nothing but the text: what the writer meant is unknown to the reader,
so a slip between the two shows. `linuxcnc` has what runs beside that control, `locate` finds a
standard that stands beside its place and plans again for where it is. Another word of a control
goes into `language`, another rule for what a program may do into `control`, another shape of
program into `emit`.
"""

PARTS = ("plan", "language", "control", "emit", "stations", "campaign", "linuxcnc", "locate")
"""From bottom to top: each imports only from those before it."""
