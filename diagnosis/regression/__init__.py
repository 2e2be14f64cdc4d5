"""Regression with a prior, and the noise about it: what every fit below and above rests on.

In: columns, deviations and weights as arrays. Out: a `Solution` with its covariance, errors of rows
that were left out, gross errors, and noise that remembers, with a `Whitener` that makes its rows
independent. Nothing here knows a machine.
"""

from matstd.diagnosis.regression.f_test import f_probability as f_probability
from matstd.diagnosis.regression.f_test import f_tail as f_tail
from matstd.diagnosis.regression.features import Features as Features
from matstd.diagnosis.regression.features import robust_scale as robust_scale
from matstd.diagnosis.regression.gross import GrossErrors as GrossErrors
from matstd.diagnosis.regression.gross import find_gross as find_gross
from matstd.diagnosis.regression.gross import shots as shots
from matstd.diagnosis.regression.linear import LeftOut as LeftOut
from matstd.diagnosis.regression.linear import Solution as Solution
from matstd.diagnosis.regression.linear import left_out as left_out
from matstd.diagnosis.regression.linear import solve as solve
from matstd.diagnosis.regression.memory import Memory as Memory
from matstd.diagnosis.regression.memory import Whitener as Whitener
from matstd.diagnosis.regression.memory import likely_memory as likely_memory
from matstd.diagnosis.regression.memory import whitener as whitener
from matstd.diagnosis.regression.noise import PRIOR_DOF as PRIOR_DOF
from matstd.diagnosis.regression.noise import Noise as Noise
from matstd.diagnosis.regression.noise import noise_factor as noise_factor
from matstd.diagnosis.regression.noise import places_of as places_of
from matstd.diagnosis.regression.noise import replicate_factor as replicate_factor
