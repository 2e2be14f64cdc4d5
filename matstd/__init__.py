"""One door to the tool: what the command line can do, three lines of Python can.

    import matstd

    found = matstd.diagnose("run.csv")
    found.save("diagnosis")
    found.compensate(tool_length=160.0).tables("tables")

Lengths are in mm, angles in rad, times in s, temperatures in °C; `UM`, `URAD`, `DEG` and `MINUTE`
are the units that files and figures have. Names are loaded when they are used. The rooms of the
library, `matstd.twin` and so on, stand behind them (docs/api.md).
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matstd.api.compensating import Compensation, ProgramOptions, compensate
    from matstd.api.designing import Project, Sensitivities
    from matstd.api.diagnosing import Comparison, Diagnosis, compare, diagnose
    from matstd.api.drifting import DriftLaws, DriftPrediction, learn_drift, predict_drift
    from matstd.api.evaluating import Evaluation, evaluate
    from matstd.api.learning import LearntLaws, learn
    from matstd.api.machines import (
        machine_file,
        machine_names,
        read_machine,
        sensitivities,
        volumetric,
    )
    from matstd.api.probing import Simulation, simulate, virtual_machine
    from matstd.api.replanning import Replanned, replan
    from matstd.api.runs import read_run
    from matstd.api.showing import MachinePage, show
    from matstd.api.standards import (
        Calibration,
        TaskBudget,
        calibrate,
        cmm_program,
        read_standard,
        uncertainty,
    )
    from matstd.api.trending import trend
    from matstd.artefact.body import Standard
    from matstd.compensation.field import State
    from matstd.diagnosis.answer import Verdict
    from matstd.diagnosis.files import SavedModel, read_model
    from matstd.diagnosis.fit import Fit
    from matstd.effect_kinds import register_effects
    from matstd.report.pages import Design
    from matstd.twin.errors import BadArgument, BadFile, DesignError, NotEnoughData
    from matstd.twin.files import write_run
    from matstd.twin.machine import Chain
    from matstd.twin.model import Effect, Model
    from matstd.twin.record import Run
    from matstd.twin.units import DEG, MINUTE, UM, URAD

_PLACES = {
    "api.compensating": ("Compensation", "ProgramOptions", "compensate"),
    "api.designing": ("Project", "Sensitivities"),
    "api.diagnosing": ("Comparison", "Diagnosis", "compare", "diagnose"),
    "api.drifting": ("DriftLaws", "DriftPrediction", "learn_drift", "predict_drift"),
    "api.learning": ("LearntLaws", "learn"),
    "api.machines": (
        "machine_file",
        "machine_names",
        "read_machine",
        "sensitivities",
        "volumetric",
    ),
    "api.evaluating": ("Evaluation", "evaluate"),
    "api.probing": ("Simulation", "simulate", "virtual_machine"),
    "api.replanning": ("Replanned", "replan"),
    "api.runs": ("read_run",),
    "effect_kinds": ("register_effects",),
    "api.showing": ("MachinePage", "show"),
    "api.standards": (
        "Calibration",
        "TaskBudget",
        "calibrate",
        "cmm_program",
        "read_standard",
        "uncertainty",
    ),
    "api.trending": ("trend",),
    "artefact.body": ("Standard",),
    "compensation.field": ("State",),
    "diagnosis.answer": ("Verdict",),
    "diagnosis.files": ("SavedModel", "read_model"),
    "diagnosis.fit": ("Fit",),
    "report.pages": ("Design",),
    "twin.errors": ("BadArgument", "BadFile", "DesignError", "NotEnoughData"),
    "twin.files": ("write_run",),
    "twin.machine": ("Chain",),
    "twin.model": ("Effect", "Model"),
    "twin.record": ("Run",),
    "twin.units": ("DEG", "MINUTE", "UM", "URAD"),
}
"""Names by the module that has them; a test compares them with the imports for type checkers."""

_MODULES = {name: module for module, names in _PLACES.items() for name in names}

__all__ = [
    "DEG",
    "MINUTE",
    "UM",
    "URAD",
    "BadArgument",
    "BadFile",
    "Calibration",
    "Chain",
    "Comparison",
    "Compensation",
    "Design",
    "DesignError",
    "Diagnosis",
    "DriftLaws",
    "DriftPrediction",
    "Effect",
    "Evaluation",
    "Fit",
    "LearntLaws",
    "MachinePage",
    "Model",
    "NotEnoughData",
    "ProgramOptions",
    "Project",
    "Replanned",
    "Run",
    "SavedModel",
    "Sensitivities",
    "Simulation",
    "Standard",
    "State",
    "TaskBudget",
    "Verdict",
    "calibrate",
    "cmm_program",
    "compare",
    "compensate",
    "diagnose",
    "evaluate",
    "learn",
    "learn_drift",
    "machine_file",
    "machine_names",
    "predict_drift",
    "read_machine",
    "read_model",
    "read_run",
    "read_standard",
    "register_effects",
    "replan",
    "sensitivities",
    "show",
    "simulate",
    "trend",
    "uncertainty",
    "virtual_machine",
    "volumetric",
    "write_run",
]


def __getattr__(name: str) -> Any:
    """A name of the door, loaded when it is first used (PEP 562)."""
    module = _MODULES.get(name)
    if module is None:
        raise AttributeError(f"module 'matstd' has no attribute {name!r}")
    import_module("matstd.api")  # results show themselves with the sentences of the report
    value = getattr(import_module(f"matstd.{module}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
