"""What faces see of the worst poses, against least squares by hand on a criterion of two errors."""

from types import SimpleNamespace

import numpy as np
import pytest

from matstd.artefact.compare import regions as room
from matstd.information.criteria import Posterior
from matstd.twin.units import UM


@pytest.fixture
def criterion(monkeypatch):
    """Two errors of 10 and 20 µm: X reads the first, Y the second, at poses numbered by q."""
    expected = np.array([10.0, 20.0]) * UM
    tips = np.zeros((20, 3, 2))
    tips[:10, 0, 0] = 1.0
    tips[10:, 1, 1] = 1.0
    monkeypatch.setattr(room, "at_poses", lambda chain, q, length: q[:, 0].astype(int))
    model = SimpleNamespace(tip_columns=lambda at: tips[at], prior_sd=expected, names=("a", "b"))
    rows = {"first": [[1.0, 0.0]] * 4, "both": [[1.0, 0.0]] * 4 + [[0.0, 1.0]] * 4}
    return SimpleNamespace(
        reach=SimpleNamespace(chain=None, length=160.0),
        model=model,
        after=lambda which: Posterior(
            np.array(rows[which]) * expected / (0.5 * UM), expected, model.names
        ),
    )


@pytest.mark.parametrize(("touched", "left", "seen"), [("first", 20.0, 0.0), ("both", 0.25, 1.0)])
def test_the_worst_poses_are_looked_at_and_what_stays_there(criterion, touched, left, seen):
    q = np.arange(20.0)[:, None]
    recurrence = np.where(q[:, 0] == 13.0, 0.6, 0.02)
    found = room.worst_regions(criterion, touched, q, recurrence)
    assert found.poses == 1
    assert found.recurrence == pytest.approx(0.6)
    assert found.before == pytest.approx(20.0 * UM)
    # four touches of 0.5 µm on an error expected at 20 µm
    by_hand = 1.0 / np.sqrt(1.0 / 20.0**2 + 4.0 / 0.5**2) if seen else 20.0
    assert found.after == pytest.approx(by_hand * UM)
    assert found.after == pytest.approx(left * UM, rel=1e-3)
    assert found.covered == seen
