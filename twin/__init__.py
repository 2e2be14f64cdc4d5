"""The digital twin: machines, poses, touches and the physics that disturbs them.

In: machine, error, pose, run and sensor files, and names of effects. Out: `Chain` (the machine),
`Touches` and `Run` (what was measured), `Model` (a machine with effects), which gives deviations
exactly and, per unit of every parameter, to first order. It knows nothing of standards, programs or
searches. Everything is in mm, rad, s, degC and N; only files carry other units, in their names.

    chain = read_machine("machine.toml")
    run = read_run("run.csv", chain)
    model = Model(chain, (parse_effect("backlash(X)", chain),))
    model.columns(run.touches)                                   # (N, P)

Where to add things: an effect is a file in `effects` and a line in `library.catalogue` (or a user's
own file, docs/own_effects.md); a quantity recorded at every touch is a field of `record.Touches`
and a column in `files.run_columns`; a file format of ours is a reader in `files`,
another's in `matstd.importers`.

Beside the parts stand the words that every room speaks: `units`, `frames`, `rows`, `errors`,
`words`, `compute`, `beside`, `versions`.
"""

PARTS = (
    "machine",
    "record",
    "fields",
    "model",
    "thermal",
    "elastic",
    "effects",
    "laws",
    "library",
    "files",
)
"""From bottom to top: each imports only from those before it."""
