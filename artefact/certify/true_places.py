"""A possible true standard: every feature displaced within its calibration uncertainty."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.worth import Calibration
from matstd.twin.frames import pose, rotation


def displaced_features(
    standard: Standard, known: Calibration, rng: np.random.Generator
) -> Standard:
    """Displace and rotate features at random by their calibration uncertainties."""
    patches = [
        replace(
            patch,
            T_artefact_patch=patch.T_artefact_patch
            @ pose(rotation(rng.normal(0.0, known.patch_tilt, 3)), rng.normal(0.0, known.patch, 3)),
        )
        for patch in standard.patches
    ]
    spheres = [
        replace(ball, centre=ball.centre + rng.normal(0.0, known.ball, 3))
        for ball in standard.spheres
    ]
    return replace(standard, patches=tuple(patches), spheres=tuple(spheres))
