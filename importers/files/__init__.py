"""The project's own files from foreign tables: runs by a mapping file, machines to be checked."""

from matstd.importers.files.machine_draft import machine_text
from matstd.importers.files.mapping_file import MappedRun, import_mapped, mapped_run
from matstd.importers.files.row_times import timed_by_rows

__all__ = ["MappedRun", "import_mapped", "machine_text", "mapped_run", "timed_by_rows"]
