"""Faults of the description: what users get wrong in a machine file or a run, tried and named.

In: a run whose deviations are absurd, or whose prior had to be widened. Out: every
`DescriptionFault` that would make the run fit, with the figures. It is reported and never applied.
"""

from matstd.diagnosis.faults.suspects import Fault as Fault
from matstd.diagnosis.faults.trial import DescriptionFault as DescriptionFault
from matstd.diagnosis.faults.trial import description_faults as description_faults
from matstd.diagnosis.faults.trial import faults_of_refused as faults_of_refused
