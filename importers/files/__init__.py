"""The project's own files from foreign tables: runs by a mapping file, machines to be checked."""

from matstd.importers.files.machine_draft import machine_text as machine_text
from matstd.importers.files.machine_draft import with_travels as with_travels
from matstd.importers.files.mapping_file import import_mapped as import_mapped
from matstd.importers.files.mapping_file import mapped_run as mapped_run
