"""What measurements can know of a machine, and which measurements to choose.

In: whitened rows of touches, made or possible, ``W = n^T J prior_sd / u`` (N, P). Out: what they
determine, tie together and never show (`identifiability`), what stays unknown after them
(`Posterior`) and one number of it to choose by (`DesignCriterion`), and choices of touches with
what no other choice could beat (`selection`). Everything is linear and Bayesian: a row is a touch,
a column a parameter in units of what is expected of it.

    W = whitened(model.columns(touches), model.prior_sd, u=0.001)
    found = identifiability(W, model.prior_sd, model.names, model.parameters, model.chain)
    criterion = mean_prediction(G, W, model.prior_sd)
    selection = Selection(criterion, criterion.rows(W))
    fill(selection, 480)

Results are numbers, enumerations and names; `matstd.report.words` puts them into sentences. A
criterion is a class in `criteria.measures`, a way to choose a module of `selection`.
"""

from matstd.information.criteria import (
    DesignCriterion,
    Posterior,
    five_criteria,
    mean_prediction,
    robust,
    whitened,
    with_potential,
)
from matstd.information.identifiability import (
    Freedom,
    Identifiability,
    combinations,
    identifiability,
    supported_degrees,
    ties,
)
from matstd.information.selection import (
    Certificate,
    Quota,
    Selection,
    exchange,
    fill,
    relaxed,
    rounded,
)

PARTS = ("identifiability", "criteria", "selection")
"""From bottom to top: each imports only from those before it."""

__all__ = [
    "Certificate",
    "DesignCriterion",
    "Freedom",
    "Identifiability",
    "Posterior",
    "Quota",
    "Selection",
    "combinations",
    "exchange",
    "fill",
    "five_criteria",
    "identifiability",
    "mean_prediction",
    "relaxed",
    "robust",
    "rounded",
    "supported_degrees",
    "ties",
    "whitened",
    "with_potential",
]
