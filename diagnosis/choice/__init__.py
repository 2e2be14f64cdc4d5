"""Choice by prediction: of several ways to explain a run, the one that predicts unseen rows best.

In goes what the search found, with its task; out comes a `Choice` (the ways that were tried, each
with its plain error of blocks left out, the choice made anew without each block) and the set that
was chosen, which from here on is the set that is reported, drawn and saved. Blocks follow how the
data are correlated: poses, set-ups, stretches of time longer than the memory of what is left.
"""

from matstd.diagnosis.choice.chosen_set import choice_remarks, with_chosen_set
from matstd.diagnosis.choice.noise_memory import search_with_memory
from matstd.diagnosis.choice.prediction import Choice, candidate_effects, chosen_by_prediction

__all__ = [
    "Choice",
    "candidate_effects",
    "choice_remarks",
    "chosen_by_prediction",
    "search_with_memory",
    "with_chosen_set",
]
