"""Exceptions carry their facts: nothing has to be read out of a message."""

import pickle

import pytest

from matstd.twin.errors import (
    BadArgument,
    BadFile,
    BadValue,
    DesignError,
    UnknownAxis,
    UnknownSymbol,
)

EVERY = [
    DesignError("no", reason=1),
    BadValue("axis.X.range", [2.0, 1.0], "the smaller reading first"),
    BadArgument("hold_out", "winter", "one of spring"),
    UnknownAxis("Q", ["X", "Y"]),
    UnknownSymbol("EXW", ["EXX", "EYX"]),
    BadFile("a.toml", "axis", "nothing", "this key"),
]


@pytest.mark.parametrize("error", EVERY, ids=lambda e: type(e).__name__)
def test_errors_travel_between_processes(error) -> None:
    back = pickle.loads(pickle.dumps(error))
    assert type(back) is type(error)
    assert str(back) == str(error)
    assert back.facts == error.facts


def test_a_refused_value_becomes_a_fault_of_its_file() -> None:
    axis = BadFile.of("m.toml", UnknownAxis("Q", ["X", "Y"]), within="axis")
    assert str(axis) == "m.toml: axis.Q: found an unknown axis, expected one of X, Y"
    value = BadFile.of("m.toml", EVERY[1])
    assert str(value) == (
        "m.toml: axis.X.range: found [2.0, 1.0], expected the smaller reading first"
    )
    symbol = BadFile.of("e.toml", UnknownSymbol("EXY0", ["EXX", "EXY"]), key="groups")
    assert str(symbol) == (
        "e.toml: groups: found an unknown error name; did you mean EXY?, expected one of EXX, EXY"
    )
