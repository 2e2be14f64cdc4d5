"""Models and results as files.

`model.toml` ("model/2") is read and written; `diagnosis.json`, `comparison.json`,
`identification.json` and the tables beside them are written. Numbers come from the results,
sentences from the caller: prose is made in `report`.
"""

from matstd.diagnosis.files.diagnosis_file import comparison_table, diagnosis_table
from matstd.diagnosis.files.law_file import law_table
from matstd.diagnosis.files.model_file import (
    SavedModel,
    check_machine,
    parsed_model,
    read_model,
)
from matstd.diagnosis.files.model_writer import model_of, model_text
from matstd.diagnosis.files.plan_file import plan_text, visit_text
from matstd.diagnosis.files.uncertainty_file import write_uncertainty

__all__ = [
    "SavedModel",
    "check_machine",
    "comparison_table",
    "diagnosis_table",
    "law_table",
    "model_of",
    "model_text",
    "parsed_model",
    "plan_text",
    "read_model",
    "visit_text",
    "write_uncertainty",
]
