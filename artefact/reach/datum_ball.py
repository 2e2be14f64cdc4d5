"""A calibrated ball on the table beside the standard, by which the probe is watched.

It belongs to the workshop: programs that measure keep clear of it, and one program touches it as if
it were a feature of the standard.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import DatumSphere, Standard
from matstd.artefact.reach.face_of_table import table_face
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, apply, inverse

DATUM = "DATUM"  # name of the feature
_UPRIGHT = 1e-6  # of the standard's z against that of the table's face


@dataclass(frozen=True)
class DatumBall:
    """The ball, in the frame of the table's face."""

    x: float  # of its centre, mm
    y: float  # of its centre, mm
    z: float  # of its centre above the origin of the frame, mm
    radius: float  # as calibrated, mm
    stem: float  # radius of its stem, mm
    low: float = 0.0  # height of the table's face, where the stem begins, mm
    u: float = 0.0  # standard uncertainty of the radius, mm

    def sphere(self, T_table_artefact: Array) -> DatumSphere:
        """The ball as a feature of a standard that stands somewhere.

        Raises:
            DesignError: A standard that does not stand upright: stems of its balls do.
        """
        T_artefact_face = inverse(T_table_artefact) @ table_face(T_table_artefact)
        if T_artefact_face[2, 2] < 1.0 - _UPRIGHT:
            raise DesignError("a datum ball beside a standard that is tilted: expected it upright")
        places = np.array([[self.x, self.y, self.z], [self.x, self.y, self.low]])
        centre, foot = apply(T_artefact_face, places)
        return DatumSphere(
            name=DATUM,
            centre=centre,
            radius=self.radius,
            stem_radius=self.stem,
            foot_radius=self.stem,
            foot=float(foot[2]),
        )

    def beside(self, standard: Standard, T_table_artefact: Array) -> Standard:
        """A standard that stands somewhere, with the ball as its last sphere."""
        return replace(standard, spheres=(*standard.spheres, self.sphere(T_table_artefact)))
