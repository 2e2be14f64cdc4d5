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

Beside the parts stand the words that every room speaks: `units`, `frames`, `errors`, `words`,
`compute`, `versions`.
"""

from matstd.twin.files import read_errors, read_machine, read_poses, read_run, write_run
from matstd.twin.library import (
    kinds,
    load_user_effects,
    ordinary_model,
    parse_effect,
    proposals,
    register,
)
from matstd.twin.machine import Chain, Symbol, make_chain, tip
from matstd.twin.model import Effect, Inner, Kind, Model, Parameter, Term, Where
from matstd.twin.record import Run, Touches, at_poses

PARTS = (
    "machine",
    "record",
    "fields",
    "model",
    "thermal",
    "elastic",
    "effects",
    "library",
    "files",
)
"""From bottom to top: each imports only from those before it."""

__all__ = [
    "Chain",
    "Effect",
    "Inner",
    "Kind",
    "Model",
    "Parameter",
    "Run",
    "Symbol",
    "Term",
    "Touches",
    "Where",
    "at_poses",
    "kinds",
    "load_user_effects",
    "make_chain",
    "ordinary_model",
    "parse_effect",
    "proposals",
    "read_errors",
    "read_machine",
    "read_poses",
    "read_run",
    "register",
    "tip",
    "write_run",
]
