"""Poses that fill a workspace: strata, volumes, limits."""

import numpy as np
import pytest

from matstd.sensitivity.first_order import Workspace, latin_hypercube, section
from matstd.twin.errors import DesignError, NotReachable, OutsideTravel, UnknownAxis
from matstd.twin.machine import tip
from matstd.twin.units import DEG

LENGTH = 160.0
VOLUME = ((-100.0, -100.0, 20.0), (100.0, 100.0, 150.0))


def test_every_stratum_of_every_reading_is_used_once(workspace, chain):
    q = latin_hypercube(workspace, 50, np.random.default_rng(1))
    for axis in chain.programmed_axes:
        low, high = workspace.limit(axis)
        stratum = np.floor(50 * (q[:, chain.axis_index(axis)] - low) / (high - low)).astype(int)
        assert sorted(stratum) == list(range(50))
    assert np.all(q[:, chain.axis_index("C1")] == 0.0)


def test_the_tool_point_stays_in_the_volume(chain):
    limits = {"B": (-90.0 * DEG, 20.0 * DEG), "C": (-90.0 * DEG, 90.0 * DEG)}
    area = Workspace(chain, limits, LENGTH, VOLUME)
    q = latin_hypercube(area, 300, np.random.default_rng(2))
    assert q.shape == (300, 6)
    p = tip(chain, q, LENGTH)
    assert np.all(p >= np.array(VOLUME[0]) - 1e-9)
    assert np.all(p <= np.array(VOLUME[1]) + 1e-9)
    assert p.std(axis=0) == pytest.approx([58, 58, 37], abs=6)  # even over the box: width/sqrt(12)
    for i, axis in enumerate(chain.axes):
        low, high = area.limit(axis)
        assert np.all((q[:, i] >= low - 1e-9) & (q[:, i] <= high + 1e-9))


def test_a_section_spans_two_readings(chain, workspace):
    a, b, plane = section(workspace, "X", "C", 4)
    np.testing.assert_array_equal(plane[:4, chain.axis_index("X")], a[0])
    np.testing.assert_array_equal(plane[:4, chain.axis_index("C")], b)
    assert np.unique(plane[:, chain.axis_index("Z")]).tolist() == [-275.0]
    base = np.arange(6.0)
    held = section(workspace, "X", "C", 4, base)[2]
    assert np.all(held[:, chain.axis_index("Y")] == base[chain.axis_index("Y")])


def test_an_axis_without_room_has_one_value(chain):
    area = Workspace(chain, {"B": (0.0, 0.0)}, LENGTH)
    assert "B" not in area.open_axes
    assert np.all(latin_hypercube(area, 5, np.random.default_rng(1))[:, chain.axis_index("B")] == 0)


def test_workspaces_that_cannot_be_are_refused(chain):
    with pytest.raises(UnknownAxis, match="'A'"):
        Workspace(chain, {"A": (0.0, 1.0)})
    with pytest.raises(OutsideTravel, match="-400 to 400"):
        Workspace(chain, {"X": (-500.0, 0.0)})
    with pytest.raises(DesignError, match="smaller one first"):
        Workspace(chain, {"X": (10.0, -10.0)})
    far = Workspace(chain, {}, LENGTH, ((2000.0, 0.0, 0.0), (2100.0, 10.0, 10.0)))
    with pytest.raises(NotReachable, match=r"only 0 of \d+ poses have their tool point in"):
        latin_hypercube(far, 10, np.random.default_rng(1))
