"""Effects that users wrote with a slip in them: each slip is one line about their file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from matstd.twin.errors import BadFile, UnknownEffect
from matstd.twin.library import catalogue as library
from matstd.twin.library import try_kind, users_lines
from matstd.twin.machine import Axis, make_chain
from matstd.twin.record import at_poses

FILE = '''from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.model import Inner, Parameter, Term, Where
from matstd.twin.model import Kind
from matstd.twin.units import UM


@dataclass(frozen=True)
class Bump:
    """A bump of the bed."""

    place: float = 0.0
    name = kind = "bump"
    parameters = (Parameter("size", "mm", 10 * UM),)

    def terms(self, touches):
        link = touches.chain.link_index("Z")
        amount = np.exp(-(((touches.reading("X") - self.place) / 50.0) ** 2))
        return (Term(0, Where("twist", link, 2), amount),)

    def inner(self, touches):
        return (Inner("place", "mm", np.linspace(-100.0, 100.0, 5)),)

    def tuned(self, place):
        return replace(self, place=float(place))

    @property
    def tuning(self):
        return {"place": self.place}


BUMP = Kind(
    word="bump", arguments="", formula="f", units="u", typical="t", source="s",
    make=lambda chain, arguments: Bump(), propose=lambda touches: (Bump(),), classes=(Bump,),
)
'''
LINE_OF_AMOUNT = 1 + FILE.splitlines().index(
    '        amount = np.exp(-(((touches.reading("X") - self.place) / 50.0) ** 2))'
)
AMOUNT = 'np.exp(-(((touches.reading("X") - self.place) / 50.0) ** 2))'
SIZE = '(Parameter("size", "mm", 10 * UM),)'
LINE_OF_TERMS = 1 + FILE.splitlines().index("    def terms(self, touches):")
LINE_OF_INNER = 1 + FILE.splitlines().index("    def inner(self, touches):")
LINE_OF_TUNED = 1 + FILE.splitlines().index("    def tuned(self, place):")
CHAIN = make_chain("test", "[w f X Y Z t]", {a: Axis((-400.0, 400.0)) for a in "XYZ"})
N = 6


def touches():
    q = np.zeros((N, len(CHAIN.axes)))
    q[:, CHAIN.axis_index("X")] = np.linspace(-100.0, 100.0, N)
    return at_poses(CHAIN, q, 160.0)


def test_an_effect_without_a_slip_passes(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text(FILE, encoding="utf-8")
    (kind,) = library.load_user_effects(path)
    try_kind(kind, touches(), path)
    assert library.users_files() == {"bump": path}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            AMOUNT,
            "1.0 / 0",
            f"line {LINE_OF_AMOUNT}: found ZeroDivisionError: float division by zero",
        ),
        (AMOUNT, "mispelt", f"line {LINE_OF_AMOUNT}: found NameError: name 'mispelt' is not"),
        (AMOUNT, 'touches.temperature["air"]', f"line {LINE_OF_AMOUNT}: found KeyError: 'air'"),
        ('link_index("Z")', 'link_index("W")', "found unknown axis 'W'; this machine has"),
        (AMOUNT, "np.ones(4)", r"bump: found an amount of shape \(4,\), expected \(6,\), one a"),
        (AMOUNT, 'np.sqrt(touches.reading("X"))', "bump: found no finite amount at 3 of 6 touches"),
        ("Term(0,", "Term(2,", "bump: found a term of parameter 2, expected 0 to 0"),
        ('"twist", link, 2', '"twits", link, 2', "found Where.'twits', ...., expected one of twi"),
        ('"twist", link, 2', '"twist", 99, 2', "found link 99, expected 0 to"),
        ('"twist", link, 2', '"shift", 0, 5', "found component 5 of 'shift', expected 0 to 2"),
        ("return (Term(0", "return [1.0] or (Term(0", "bump: found float in terms, expected Term"),
        ("return (Term(0", "return None and (Term(0", "bump: found NoneType from terms, expected"),
        ("def terms", "def term", "Bump: found no terms, expected name, kind, parameters, terms"),
        ('name = kind = "bump"', 'kind = "bump"', "Bump: found no name"),
        ('name = kind = "bump"', 'name = kind = "hump"', "found the name 'hump', expected a name"),
        ('name = kind = "bump"', "name = kind = 7", "found the name 7, expected name and kind as"),
        (SIZE, "()", "bump.parameters: found none, expected at least one"),
        (SIZE, SIZE[1:-2], "bump.parameters: found Parameter, expected a tuple of Parameter"),
        ("10 * UM", "0.0", "bump.parameters, size: found sd = 0, expected the size it may have"),
        ('"mm", 10', '"um", 10', "found the unit 'um', expected a base unit: mm or rad"),
        ('Inner("place"', 'Inner("spot"', "found inner parameters spot, expected those of tuning"),
        (
            "-100.0, 100.0, 5",
            "100.0, -100.0, 5",
            r"line 23, bump.inner, grid of place: found \[.*, expected finite",
        ),
        ("place=float(place)", "spot=float(place)", "found TypeError: .*, expected an effect for"),
        (
            "(Bump(),), cl",
            "Bump(), cl",
            "propose of 'bump': found TypeError: .*expected effects in",
        ),
        ("(Bump(),), cl", "1 / 0, cl", r"line \d+: found ZeroDivisionError.*expected effects in a"),
        # what would go wrong in silence: noise, zeros, writing into the touches, leaving
        (
            "def tuned",
            "def turned",
            f"line {LINE_OF_INNER}, bump.inner: found inner and tuning wit",
        ),
        (
            "def tuning",
            "def turning",
            "found inner and tuned without tuning, expected inner, tuned",
        ),
        (
            AMOUNT,
            "np.random.default_rng().normal(size=6)",
            f"line {LINE_OF_TERMS}, bump: found oth",
        ),
        (AMOUNT, 'np.zeros(6) * touches.reading("X")', "found zero at every touch of this run"),
        (AMOUNT, "touches.time.__setitem__(0, 1.0) or 0", f"line {LINE_OF_AMOUNT}: found ValueErr"),
        (AMOUNT, "touches.reading('X').sort() or 0", f"line {LINE_OF_AMOUNT}: found ValueError"),
        (AMOUNT, "touches.temperature.clear() or 0", f"line {LINE_OF_AMOUNT}: found AttributeErr"),
        (AMOUNT, "touches.signature.shift.fill(0) or 0", f"line {LINE_OF_AMOUNT}: found ValueErr"),
        (AMOUNT, "exit(3)", f"line {LINE_OF_AMOUNT}: found SystemExit: 3, expected an amount"),
        (AMOUNT, "1.0", r"bump: found an amount of shape \(\), expected \(6,\), one a touch"),
        (AMOUNT, "1j * np.ones(6)", "bump: found an amount of complex128, expected real numbers"),
        (AMOUNT, "np.array(['a'] * 6)", "bump: found an amount of <U1, expected real numbers"),
        ("replace(self, place=float(place))", "self", f"line {LINE_OF_TUNED}, bump.tuned: found"),
        ("replace(self, place=float(place))", "None", "bump.tuned: found NoneType '', expected"),
        ("(Bump(),), cl", "(Bump(), Bump()), cl", "bump: found its name proposed twice"),
        ("(Bump(),), cl", "exit(1), cl", r"line \d+: found SystemExit: 1, expected effects in a"),
    ],
)
def test_a_slip_is_one_line(tmp_path: Path, old: str, new: str, expected) -> None:
    path = tmp_path / "own.py"
    text = FILE.replace(old, new)
    assert text != FILE
    path.write_text(text, encoding="utf-8")
    (kind,) = library.load_user_effects(path)
    run = replace(touches(), temperature={"oil": np.arange(6.0)})
    before = run.q.copy()
    with pytest.raises(BadFile, match=expected) as caught:
        try_kind(kind, run, path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)
    assert np.array_equal(run.q, before)
    assert run.time.flags.writeable


def test_an_effect_that_acts_at_few_values_is_not_said_to_move_nothing(tmp_path: Path) -> None:
    """It acts at -50 alone, which is none of the first, middle and last values of the grid."""
    path = tmp_path / "own.py"
    path.write_text(FILE.replace(AMOUNT, 'touches.reading("X") * (self.place == -50.0)'))
    (kind,) = library.load_user_effects(path)
    try_kind(kind, touches(), path)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('formula="f"', "formula=3", "Kind 'bump': found formula = 3, expected text"),
        ("propose=lambda touches: (Bump(),)", "propose=3", "found propose of no function"),
        ("BUMP = Kind(", "raise SystemExit(4)\nBUMP = Kind(", r"line 34: found SystemExit: 4"),
    ],
)
def test_files_that_cannot_be_loaded_are_one_line(
    tmp_path: Path, old: str, new: str, expected
) -> None:
    path = tmp_path / "own.py"
    path.write_text(FILE.replace(old, new), encoding="utf-8")
    with pytest.raises(BadFile, match=expected):
        library.load_user_effects(path)


def test_a_file_that_changed_is_read_again(tmp_path: Path) -> None:
    """As in a notebook: edit, load, try, edit, load, try."""
    path = tmp_path / "own.py"
    for typical in ("t", "much more"):
        path.write_text(FILE.replace('typical="t"', f'typical="{typical}"'), encoding="utf-8")
        (kind,) = library.load_user_effects(path)
        assert kind.typical == typical
    assert [k.word for k in library.kinds()].count("bump") == 1


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        (
            "backlash",
            "Kind 'backlash': found a word that the library has already, expected another",
        ),
        ("my bump", "Kind 'my bump': found a word that is no name, expected letters, digits"),
    ],
)
def test_words_that_cannot_be_taken(tmp_path: Path, word: str, expected) -> None:
    path = tmp_path / "own.py"
    path.write_text(FILE.replace('word="bump"', f'word="{word}"'), encoding="utf-8")
    with pytest.raises(BadFile, match=expected):
        library.load_user_effects(path)


def test_two_files_with_one_word_are_both_named(tmp_path: Path) -> None:
    for name in ("first.py", "second.py"):
        (tmp_path / name).write_text(FILE, encoding="utf-8")
    library.load_user_effects(tmp_path / "first.py")
    with pytest.raises(BadFile, match=r"second.py: Kind 'bump': found a word that .*first.py has"):
        library.load_user_effects(tmp_path / "second.py")


def test_lines_of_a_users_file_are_found_in_a_failure(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text(FILE.replace(AMOUNT, "1.0 / 0"), encoding="utf-8")
    (kind,) = library.load_user_effects(path)
    (effect,) = kind.propose(touches())
    with pytest.raises(ZeroDivisionError) as caught:
        effect.terms(touches())
    assert users_lines(caught.value, path) == [LINE_OF_AMOUNT]
    assert users_lines(caught.value, tmp_path / "other.py") == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("backlsh(X)", r"'backlsh\(X\)'; did you mean backlash\(X\)\?; available: geometric"),
        ("Thermal_Lag(EZZ)", r"did you mean thermal-lag\(EZZ\)\?"),
        # of a patch and a sensor any word is a name
        ("EZZ", r"error parameter; did you mean (?!.*artefact-\w+\(E).*thermal-lag\(EZZ\).*\?; a"),
        ("backlash(X", "whose bracket does not end"),
        ("xyzzy", "unknown effect 'xyzzy'; available: geometric"),
    ],
)
def test_the_nearest_name_is_suggested(text: str, expected: str) -> None:
    with pytest.raises(UnknownEffect, match=expected):
        library.parse_effect(text, CHAIN)


def test_the_effect_of_the_guide_is_one(tmp_path: Path) -> None:
    """The class of docs/own_effects.md, with the imports that it names."""
    guide = Path(__file__).parents[2] / "docs" / "own_effects.md"
    code = guide.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    path = tmp_path / "own.py"
    imports = """from dataclasses import dataclass
from matstd.twin.model import Declared, Kind, Parameter
from matstd.twin.units import UM
"""
    path.write_text(imports + code, encoding="utf-8")
    (kind,) = library.load_user_effects(path)
    chain = make_chain("table", "[w C' f X t]", {"C": Axis((-7.0, 7.0)), "X": Axis((0.0, 9.0))})
    q = np.zeros((2, 2))
    clamped = replace(at_poses(chain, q, 0.0), approach=np.array([[-1.0, 0.0], [1.0, 0.0]]))
    try_kind(kind, clamped, path)
    (term,) = library.parse_effect("clamp", chain).terms(clamped)
    assert term.amount.tolist() == [1.0, 0.0]
    assert kind.summary == "EZC = h where C was last turned backwards, else nothing."
    with pytest.raises(UnknownEffect, match=r"'clamp\(X\)': expected clamp, no arguments"):
        library.parse_effect("clamp(X)", chain)
