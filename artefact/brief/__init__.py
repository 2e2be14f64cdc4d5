"""The request: the project file, checked against its machine and resolved once.

In: `project.toml`, the machine, task and mesh files that it names. Out: a `Brief` and a `Task` in
base units; no table of a file leaves this part. A new key is a field of one of the tables, a field
of the `Brief`, and a check beside it if it can contradict another.
"""

from matstd.artefact.brief.brief import Brief as Brief
from matstd.artefact.brief.brief import Goal as Goal
from matstd.artefact.brief.brief import PlacementOptions as PlacementOptions
from matstd.artefact.brief.brief import StudySettings as StudySettings
from matstd.artefact.brief.contradictions import design_machine as design_machine
from matstd.artefact.brief.project_file import project_text as project_text
from matstd.artefact.brief.project_file import read_project as read_project
from matstd.artefact.brief.standard_tables import FEWEST_PATCHES as FEWEST_PATCHES
from matstd.artefact.brief.standard_tables import FINISHING_RADIUS as FINISHING_RADIUS
from matstd.artefact.brief.standard_tables import LEAST_SIDE as LEAST_SIDE
from matstd.artefact.brief.standard_tables import base_of as base_of
from matstd.artefact.brief.task_file import Task as Task
from matstd.artefact.brief.task_file import read_task as read_task
from matstd.artefact.brief.workshop_tables import probe_models as probe_models
