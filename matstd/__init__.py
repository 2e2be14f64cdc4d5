"""One door to the tool: what the command line can do, three lines of Python can.

    import matstd

    found = matstd.diagnose("run.csv")
    found.save("diagnosis")
    found.compensate(tool_length=160.0).tables("tables")

Lengths are in mm, angles in rad, times in s, temperatures in °C; `UM`, `URAD`, `DEG` and `MINUTE`
are the units that files and figures have. Names are loaded when they are used. The rooms of the
library, `matstd.twin` and so on, stand behind them (docs/api.md).
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # `as` the same name exports it (PEP 484)
    from matstd.api.compensating import Compensation as Compensation
    from matstd.api.compensating import ProgramOptions as ProgramOptions
    from matstd.api.compensating import compensate as compensate
    from matstd.api.designing import Project as Project
    from matstd.api.designing import Sensitivities as Sensitivities
    from matstd.api.diagnosing import Comparison as Comparison
    from matstd.api.diagnosing import Diagnosis as Diagnosis
    from matstd.api.diagnosing import compare as compare
    from matstd.api.diagnosing import diagnose as diagnose
    from matstd.api.drifting import DriftLaws as DriftLaws
    from matstd.api.drifting import DriftPrediction as DriftPrediction
    from matstd.api.drifting import learn_drift as learn_drift
    from matstd.api.drifting import predict_drift as predict_drift
    from matstd.api.evaluating import Evaluation as Evaluation
    from matstd.api.evaluating import evaluate as evaluate
    from matstd.api.learning import LearntLaws as LearntLaws
    from matstd.api.learning import learn as learn
    from matstd.api.machines import machine_file as machine_file
    from matstd.api.machines import machine_names as machine_names
    from matstd.api.machines import read_machine as read_machine
    from matstd.api.machines import sensitivities as sensitivities
    from matstd.api.machines import volumetric as volumetric
    from matstd.api.probing import Simulation as Simulation
    from matstd.api.probing import simulate as simulate
    from matstd.api.probing import virtual_machine as virtual_machine
    from matstd.api.replanning import Replanned as Replanned
    from matstd.api.replanning import replan as replan
    from matstd.api.runs import read_run as read_run
    from matstd.api.showing import MachinePage as MachinePage
    from matstd.api.showing import show as show
    from matstd.api.standards import Calibration as Calibration
    from matstd.api.standards import TaskBudget as TaskBudget
    from matstd.api.standards import calibrate as calibrate
    from matstd.api.standards import cmm_program as cmm_program
    from matstd.api.standards import read_standard as read_standard
    from matstd.api.standards import uncertainty as uncertainty
    from matstd.api.trending import trend as trend
    from matstd.artefact.body import Standard as Standard
    from matstd.compensation.field import State as State
    from matstd.diagnosis.answer import Verdict as Verdict
    from matstd.diagnosis.files import SavedModel as SavedModel
    from matstd.diagnosis.files import read_model as read_model
    from matstd.diagnosis.fit import Fit as Fit
    from matstd.effect_kinds import register_effects as register_effects
    from matstd.report.pages import Design as Design
    from matstd.twin.errors import BadArgument as BadArgument
    from matstd.twin.errors import BadFile as BadFile
    from matstd.twin.errors import DesignError as DesignError
    from matstd.twin.errors import NotEnoughData as NotEnoughData
    from matstd.twin.files import write_run as write_run
    from matstd.twin.machine import Chain as Chain
    from matstd.twin.model import Effect as Effect
    from matstd.twin.model import Model as Model
    from matstd.twin.record import Run as Run
    from matstd.twin.units import DEG as DEG
    from matstd.twin.units import MINUTE as MINUTE
    from matstd.twin.units import UM as UM
    from matstd.twin.units import URAD as URAD

_MODULES = {
    alias.name: str(node.module)
    for node in ast.walk(ast.parse(Path(__file__).read_text(encoding="utf-8")))
    if isinstance(node, ast.ImportFrom)
    for alias in node.names
    if alias.asname
}
"""Module of every name, read from the imports above: they are the one list of the door."""

__all__ = sorted(_MODULES)


def __getattr__(name: str) -> Any:
    """A name of the door, loaded when it is first used (PEP 562)."""
    module = _MODULES.get(name)
    if module is None:
        raise AttributeError(f"module 'matstd' has no attribute {name!r}")
    import_module("matstd.api")  # results show themselves with the sentences of the report
    value = getattr(import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
