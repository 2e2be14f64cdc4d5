"""Two processes judge the rivals of a standard as one does."""

from dataclasses import fields

import numpy as np
import pytest

from matstd.artefact.compare import Rival, compared, comparison
from matstd.artefact.layout import Blank
from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion, TouchOptions, Visibility
from matstd.twin import beside
from matstd.twin.units import DEG

POSES = np.array([[a * DEG] for a in (-120.0, -40.0, 40.0, 120.0)])


def rivals_of(criterion: Criterion) -> tuple[Rival, ...]:
    rng, options = np.random.default_rng(1), TouchOptions(touches=16, poses=2, proof=4)
    given = criterion, None, POSES, Blank(), options, Visibility(()), rng
    with compared(*given) as others:
        return others.all()


@pytest.mark.slow  # the other process has `twin/test_beside`, the figures `test_families_stay`
def test_the_same_artefacts_in_the_same_order_to_the_last_bit(
    criterion: Criterion, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(comparison, "_SCATTER_SIZE", 40)
    alone = rivals_of(criterion)
    monkeypatch.setattr(beside, "CORES", 2)
    shared = rivals_of(criterion)
    assert len(alone) >= 4
    for one, other in zip(alone, shared, strict=True):
        for field in fields(Rival):
            a, b = getattr(one, field.name), getattr(other, field.name)
            if isinstance(a, Requests):
                assert np.array_equal(a.point, b.point)
                assert np.array_equal(a.rotary, b.rotary)
            elif field.name != "body":
                assert a == b, field.name
