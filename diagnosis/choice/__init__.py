"""Choice by prediction: of several ways to explain a run, the one that predicts unseen rows best.

In goes what the search found, with its task; out comes a `Choice` (the ways that were tried, each
with its plain error of blocks left out, the choice made anew without each block) and the set that
was chosen, which from here on is the set that is reported, drawn and saved. Blocks follow how the
data are correlated: poses, set-ups, stretches of time longer than the memory of what is left.
"""

from matstd.diagnosis.choice.chosen_set import choice_remarks as choice_remarks
from matstd.diagnosis.choice.chosen_set import with_chosen_set as with_chosen_set
from matstd.diagnosis.choice.noise_memory import search_with_memory as search_with_memory
from matstd.diagnosis.choice.prediction import Choice as Choice
from matstd.diagnosis.choice.prediction import candidate_effects as candidate_effects
from matstd.diagnosis.choice.prediction import chosen_by_prediction as chosen_by_prediction
