"""Regression with a prior, and the noise about it: what every fit below and above rests on.

In: columns, deviations and weights as arrays. Out: a `Solution` with its covariance, errors of rows
that were left out, gross errors, and noise that remembers, with a `Whitener` that makes its rows
independent. Nothing here knows a machine.
"""

from matstd.diagnosis.regression.f_test import f_probability, f_tail
from matstd.diagnosis.regression.gross import (
    GrossErrors,
    find_gross,
    robust_scale,
    shots,
)
from matstd.diagnosis.regression.linear import LeftOut, Solution, left_out, solve
from matstd.diagnosis.regression.memory import (
    Memory,
    Whitener,
    likely_memory,
    whitener,
)
from matstd.diagnosis.regression.noise import (
    PRIOR_DOF,
    Noise,
    noise_factor,
    places_of,
    replicate_factor,
)

__all__ = [
    "PRIOR_DOF",
    "GrossErrors",
    "LeftOut",
    "Memory",
    "Noise",
    "Solution",
    "Whitener",
    "f_probability",
    "f_tail",
    "find_gross",
    "left_out",
    "likely_memory",
    "noise_factor",
    "places_of",
    "replicate_factor",
    "robust_scale",
    "shots",
    "solve",
    "whitener",
]
