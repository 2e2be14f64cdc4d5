"""Names that machine people use: titles of effects, and the words by which kinds are found."""

import pytest
from made_up import MACHINES, made_up

from matstd.twin.library import find_kinds, kinds, parse_effect, proposals, title_of
from matstd.twin.machine import parse_symbol
from matstd.twin.model import own_title


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("spindle growth", "thermal-lag"),
        ("growth", "thermal-lag"),
        ("reversal", "backlash"),
        ("backlash(X)", "backlash"),
        ("screw pitch", "periodic"),
        ("thermal drift of the column", "column-bending"),
        ("Pre-Travel", "probe-lobing"),
        ("squareness", "location"),
        ("straightness", "geometric"),
        ("sgn(last", "backlash"),
        ("clamping", "artefact-slip"),
    ],
)
def test_kinds_are_found_by_the_words_of_a_workshop(query, expected) -> None:
    assert expected in {kind.word for kind in find_kinds(query)}


def test_nonsense_finds_nothing_and_a_name_finds_itself_alone() -> None:
    assert find_kinds("wobbly banana") == ()
    for kind in kinds():
        assert find_kinds(kind.word) == (kind,)
        assert kind.title
        assert kind.synonyms


@pytest.mark.parametrize(
    ("name", "text", "carrier"),
    [
        ("thermal-lag(EZZ)", "growth along Z after switching on", "Z"),
        ("thermal-lag(EZB)", "growth along Z after switching on", "B"),
        ("thermal-lag(EAY,spindle_rpm)", "tilt about X after the spindle speed", "Y"),
        ("backlash(X)", "reversal of X", "X"),
        ("geometric(EXX,3)", "positioning error of X", "X"),
        ("gravity(EYZ)", "sag of Z along Y", "Z"),
        ("gravity(EBB,C)", "tilt under a load off the centre of C", "B"),
        ("stiffness(t)", "compliance of the tool", "t"),
        ("probe-lobing", "lobes of the probe", "probe"),
        ("artefact-slip", "slip of the set-up", "standard"),
        ("coupling(EBX,Z)", "tilt of X about Y, which changes with Z", "X"),
    ],
)
def test_titles_of_effects(name, text, carrier) -> None:
    chain = made_up("hsm600u").chain
    assert title_of(parse_effect(name, chain)) == (text, carrier)


@pytest.mark.parametrize("label", MACHINES)
def test_every_effect_has_a_title_of_its_own(label) -> None:
    """Those that differ in nothing but the body that carries them share the text."""
    titles = {}
    for effect in proposals(made_up(label)):
        assert own_title(effect) is not None, effect.name
        titles.setdefault(title_of(effect), []).append(effect.name)
    for title, names in titles.items():
        assert len({name.partition("(")[0] for name in names}) == 1, title


@pytest.mark.parametrize(
    ("symbol", "title"),
    [
        ("EXX", "positioning error of X"),
        ("EYX", "straightness of X in Y"),
        ("EAX", "roll of X"),
        ("EBX", "tilt of X about Y"),
        ("EXC", "radial motion of C along X"),
        ("EZC", "axial motion of C"),
        ("EAC", "tilt of C about X"),
        ("ECC", "positioning error of C"),
        ("EC0Y", "squareness of Y about Z"),
        ("EX0X", "zero position of X"),
        ("EC0C", "zero position of C"),
        ("EX0C", "displacement of the line of C along X"),
        ("EA0C", "tilt of the line of C about X"),
        ("EX0w", "displacement of the workpiece along X"),
        ("EA0t", "rotation of the tool about X"),
    ],
)
def test_errors_in_words(symbol, title) -> None:
    assert parse_symbol(symbol).title == title
