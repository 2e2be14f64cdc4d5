"""Effects by name: what parses, what is refused in one line, and how users add their own."""

from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import numpy as np
import pytest
from machines import HSM600U

import matstd.twin.library.catalogue as library
from matstd.twin.effects.backlash import KIND as BACKLASH
from matstd.twin.errors import BadFile, DesignError, UnknownEffect, UnknownSymbol
from matstd.twin.model import Kind
from matstd.twin.record import at_poses


def test_spaces_do_not_matter() -> None:
    assert library.parse_effect(" coupling( EBX , Z ) ", HSM600U).name == "coupling(EBX,Z)"


REFUSED = {
    "no such kind": ("wobble(X)", UnknownEffect, "unknown effect 'wobble.X.'; available: geom"),
    "not a name": ("backlash(X", UnknownEffect, "unknown effect"),
    "no argument": (
        "backlash",
        UnknownEffect,
        r"'backlash': expected backlash\(axis or symbol\), 1 arg",
    ),
    "too many": ("backlash(X,Y)", UnknownEffect, r"'backlash\(X,Y\)': expected .* 1 argument"),
    "no brackets wanted": ("probe-radius(3)", UnknownEffect, "expected probe-radius, no arg"),
    "unknown axis": ("backlash(Q)", UnknownEffect, "an axis of C, B, X, Y, Z"),
    "spindle": ("backlash(C1)", UnknownEffect, "an axis of C, B, X, Y, Z"),
    "rotary scale": ("thermal-expansion(C,s)", UnknownEffect, "a linear axis of X, Y, Z"),
    "unknown component": ("geometric(EQX,3)", UnknownSymbol, "unknown error parameter 'EQX'"),
    "absent axis": ("thermal-lag(EAA)", UnknownSymbol, "unknown error parameter 'EAA'"),
    "constant": ("coupling(EC0Y,Z)", UnknownEffect, "'EC0Y' is a constant"),
    "component as location": ("location(EXX)", UnknownEffect, "one of EX0C"),
    "degree": ("geometric(EXX,13)", UnknownEffect, "two such as 3-4, or one of constant"),
    "shape": ("geometric(EXX,wavy)", UnknownEffect, "a degree of 1 to 12"),
    "itself": ("coupling(EBX,X)", UnknownEffect, "another axis than X itself"),
    "empty drive": ("thermal-lag(EZZ,)", UnknownEffect, "a sensor, spindle_rpm or an own column"),
    "load on a linear axis": ("gravity(EYZ,C)", UnknownEffect, "a rotary axis that tilts"),
    "same sensor": ("column-bending(Z,a,a)", UnknownEffect, "two different sensors"),
    "stiffness of w": ("stiffness(w)", UnknownEffect, "one of C, B, X, Y, Z, t"),
}


@pytest.mark.parametrize(("text", "error", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_refusals_are_one_line_that_shows_what_is_expected(text, error, message) -> None:
    with pytest.raises(error, match=message) as caught:
        library.parse_effect(text, HSM600U)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, DesignError)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("thermal-expansion(X,glass)", "no temperature sensor 'glass'.*there is none"),
        ("thermal-lag(EZZ,glass)", "no temperature sensor 'glass'"),
        ("artefact-expansion(glass)", "no temperature sensor 'glass'"),
        ("thermal-lag(EZZ,spindle_rpm)", "the spindle speed of these touches is unknown"),
        ("stiffness(Z)", "the load on the tool at these touches is unknown"),
    ],
)
def test_records_that_were_not_made_are_named(name: str, message: str) -> None:
    poses = at_poses(HSM600U, np.zeros((2, len(HSM600U.axes))), 160.0)
    with pytest.raises(UnknownEffect, match=message):
        library.parse_effect(name, HSM600U).terms(poses)


def test_what_cannot_show_is_not_proposed() -> None:
    """One pose, no time, no normals: only a constant of the instrument could be there."""
    poses = at_poses(HSM600U, np.zeros((3, len(HSM600U.axes))), 160.0)
    assert [e.name for e in library.proposals(poses)] == ["probe-radius"]


