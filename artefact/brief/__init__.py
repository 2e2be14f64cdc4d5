"""The request: the project file, checked against its machine and resolved once.

In: `project.toml`, the machine, task and mesh files that it names. Out: a `Brief` and a `Task` in
base units; no table of a file leaves this part. A new key is a field of one of the tables, a field
of the `Brief`, and a check beside it if it can contradict another.
"""

from matstd.artefact.brief.brief import (
    Brief,
    Goal,
    PlacementOptions,
    ProgramSettings,
    StudySettings,
)
from matstd.artefact.brief.project_file import read_project
from matstd.artefact.brief.project_writer import project_text
from matstd.artefact.brief.standard_tables import (
    FEWEST_PATCHES,
    FINISHING_RADIUS,
    LEAST_SIDE,
    base_of,
)
from matstd.artefact.brief.task_file import Task, read_task
from matstd.artefact.brief.workshop_tables import probe_models

__all__ = [
    "FEWEST_PATCHES",
    "FINISHING_RADIUS",
    "LEAST_SIDE",
    "Brief",
    "Goal",
    "PlacementOptions",
    "ProgramSettings",
    "StudySettings",
    "Task",
    "base_of",
    "probe_models",
    "project_text",
    "read_project",
    "read_task",
]
