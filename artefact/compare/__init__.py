"""A standard compared with other artefacts, stylus lengths and set-ups, at equal touches.

In: a criterion and the touches of a design. Out: the figures of every `Rival`, and what the
touches can and cannot determine (`IdentifiabilityReport`), with what would resolve the rest.
"""

from matstd.artefact.compare.alternatives import Alternative as Alternative
from matstd.artefact.compare.comparison import Rival as Rival
from matstd.artefact.compare.comparison import compared as compared
from matstd.artefact.compare.comparison import evaluate_rival as evaluate_rival
from matstd.artefact.compare.comparison import prior_rms as prior_rms
from matstd.artefact.compare.comparison import random_lots as random_lots
from matstd.artefact.compare.identifiability import IdentifiabilityReport as IdentifiabilityReport
from matstd.artefact.compare.identifiability import identifiability_report as identifiability_report
from matstd.artefact.compare.power import DETECTION_POWER as DETECTION_POWER
from matstd.artefact.compare.power import FALSE_ALARM as FALSE_ALARM
from matstd.artefact.compare.power import MODEL_ERROR as MODEL_ERROR
from matstd.artefact.compare.power import Power as Power
from matstd.artefact.compare.power import proof_power as proof_power
from matstd.artefact.compare.power import task_normals as task_normals
from matstd.artefact.compare.regions import WorstRegions as WorstRegions
from matstd.artefact.compare.regions import worst_regions as worst_regions
