"""What is wanted: the project file, checked against its machine before any work is done.

In: `project.toml` and the machine file it names, `task.toml`. Out: a `Project`, a `Task` in base
units. A new key is a
field of one of the tables, and a check beside it if it can contradict another.
"""

from matstd.artefact.brief.project_file import Project, read_project
from matstd.artefact.brief.standard_tables import (
    BASE_THICKNESS,
    CORNER_RADIUS,
    FEWEST_PATCHES,
    FINISHING,
    StandardTable,
)
from matstd.artefact.brief.task_file import Task, read_task
from matstd.artefact.brief.workshop_tables import BodyTable, ProbeTable

__all__ = [
    "BASE_THICKNESS",
    "CORNER_RADIUS",
    "FEWEST_PATCHES",
    "FINISHING",
    "BodyTable",
    "ProbeTable",
    "Project",
    "StandardTable",
    "Task",
    "read_project",
    "read_task",
]
