"""A hand-placed standard of ten patches, for tests that need one before any optimiser ran."""

import numpy as np

from artefact.body.standard import Standard
from artefact.layout.sites import Frame, Site, standard_from_sites
from twin.units import DEG


def waves(seed: int, amplitude: float, count: int = 8) -> np.ndarray:
    """Smooth control heights: two crossed waves of random phase, (count, count), mm."""
    rng = np.random.default_rng(seed)
    x = np.linspace(-1.0, 1.0, count)
    u, v = np.meshgrid(x, x, indexing="ij")
    a, b = rng.uniform(0.0, 2.0 * np.pi, 2)
    return amplitude * (np.sin(2.4 * u + a) * np.cos(1.1 * v) + np.sin(2.2 * v + b))


def demo_sites() -> list[Site]:
    """One patch on top, four at 30 deg, five at 55 to 65 deg, at different heights."""
    sites = [Site(0.0, 0.0, 150.0, 0.0, (22.0, 22.0), waves(0, 2.5))]
    for i, height in enumerate((128.0, 120.0, 124.0, 116.0)):
        sites.append(
            Site((45 + 90 * i) * DEG, 62.0, height, 32 * DEG, (18.0, 20.0), waves(i + 1, 2.2))
        )
    for i, (tilt, height) in enumerate(((58, 82), (50, 74), (62, 88), (54, 78), (60, 84))):
        sites.append(
            Site((72 * i) * DEG, 104.0, height, tilt * DEG, (18.0, 22.0), waves(i + 5, 2.2))
        )
    return sites


def demo_standard() -> Standard:
    """The standard built from `demo_sites`."""
    return standard_from_sites("demo", demo_sites(), Frame())
