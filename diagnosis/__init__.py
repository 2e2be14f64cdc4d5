"""Diagnosis: from a run and a model, what the model lacks and what the machine's errors are.

In: a `Run` (measurements), a `Model` to start from and what is believed of its parameters (`Prior`,
or a `SavedModel`). Out: a `Comparison` (what the model leaves, where, and what that varies with) or
a `Diagnosis` (verdict, the effects that it found step by step, what looks like them, what to
measure next), and model and result files. It needs no standard and no CAD.

    result = diagnose(read_run("run.csv"))
    result.verdict, [step.effect for step in result.steps], result.fit.test_rms

`policy` has every threshold of a decision. `regression` solves with a prior and knows what noise
does, `fit` estimates a model's parameters with it, `geometry` states what they mean to a machine's
user. `accuracy` says how well the run repeats itself and what a model promises. `evidence` projects
effects that are not in the model on what the fit leaves, and says how much a set of them explains;
`faults` tries what users get wrong in a description. `residual` tests what is left for structure,
and finds regions where a model fails. `laws` learns what is left as a law without a cause,
`next_visit` plans the visit that distinguishes it from its rivals. `search`
finds sets of effects, `choice` takes the one that predicts best, `answer` turns it into a verdict
with sizes and look-alikes. `reduced` keeps what the error of any set of effects follows from,
without the touches. `task` evaluates visits to calibrated features for a user's measuring task.
`files` reads and writes models and results. `charts` are control charts of one machine over dated
runs. `drift` has laws of thermal drift from logs.

Where to add things: a test for structure is a module of `residual` and a `Shape`; something a user
should know about a run is a member of `remarks.What`, its sentence in `matstd.report.words`; a
new effect needs nothing here.
"""

PARTS = (
    "policy",
    "regression",
    "fit",
    "accuracy",
    "geometry",
    "evidence",
    "faults",
    "remarks",
    "residual",
    "laws",
    "next_visit",
    "search",
    "choice",
    "answer",
    "reduced",
    "task",
    "files",
    "charts",
    "drift",
)
"""From bottom to top: each imports only from those before it."""
