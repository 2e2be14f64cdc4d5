"""Machines and workspaces that the sensitivities are tested on."""

import pytest

from sensitivity.first_order.workspace import Workspace
from twin.machine.chain import Axis, Chain, make_chain
from twin.units import DEG

LENGTH = 160.0


@pytest.fixture(scope="session")
def chain() -> Chain:
    """The HSM 600U with the numbers of its example file."""
    return make_chain(
        "HSM 600U",
        "[w C' B' X' f Y Z (C1) t]",
        {
            "X": Axis(range=(-400.0, 400.0)),
            "Y": Axis(range=(-300.0, 300.0)),
            "Z": Axis(range=(-500.0, 0.0)),
            "B": Axis(range=(-110.0 * DEG, 30.0 * DEG), point=(0.0, 0.0, -420.0)),
            "C": Axis(range=(-360.0 * DEG, 360.0 * DEG)),
        },
        (0.0, 0.0, -500.0),
    )


@pytest.fixture(scope="session")
def workspace(chain: Chain) -> Workspace:
    """A workspace about as large as a standard."""
    limits = {
        "X": (-150.0, 150.0),
        "Y": (-150.0, 150.0),
        "Z": (-400.0, -150.0),
        "B": (-90.0 * DEG, 20.0 * DEG),
        "C": (-180.0 * DEG, 180.0 * DEG),
    }
    return Workspace(chain, limits, LENGTH)
