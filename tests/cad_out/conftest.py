"""Standards for the CAD tests, and one export of a small one that many tests look at."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from artefact.body.standard import Base
from artefact.layout.sites import Fittings, Frame, Site, standard_from_sites
from cad_out.verify.export import build_and_measure
from twin.units import DEG

demo = runpy.run_path(str(Path(__file__).parent.parent / "artefact" / "demo.py"))


@pytest.fixture(scope="session")
def standard():
    """Ten patches on a plate."""
    return demo["demo_standard"]()


@pytest.fixture(scope="session")
def small():
    """Three patches on a disc: upright, tilted into the base, tilted into the core."""
    waves = demo["waves"]
    sites = [
        Site(10 * DEG, 45.0, 70.0, 0.0, (14.0, 11.0), waves(0, 1.0)),
        Site(130 * DEG, 50.0, 62.0, 25 * DEG, (12.0, 12.0), waves(1, 1.0), spin=20 * DEG),
        Site(250 * DEG, 60.0, 66.0, 60 * DEG, (11.0, 13.0), waves(2, 1.0), degree=(3, 4)),
    ]
    frame = Frame(base=Base((90.0, 90.0), 90.0, 25.0), fittings=Fittings(hole_count=3))
    return standard_from_sites("small", sites, frame, serial="0007")


@pytest.fixture(scope="session")
def built(small, tmp_path_factory):
    """Folder, measured figures and mesh of the small standard."""
    place = tmp_path_factory.mktemp("built")
    conformity, mesh = build_and_measure(small, place, chord=0.02)
    return place, conformity, mesh


@pytest.fixture(scope="session")
def random_standard():
    """Makes a standard of random sites that keeps its limits, from a seed."""
    from artefact.body.constraints import Limits, check
    from twin.errors import NotBuildable

    def make(seed):
        rng = np.random.default_rng(seed)
        for _ in range(400):
            sites = []
            for k in range(int(rng.integers(5, 10))):
                tilt = rng.uniform(0.0, 65.0) * DEG
                radius = rng.uniform(20.0, 110.0) if k else 0.0
                sites.append(
                    Site(
                        azimuth=rng.uniform(0.0, 2.0 * np.pi),
                        radius=radius,
                        height=rng.uniform(60.0, 150.0),
                        tilt=tilt if k else 0.0,
                        half_size=tuple(rng.uniform(10.0, 20.0, 2)),
                        heights=demo["waves"](int(rng.integers(1 << 30)), rng.uniform(0.3, 1.5)),
                        spin=rng.uniform(-np.pi, np.pi),
                        lean=rng.uniform(-5.0, 5.0) * DEG,
                        degree=(int(rng.integers(3, 6)), int(rng.integers(3, 6))),
                    )
                )
            try:
                standard = standard_from_sites(f"random{seed}", sites)
                check(standard, Limits())
            except NotBuildable:
                continue
            return standard
        raise AssertionError("no random layout fits")

    return make
