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

from matstd.artefact.body import Standard
from matstd.artefact.reach import Requests
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.units import UM, URAD


@dataclass(frozen=True)
class Calibration:
    """Standard uncertainties of the features' places in their calibration; zeros for none.

    The defaults are what a good coordinate measuring machine reaches on a part of this size.
    """

    patch: float = 1.0 * UM  # of each coordinate of a freeform patch, mm
    patch_tilt: float = 10.0 * URAD  # of each rotation of a patch, rad
    ball: float = 0.3 * UM  # of each coordinate of the centre of a datum sphere, mm
    # of all lengths, relative, one error that every feature shares. It is no column: with the
    # temperature it belongs to the body of a run (`Body`), which every fit has.
    scale: float = 1e-6
    # of the surface of a face at a point, beside its place; points nearby share it, mm
    form: float = 0.3 * UM

    def __post_init__(self) -> None:
        sizes = (self.patch, self.patch_tilt, self.ball, self.scale, self.form)
        if min(sizes) < 0.0:
            raise DesignError(f"calibration {self}, expected uncertainties from zero up")

    @staticmethod
    def _of(body: Standard, name: str, assumed: tuple[float, float]) -> tuple[Array, float]:
        """Uncertainty of place (3,) and rotations of a feature: as calibrated, else as assumed."""
        if body.known is None or name not in body.known.features:
            return np.full(3, assumed[0]), assumed[1]
        feature = body.known.features[name]
        return np.array(feature.along), feature.u_tilt

    def columns(self, body: Standard, wanted: Requests) -> Array:
        """Deviation along the normals per standard uncertainty of every feature's place, (N, Q).

        What the body itself was calibrated to goes before what is assumed here. Six columns a
        patch, three a sphere; none where the calibration is exact.

        Args:
            body: What is touched; touches on other features have zeros.
        """
        out = []
        for patch in body.patches:
            place, tilt = self._of(body, patch.name, (self.patch, self.patch_tilt))
            if max(place.max(), tilt) > 0.0:
                mine = (wanted.feature == patch.name)[:, None] * wanted.normal
                arm = wanted.point - patch.T_artefact_patch[:3, 3]
                out += [place * mine, tilt * np.cross(arm, mine)]
        for sphere in body.spheres:
            place, _ = self._of(body, sphere.name, (self.ball, 0.0))
            if place.max() > 0.0:
                out.append(place * (wanted.feature == sphere.name)[:, None] * wanted.normal)
        return np.concatenate(out, axis=1) if out else np.zeros((len(wanted), 0))
