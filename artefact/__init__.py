"""Designs a freeform material standard for a machine; its CAD model is made in `cad_out`.

A standard is one body: balls on posts, whose touches identify the machine, freeform faces on
pillars, whose touches prove the model, and a datum plane. From a project (the machine, its probe,
the user's workspace, the expected errors, a blank and its limits) `design_standard` designs the
body and chooses the touches on it:

    project.toml -> read_project -> Brief (machine, probe, workshop, blank, expected errors, wishes)
    Brief -> feasibility -> table poses, or the binding limit and the nearest feasible requests
    Brief, table poses -> design_standard -> Placement
    Placement = Standard, Requests, Criterion, rivals, certificate
    Placement -> identifiability_report -> what the touches can and cannot determine
    Standard -> write_standard -> standard.toml, the input of CAD and probing programs

Candidate balls and random smooth faces are spread over the blank (`layout`). Every touch that the
machine can make on them (`reach`) is a row of information (`worth`). Balls, faces, table poses and
touches are chosen from these rows (`place`) and compared with other artefacts (`compare`). A new
kind of face, body or limit goes into `body`, a new key of the project into `brief`, a rival
artefact into `layout`, a kind of unmodelled effect into `hidden`, a new obstacle to the
probe into `reach`, a new check of the position on the table into `seat`, a criterion into `worth`.
"""

PARTS = (
    "body",
    "price",
    "layout",
    "reach",
    "tool",
    "seat",
    "worth",
    "hidden",
    "brief",
    "feasibility",
    "certify",
    "compare",
    "place",
)
"""From bottom to top: a part imports only from those before it."""
