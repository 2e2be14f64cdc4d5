"""The project's own files made from foreign tables: runs by a mapping file, machines to check."""

from matstd.importers.files.machine_draft import machine_text
from matstd.importers.files.mapping_file import MappingTable, mapped_run

__all__ = ["MappingTable", "machine_text", "mapped_run"]
