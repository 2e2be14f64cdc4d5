"""What touches on a mill of three linear axes and a table are worth."""

import numpy as np
import pytest

from matstd.artefact.layout import Blank
from matstd.artefact.reach import ProbeReach, ProbeShape
from matstd.artefact.worth import CriterionOptions, criterion_for
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.twin.machine import Axis, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM


@pytest.fixture(scope="session")
def criterion():
    mill = make_chain(
        "mill",
        "[w C' X' f Y Z t]",
        {n: Axis(range=(-400.0, 400.0)) for n in "XYZ"} | {"C": Axis((-200.0 * DEG, 200.0 * DEG))},
        (0.0, 0.0, -400.0),
    )
    limits = {"X": (-100.0, 100.0), "Y": (-100.0, 100.0), "Z": (-250.0, -50.0)}
    reach = ProbeReach(mill, Setup("a"), ProbeShape(3.0, ((80.0, 2.0), (160.0, 25.0))), 160.0)
    population, area = Population(mill), Workspace(mill, limits, 160.0)
    wanted = CriterionOptions(), 480, population
    rng = np.random.default_rng(4)
    return criterion_for(reach, population.model, Blank(), area, 1.0 * UM, rng, *wanted)
