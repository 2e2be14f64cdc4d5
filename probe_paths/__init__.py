"""From a standard to probing programs, and from their logs back to measurements.

In: a standard, a machine, a probe, a set-up and the touches that are wanted (`Requests`).
Out: programs for an iTNC 530 or another control, and from the logs that they leave a `Run`.

    Requests -> plan_touches -> TouchPlan -> make_programs -> ProgramSet (text)
    text -> read_program -> ReadProgram -> simulate (the exact twin) -> logs
    logs, from the twin or from a control -> read_log -> evaluate -> Run
    points of a scan -> evaluate_scan -> Run

Plan and simulation share nothing but the text: the reader does not know the intention of the
writer, so a discrepancy between the two shows. `linuxcnc` runs programs on that control, `locate`
finds a misplaced standard and plans again for its place. A new word of a control goes into
`language`, a new rule for what a program may do into `control`, a new kind of program into `emit`.
"""

PARTS = (
    "plan",
    "language",
    "control",
    "emit",
    "stations",
    "campaign",
    "scans",
    "linuxcnc",
    "locate",
)
"""From bottom to top: each imports only from those before it."""
