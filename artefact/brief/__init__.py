"""What is wanted: the project file."""

from artefact.brief.project_file import Project, read_project
from artefact.brief.standard_tables import BASE_THICKNESS, CORNER_RADIUS

__all__ = ["BASE_THICKNESS", "CORNER_RADIUS", "Project", "read_project"]
