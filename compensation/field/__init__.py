"""The error field of a machine, its exact inverse, and what a compensation leaves of it.

In: a `SavedModel` and the `State` in which the machine works. Out: `MachineErrors`, the readings
that correct them (`correction`), and the `Result` of any compensation over a workspace. Whatever
corrects, a program, a table, a service, ends in one thing: readings that are added
(`CorrectionFunction`).
"""

from matstd.compensation.field.inverse import Datum, correction, datum_of, deviation_after, shifted
from matstd.compensation.field.machine_errors import (
    CorrectionFunction,
    MachineErrors,
    actual_tip,
    deviation,
)
from matstd.compensation.field.over_workspace import (
    Result,
    Share,
    UncorrectedError,
    aligned,
    contributions,
    relative_columns,
    result_of,
    sample_workspace,
)
from matstd.compensation.field.state import State

__all__ = [
    "CorrectionFunction",
    "Datum",
    "MachineErrors",
    "Result",
    "Share",
    "State",
    "UncorrectedError",
    "actual_tip",
    "aligned",
    "contributions",
    "correction",
    "datum_of",
    "deviation",
    "deviation_after",
    "relative_columns",
    "result_of",
    "sample_workspace",
    "shifted",
]
