"""Every kind of the library says, proposes, parses and computes what it did before."""

import json

import pytest
from library_as_text import FILE, snapshot

BEFORE = json.loads(FILE.read_text(encoding="utf-8"))
ROUNDING = 1e-7
"""Of sums of a few thousand amounts of either sign, in nine digits."""


@pytest.fixture(scope="module")
def now():
    """The library as it is."""
    return json.loads(json.dumps(snapshot()))


@pytest.mark.parametrize("part", BEFORE)
def test_library_is_what_it_was(part, now) -> None:
    assert list(now[part]) == list(BEFORE[part])
    for name, before in BEFORE[part].items():
        if isinstance(before, list) and isinstance(before[-1], float):
            *words, number = now[part][name]
            assert words == before[:-1], name
            assert number == pytest.approx(before[-1], rel=ROUNDING, abs=ROUNDING), name
        else:
            assert now[part][name] == before, name
