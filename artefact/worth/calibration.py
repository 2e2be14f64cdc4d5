"""What is not known of the features' own places after a calibration, as columns of a design.

A calibrated standard is known as well as its calibration: every patch may lie a little aside and
turned, the centre of every ball a little aside. All touches on one feature share these errors, so
more touches on it do not average them out. As columns with a prior of their own they are estimated
with everything else, and no criterion counts what stays unknown of them:

    patch   n^T (t + w x (p - c))    t three shifts, w three rotations about its centre c
    ball    n^T t                    t three shifts of its centre

Reference:
    JCGM 102:2011, 6 (input quantities that several observations share).
"""

from dataclasses import dataclass

import numpy as np

from artefact.body import Standard
from artefact.reach import Requests
from twin.errors import DesignError
from twin.frames import Array
from twin.units import UM, URAD


@dataclass(frozen=True)
class Calibration:
    """Standard uncertainties of the features' places in their calibration; zeros for none.

    The defaults are what a good coordinate measuring machine reaches on a part of this size.

    Attributes:
        patch: Of each coordinate of a freeform patch, mm.
        patch_tilt: Of each rotation of a patch, rad.
        ball: Of each coordinate of the centre of a datum sphere, mm.
    """

    patch: float = 1.0 * UM
    patch_tilt: float = 10.0 * URAD
    ball: float = 0.3 * UM

    def __post_init__(self) -> None:
        if min(self.patch, self.patch_tilt, self.ball) < 0.0:
            raise DesignError(f"calibration {self}, expected uncertainties from zero up")

    def columns(self, body: Standard, wanted: Requests) -> Array:
        """Deviation along the normals per standard uncertainty of every feature's place, (N, Q).

        Six columns a patch, three a sphere; none where the calibration is exact.

        Args:
            body: What is touched; touches on other features have zeros.
            wanted: The touches.
        """
        out = []
        for patch in body.patches if max(self.patch, self.patch_tilt) > 0.0 else ():
            mine = (wanted.feature == patch.name)[:, None] * wanted.normal
            arm = wanted.point - patch.T_artefact_patch[:3, 3]
            out += [self.patch * mine, self.patch_tilt * np.cross(arm, mine)]
        for sphere in body.spheres if self.ball > 0.0 else ():
            out.append(self.ball * (wanted.feature == sphere.name)[:, None] * wanted.normal)
        return np.concatenate(out, axis=1) if out else np.zeros((len(wanted), 0))
