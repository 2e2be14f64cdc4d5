"""What a calibration makes of a standard, and which of its touches are like a user's task.

In: a `Standard` with touches on it. Out: the touches that prove a task, and standards that differ
from their calibration as much as it allows.
"""

from artefact.certify.task_places import curvature, like_task, on_faces
from artefact.certify.true_places import misplaced

__all__ = ["curvature", "like_task", "misplaced", "on_faces"]
