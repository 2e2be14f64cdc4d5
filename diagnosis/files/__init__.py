"""Models and results as files.

`model.toml` ("model/2") is read and written; `diagnosis.json`, `comparison.json`,
`identification.json` and the tables beside them are written. Numbers come from the results,
sentences from the caller: prose is made in `report`.
"""

from matstd.diagnosis.files.diagnosis_file import comparison_table as comparison_table
from matstd.diagnosis.files.diagnosis_file import diagnosis_table as diagnosis_table
from matstd.diagnosis.files.law_file import law_table as law_table
from matstd.diagnosis.files.model_file import SavedModel as SavedModel
from matstd.diagnosis.files.model_file import check_machine as check_machine
from matstd.diagnosis.files.model_file import parsed_model as parsed_model
from matstd.diagnosis.files.model_file import read_model as read_model
from matstd.diagnosis.files.model_writer import model_of as model_of
from matstd.diagnosis.files.model_writer import model_text as model_text
from matstd.diagnosis.files.plan_file import plan_text as plan_text
from matstd.diagnosis.files.plan_file import visit_text as visit_text
from matstd.diagnosis.files.uncertainty_file import write_uncertainty as write_uncertainty
