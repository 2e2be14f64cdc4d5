"""Designs a freeform material standard for a machine, and knows everything of it but its CAD.

A standard is one body: balls on posts, whose touches identify the machine, freeform faces on
pillars, whose touches prove the model, and a datum plane. From a project (the machine, its probe,
the user's workspace, the errors that are expected, a blank and its limits) `design_standard` makes
the body and chooses the touches on it:

    project.toml -> read_project -> Brief (machine, probe, workshop, blank, expected errors, wishes)
    Brief -> feasibility -> table poses, or what stands against it and the nearest wishes
    Brief, table poses -> design_standard -> Placement
    Placement = Standard, Requests, Criterion, rivals, certificate
    Placement -> identifiability_report -> what the touches can and cannot know
    Standard -> write_standard -> standard.toml, which CAD and probing programs start from

Places for balls and for random smooth faces lie all over the blank (`layout`); every touch that the
machine can make on them (`reach`) is a row of information (`worth`); balls, faces, table poses and
touches are chosen from the rows (`place`) and judged beside other artefacts (`compare`). A new kind
of face, body or limit goes into `body`, a new key of the project into `brief`, a rival artefact
into `layout`, a hindrance for the probe into `reach`, for its place on the table into `seat`, a
criterion into `worth`.
"""

PARTS = (
    "body",
    "layout",
    "reach",
    "tool",
    "seat",
    "worth",
    "brief",
    "feasibility",
    "certify",
    "compare",
    "place",
)
"""From bottom to top: each imports only from those before it."""
