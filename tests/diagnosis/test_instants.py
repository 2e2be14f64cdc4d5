"""Rows of one instant count together: chances of what an effect explains in poses of three rows."""

from types import SimpleNamespace

import numpy as np
import pytest

from matstd.diagnosis.search.members import p_by_instants

POSES, ROWS = 60, 3


def chance(rng, shared, planted=0.0):
    """Probability of one column beside nothing; its noise is one number a pose, or one a row."""
    pose = np.repeat(np.arange(POSES), ROWS)
    lever = rng.normal(size=len(pose))
    column = lever * rng.normal(size=POSES)[pose]
    noise = lever * rng.normal(size=POSES)[pose] if shared else rng.normal(size=len(pose))
    residual = noise + planted * column
    left = residual - column * (column @ residual) / (column @ column)
    touches = SimpleNamespace(q=pose[:, None].astype(float), time=np.zeros(len(pose)))
    groups = tuple(np.split(np.arange(len(pose)), POSES))
    space = SimpleNamespace(touches=touches, used=np.ones(len(pose), dtype=bool), groups=groups)
    others = SimpleNamespace(A=np.zeros((len(pose), 0)), residual=residual)
    held_out = SimpleNamespace(error=left)
    return p_by_instants(
        others, SimpleNamespace(A=column[:, None], complement=space, held_out=held_out)
    )


@pytest.mark.parametrize("shared", [True, False])
def test_chances_are_even_though_rows_of_a_pose_share_their_noise(shared) -> None:
    """Row by row four in ten of such columns would pass for one in twenty."""
    rng = np.random.default_rng(4)
    p = np.array([chance(rng, shared) for _ in range(600)])
    assert 0.02 < np.mean(p < 0.05) < 0.09
    assert 0.4 < p.mean() < 0.6


def test_what_is_really_there_stands_clear() -> None:
    assert chance(np.random.default_rng(5), shared=True, planted=2.0) < 1e-9


def test_rows_that_stand_alone_have_no_say() -> None:
    touches = SimpleNamespace(q=np.arange(9.0)[:, None], time=np.zeros(9))
    space = SimpleNamespace(touches=touches, used=np.ones(9, dtype=bool), groups=(np.arange(9),))
    A = np.zeros((9, 1))
    assert p_by_instants(SimpleNamespace(A=A[:, :0]), SimpleNamespace(A=A, complement=space)) == 0.0
