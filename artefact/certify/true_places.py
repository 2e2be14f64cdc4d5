"""A standard as it may really be: every feature beside its calibrated place."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.worth import Calibration
from matstd.twin.frames import pose, rotation


def misplaced(standard: Standard, known: Calibration, rng: np.random.Generator) -> Standard:
    """Features displaced and turned at random, as much as a calibration leaves open.

    Args:
        standard: As calibrated.
        known: Standard uncertainties of its features' places.
        rng: Draws them.
    """
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
