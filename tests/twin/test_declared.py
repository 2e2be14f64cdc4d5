"""Effects that declare their fields: what follows from them, and what is said of a slip."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from matstd.twin.errors import BadFile, UnknownEffect
from matstd.twin.fields import LinearAxisName, SensorName
from matstd.twin.library import catalogue as library
from matstd.twin.library import try_kind
from matstd.twin.machine import Axis, make_chain
from matstd.twin.model import Declared, Kind, Parameter, is_tunable, own_title, scanned, traits
from matstd.twin.record import at_poses

CHAIN = make_chain("test", "[w f X Y Z t]", {a: Axis((-400.0, 400.0)) for a in "XYZ"})


@dataclass(frozen=True)
class Rub(Declared):
    """A wiper that rubs where the axis is warm."""

    axis: LinearAxisName
    sensor: SensorName = "bed"
    width: float = scanned("mm", lambda effect, touches: np.array([10.0, 20.0]), default=15.0)

    kind, called, is_table = "rub", "rubbing of {axis}", True
    parameters = (Parameter("amplitude", "mm", 1e-3),)

    def amounts(self, touches):
        """Within the width."""
        return (np.abs(touches.reading(self.axis)) < self.width,)


KIND = Kind.of(Rub, formula="E = a for |q| < width", units="a: µm; width: mm")


def touches():
    q = np.zeros((6, len(CHAIN.axes)))
    q[:, CHAIN.axis_index("X")] = np.linspace(-100.0, 100.0, 6)
    return at_poses(CHAIN, q, 160.0)


def test_name_usage_parser_and_proposals_follow_from_the_fields() -> None:
    assert KIND.usage == "rub(axis[,sensor])"
    assert KIND.summary == "A wiper that rubs where the axis is warm."
    assert KIND.make(CHAIN, ["X"]) == Rub("X")
    assert KIND.make(CHAIN, ["Y", "oil"]) == Rub("Y", "oil")
    assert (Rub("X").name, Rub("X", "oil").name) == ("rub(X)", "rub(X,oil)")
    assert own_title(Rub("X")) == ("rubbing of X", "X")
    assert list(KIND.propose(touches())) == [Rub("X")]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], r"'rub': expected rub\(axis\[,sensor\]\), 1 to 2 arguments"),
        (["t"], r"'rub\(t\)': expected rub\(axis\[,sensor\]\), a linear axis of X, Y, Z"),
        (["X", "a", "b"], "1 to 2 arguments"),
    ],
)
def test_arguments_that_it_does_not_take(arguments, message) -> None:
    with pytest.raises(UnknownEffect, match=message):
        KIND.make(CHAIN, arguments)


def test_scanned_fields_are_inner_parameters() -> None:
    effect = Rub("X")
    (inner,) = effect.inner(touches())
    assert (inner.name, inner.unit, inner.grid.tolist()) == ("width", "mm", [10.0, 20.0])
    assert is_tunable(effect)
    assert effect.tuned(20).tuning == {"width": 20.0}
    assert effect.tuning == {"width": 15.0}


def test_terms_act_on_the_motion_of_the_axis() -> None:
    (term,) = Rub("X", width=50.0).terms(touches())
    assert term.where == ("twist", CHAIN.link_index("X"), 0)
    assert term.amount.tolist() == [False, False, True, True, False, False]


def test_traits_are_said_by_attributes_and_have_defaults() -> None:
    found = traits(Rub("X"))
    assert (found.axis, found.is_table) == ("X", True)
    assert (found.symbol, found.is_curve, found.repetition, found.original) == (
        None,
        False,
        1,
        None,
    )


def test_a_field_that_has_the_name_of_a_trait_by_chance_is_none() -> None:
    @dataclass(frozen=True)
    class Chance(Declared):
        symbol: str = "EZZ"
        wave: float = 5.0
        reversal: float = 1.0
        since_run: str = "monday"

    found = traits(Chance())
    assert (found.symbol, found.wave, found.reversal, found.since_run) == (None,) * 4


def test_an_old_name_of_a_trait_is_still_read() -> None:
    @dataclass(frozen=True)
    class Old(Declared):
        is_told_whole = True

    assert traits(Old()).is_reported_whole


FILE = '''from dataclasses import dataclass

import numpy as np

from matstd.twin.model import Declared, Kind, Parameter, scanned
from matstd.twin.units import UM


@dataclass(frozen=True)
class Bump(Declared):
    """A bump of the bed."""

    place: float = scanned("mm", (-100.0, 0.0, 100.0))

    kind, acts_on = "bump", "EZZ"
    parameters = (Parameter("size", "mm", 10 * UM),)

    def amounts(self, touches):
        return (np.exp(-(((touches.reading("X") - self.place) / 50.0) ** 2)),)


BUMP = Kind.of(Bump, formula="f")
'''
LINE = 1 + FILE.splitlines().index("    def amounts(self, touches):")


@pytest.mark.parametrize("head", ["", "from __future__ import annotations\n"])
def test_a_users_declared_effect_passes(tmp_path: Path, head: str) -> None:
    path = tmp_path / "own.py"
    path.write_text(head + FILE, encoding="utf-8")
    (kind,) = library.load_user_effects(path)
    try_kind(kind, touches(), path)
    assert len(FILE.splitlines()) <= 40


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('reading("X")', 'readings("X")', f"line {LINE + 1}: found AttributeError: .*readings"),
        ('"EZZ"', '"EZW"', "found unknown error parameter 'EZW'"),
        ("def amounts", "def amount", r"found \w+ has no method amounts\(self, touches\)"),
        ("** 2)),)", "** 2)),) * 2", "found a term of parameter 1, expected 0 to 0"),
        ("(-100.0, 0.0, 100.0)", "(1.0, 0.0)", "bump.inner, grid of place: found .1. 0.., expect"),
        ("10 * UM", "0.0", "bump.parameters, size: found sd = 0, expected the size it may have"),
    ],
)
def test_a_slip_is_one_line(tmp_path: Path, old: str, new: str, expected) -> None:
    path = tmp_path / "own.py"
    path.write_text(FILE.replace(old, new), encoding="utf-8")
    (kind,) = library.load_user_effects(path)
    with pytest.raises(BadFile, match=expected) as caught:
        try_kind(kind, touches(), path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"bump", "EZZ"', '"b c", "EZZ"', "found a word that is no name"),
        ("kind, acts_on", "word, acts_on", "found AttributeError"),
    ],
)
def test_a_class_that_makes_no_kind_is_one_line(
    tmp_path: Path, old: str, new: str, expected
) -> None:
    path = tmp_path / "own.py"
    path.write_text(FILE.replace(old, new), encoding="utf-8")
    with pytest.raises(BadFile, match=expected) as caught:
        library.load_user_effects(path)
    assert "\n" not in str(caught.value)


class Plain:
    """An effect without arguments."""

    kind = name = "plain"


def test_a_class_without_fields_takes_no_arguments() -> None:
    kind = Kind.of(Plain, formula="E = a", units="a: µm")
    assert (kind.word, kind.usage) == ("plain", "plain")
    assert isinstance(kind.make(CHAIN, []), Plain)
    assert [type(effect) for effect in kind.propose(touches())] == [Plain]
    with pytest.raises(UnknownEffect, match="'plain\\(X\\)': expected plain"):
        kind.make(CHAIN, ["X"])
