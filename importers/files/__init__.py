"""The project's own files from foreign tables: runs by a mapping file, machines to be checked."""

from matstd.importers.files.machine_draft import machine_text, with_travels
from matstd.importers.files.mapping_file import import_mapped, mapped_run

__all__ = ["import_mapped", "machine_text", "mapped_run", "with_travels"]
