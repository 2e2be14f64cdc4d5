"""The thresholds by which a diagnosis decides, each once, with its reason.

In: nothing. Out: `POLICY`, a frozen `Policy`, which every test reads and which `diagnosis.json`
repeats, so that a result says by what it was decided. Sizes of grids and limits of work, which
change the time and not the decision, stand where they are used.
"""

from matstd.diagnosis.policy.policy import POLICY as POLICY
from matstd.diagnosis.policy.policy import Policy as Policy
