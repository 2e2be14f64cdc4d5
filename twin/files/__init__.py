"""The border: users' files in, users' files out, in the units that stand in their names.

Readers end in frozen records in base units, or in one `BadFile` that names file, line or key, what
stood there and what was expected. Writers write whole files or none.
"""

from matstd.twin.files.error_file import errors_toml, read_errors
from matstd.twin.files.folder import results_folder
from matstd.twin.files.keys import Table, checked
from matstd.twin.files.machine_file import MachineTables, Pair, Vector, read_machine
from matstd.twin.files.pose_file import read_poses, reading_columns
from matstd.twin.files.run_file import SetupTable, read_run
from matstd.twin.files.run_writer import write_run
from matstd.twin.files.sensor_file import SensorRecord, read_sensors
from matstd.twin.files.slips import machine_questions, refuse_unit_slips
from matstd.twin.files.table import CsvTable
from matstd.twin.files.toml import (
    kind_of,
    parse_kind,
    read_any_text,
    read_text,
    read_toml,
)
from matstd.twin.files.whole import write_whole, written_whole

__all__ = [
    "CsvTable",
    "MachineTables",
    "Pair",
    "SensorRecord",
    "SetupTable",
    "Table",
    "Vector",
    "checked",
    "errors_toml",
    "kind_of",
    "machine_questions",
    "parse_kind",
    "read_any_text",
    "read_errors",
    "read_machine",
    "read_poses",
    "read_run",
    "read_sensors",
    "read_text",
    "read_toml",
    "reading_columns",
    "refuse_unit_slips",
    "results_folder",
    "write_run",
    "write_whole",
    "written_whole",
]
