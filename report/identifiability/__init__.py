"""What touches can and cannot determine of a machine, in words and in result files.

Names of parameters, known combinations, freedoms with their causes and remedies;
`identifiability.json` and `identification.json`.
"""

from matstd.report.identifiability.identifiability_file import identifiability_table
from matstd.report.identifiability.identifiability_words import (
    combination_words,
    family_words,
    freedom_words,
    gist,
    pair_words,
    reason_words,
    resolution_words,
)
from matstd.report.identifiability.identification_file import write_identification
from matstd.report.identifiability.parameter_words import in_words, short

__all__ = [
    "combination_words",
    "family_words",
    "freedom_words",
    "gist",
    "identifiability_table",
    "in_words",
    "pair_words",
    "reason_words",
    "resolution_words",
    "short",
    "write_identification",
]
