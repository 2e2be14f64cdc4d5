"""What measurements can know of a machine, and which measurements to choose.

In: whitened rows of touches, made or possible, ``W = n^T J prior_sd / u`` (N, P). Out: what they
determine, tie together and never show (`identifiability`), what stays unknown after them
(`Posterior`) and one number of it to choose by (`DesignCriterion`), choices of touches with what no
other choice could beat (`selection`), and how surely they show a smooth field that no model has
(`power`). Everything is linear and Bayesian: a row is a touch,
a column a parameter in units of what is expected of it.

    W = whitened(model.columns(touches), model.prior_sd, u=0.001)
    found = identifiability(W, model.prior_sd, model.names, model.parameters, model.chain)
    criterion = mean_prediction(G, W, model.prior_sd)
    selection = Selection(criterion, criterion.rows(W))
    fill(selection, 480)

Results are numbers, enumerations and names; `matstd.report.words` puts them into sentences. A
criterion is a class in `criteria.measures`, a way to choose a module of `selection`.
"""

PARTS = ("identifiability", "criteria", "selection", "power")
"""From bottom to top: each imports only from those before it."""
