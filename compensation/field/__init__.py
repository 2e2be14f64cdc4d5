"""The error field of a machine, its exact inverse, and what a compensation leaves of it.

In: a `SavedModel` and the `State` in which the machine works. Out: `MachineErrors`, the readings
that correct them (`correction`), and the `Result` of any compensation over a workspace. Whatever
corrects, a program, a table, a service, ends in one thing: readings that are added
(`CorrectionFunction`).
"""

from matstd.compensation.field.inverse import Datum as Datum
from matstd.compensation.field.inverse import correction as correction
from matstd.compensation.field.inverse import datum_of as datum_of
from matstd.compensation.field.inverse import deviation_after as deviation_after
from matstd.compensation.field.inverse import shifted as shifted
from matstd.compensation.field.machine_errors import CorrectionFunction as CorrectionFunction
from matstd.compensation.field.machine_errors import MachineErrors as MachineErrors
from matstd.compensation.field.machine_errors import actual_tip as actual_tip
from matstd.compensation.field.machine_errors import deviation as deviation
from matstd.compensation.field.over_workspace import Result as Result
from matstd.compensation.field.over_workspace import Share as Share
from matstd.compensation.field.over_workspace import UncorrectedError as UncorrectedError
from matstd.compensation.field.over_workspace import aligned as aligned
from matstd.compensation.field.over_workspace import contributions as contributions
from matstd.compensation.field.over_workspace import feels_direction as feels_direction
from matstd.compensation.field.over_workspace import in_both_directions as in_both_directions
from matstd.compensation.field.over_workspace import relative_columns as relative_columns
from matstd.compensation.field.over_workspace import result_of as result_of
from matstd.compensation.field.over_workspace import sample_workspace as sample_workspace
from matstd.compensation.field.state import State as State