def test_every_kind_states_its_formula_units_size_and_source() -> None:
    for kind in library.kinds():
        for text in (kind.formula, kind.units, kind.typical, kind.source, kind.summary):
            assert len(text) > 2, kind.word
            assert "\n" not in text
        assert kind.classes
        assert all(cls.kind == kind.word for cls in kind.classes)


def test_a_word_is_taken_once() -> None:
    assert library.register(BACKLASH) is BACKLASH
    other = Kind("backlash", "", "f", "u", "t", "s", BACKLASH.make, BACKLASH.propose)
    with pytest.raises(DesignError, match="'backlash' is already in the library"):
        library.register(other)
    with pytest.raises(DesignError, match="expected letters, digits and hyphens"):
        library.register(Kind("two words", "", "f", "u", "t", "s", BACKLASH.make, BACKLASH.propose))


USERS = '''
"""A hose that drags at the ram: an effect of our own."""
from dataclasses import dataclass

from matstd.twin.model import Parameter, Term, Where
from matstd.twin.model import Kind
from matstd.twin.units import UM


@dataclass(frozen=True)
class HoseDrag:
    """Drag of a hose, growing with the square of X."""

    kind = "hose"
    name = "hose"
    parameters = (Parameter("amplitude", "mm", 5 * UM),)

    def terms(self, touches):
        where = Where("twist", touches.chain.link_index("Z"), 1)
        return (Term(0, where, (touches.reading("X") / 400.0) ** 2),)


HOSE = Kind(
    word="hose", arguments="", formula="EYZ = a (X/400 mm)^2", units="a: µm", typical="5 µm",
    source="seen on our machine", make=lambda chain, arguments: HoseDrag(),
    propose=lambda touches: [HoseDrag()], classes=(HoseDrag,),
)
'''


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\n", "my_effects.py: file: found no Kind, expected"),
        ("import nowhere_at_all\n", "found ModuleNotFoundError: No module named"),
        ("x = 1\ndef broken(:\n", r"my_effects.py: line 2: found .def broken\(:. \(invalid"),
    ],
)
def test_a_users_file_with_a_fault_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "my_effects.py"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(BadFile, match=message) as caught:
        library.load_user_effects(file)
    assert "\n" not in str(caught.value)


def test_a_users_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match=r"expected a \.py file with a Kind in it"):
        library.load_user_effects(tmp_path / "none.py")


def _points(*values: str) -> EntryPoints:
    group = library.ENTRY_POINT_GROUP
    return EntryPoints(EntryPoint(f"own{i}", v, group) for i, v in enumerate(values))


def test_an_installed_effect_is_a_users_file_too(monkeypatch, tmp_path) -> None:
    """So that a slip in it is a line of that file, as with one that is loaded by its path."""
    monkeypatch.setattr(library, "_FILES", {})
    (tmp_path / "their_effects.py").write_text(USERS, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(library, "entry_points", lambda group: _points("their_effects:HOSE"))
    (kind,) = library.load_installed_effects()
    assert library.users_files() == {"hose": (tmp_path / "their_effects.py").resolve()}
    assert library.load_installed_effects() == (kind,)  # a second command in one process


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("matstd.twin.effects.backlash:Backlash", "expected a Kind"),
        ("twin.effects.nothing:KIND", "No module named 'twin.effects.nothing'"),
    ],
)
def test_faulty_entry_points_are_named(monkeypatch, value, message) -> None:
    monkeypatch.setattr(library, "entry_points", lambda group: _points(value))
    with pytest.raises(DesignError, match=message):
        library.load_installed_effects()


def test_a_file_with_the_rooms_former_names_is_refused_with_the_new(tmp_path) -> None:
    (tmp_path / "own.py").write_text("from twin.none import Kind\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"line 1: found .*, expected .* matstd\.twin\.none"):
        library.load_user_effects(tmp_path / "own.py")
