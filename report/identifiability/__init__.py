"""What touches can and cannot determine of a machine, in words and in result files.

Names of parameters, known combinations, freedoms with their causes and remedies;
`identifiability.json` and `identification.json`.
"""

from matstd.report.identifiability.identifiability_file import (
    identifiability_table as identifiability_table,
)
from matstd.report.identifiability.identifiability_words import (
    combination_words as combination_words,
)
from matstd.report.identifiability.identifiability_words import family_words as family_words
from matstd.report.identifiability.identifiability_words import freedom_words as freedom_words
from matstd.report.identifiability.identifiability_words import gist as gist
from matstd.report.identifiability.identifiability_words import in_words as in_words
from matstd.report.identifiability.identifiability_words import pair_words as pair_words
from matstd.report.identifiability.identifiability_words import reason_words as reason_words
from matstd.report.identifiability.identifiability_words import resolution_words as resolution_words
from matstd.report.identifiability.identifiability_words import short as short
from matstd.report.identifiability.identification_file import (
    write_identification as write_identification,
)
