"""What touches can and cannot tell apart: parameters and freedoms in words, and the files of them.

`IdentifiabilityReport` and what a fit determines (`Estimable`) go in, names and sentences of a
metrologist come out; identifiability.json and identification.json hold them beside their numbers.
"""

from report.identifiability.identifiability_file import write_identifiability
from report.identifiability.identifiability_words import (
    combination_words,
    family_words,
    freedom_words,
    gist,
    pair_words,
    reason_words,
    resolution_words,
)
from report.identifiability.identification_file import write_identification
from report.identifiability.parameter_words import in_words, short

__all__ = [
    "combination_words",
    "family_words",
    "freedom_words",
    "gist",
    "in_words",
    "pair_words",
    "reason_words",
    "resolution_words",
    "short",
    "write_identifiability",
    "write_identification",
]
