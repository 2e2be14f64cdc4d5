"""The border: users' files in, users' files out, in the units that stand in their names.

Readers end in frozen records in base units, or in one `BadFile` that names file, line or key, what
stood there and what was expected. Writers write whole files or none.
"""

from matstd.twin.files.error_file import errors_toml as errors_toml
from matstd.twin.files.error_file import read_errors as read_errors
from matstd.twin.files.folder import results_folder as results_folder
from matstd.twin.files.keys import Table as Table
from matstd.twin.files.keys import checked as checked
from matstd.twin.files.machine_file import MachineTables as MachineTables
from matstd.twin.files.machine_file import Pair as Pair
from matstd.twin.files.machine_file import Vector as Vector
from matstd.twin.files.machine_file import read_machine as read_machine
from matstd.twin.files.pose_file import read_poses as read_poses
from matstd.twin.files.pose_file import reading_columns as reading_columns
from matstd.twin.files.run_file import SetupTable as SetupTable
from matstd.twin.files.run_file import read_run as read_run
from matstd.twin.files.run_writer import write_run as write_run
from matstd.twin.files.sensor_file import SensorRecord as SensorRecord
from matstd.twin.files.sensor_file import read_sensors as read_sensors
from matstd.twin.files.slips import machine_questions as machine_questions
from matstd.twin.files.slips import refuse_unit_slips as refuse_unit_slips
from matstd.twin.files.table import CsvTable as CsvTable
from matstd.twin.files.toml import kind_of as kind_of
from matstd.twin.files.toml import parse_kind as parse_kind
from matstd.twin.files.toml import read_any_text as read_any_text
from matstd.twin.files.toml import read_text as read_text
from matstd.twin.files.toml import read_toml as read_toml
from matstd.twin.files.whole import write_whole as write_whole
from matstd.twin.files.whole import written_whole as written_whole
