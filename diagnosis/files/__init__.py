"""Models and results as files."""

from diagnosis.files.diagnosis_file import (
    plan_text,
    write_comparison,
    write_diagnosis,
    write_residuals,
)
from diagnosis.files.model_file import SavedModel, check_machine, read_model
from diagnosis.files.model_writer import write_model

__all__ = [
    "SavedModel",
    "check_machine",
    "plan_text",
    "read_model",
    "write_comparison",
    "write_diagnosis",
    "write_model",
    "write_residuals",
]
