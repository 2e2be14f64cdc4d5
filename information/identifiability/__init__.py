"""What touches can and cannot separate."""

from information.identifiability.correlation import STRONG, Ties, ties
from information.identifiability.degrees import Degree, supported_degrees
from information.identifiability.estimable_combinations import EstimableCombination, combinations
from information.identifiability.freedom_words import Freedom, FreedomWords, in_families
from information.identifiability.nullspace import seen
from information.identifiability.parameter_words import in_words, short
from information.identifiability.separation import NEVER, Identifiability, identifiability

__all__ = [
    "NEVER",
    "STRONG",
    "Degree",
    "EstimableCombination",
    "Freedom",
    "FreedomWords",
    "Identifiability",
    "Ties",
    "combinations",
    "identifiability",
    "in_families",
    "in_words",
    "seen",
    "short",
    "supported_degrees",
    "ties",
]
