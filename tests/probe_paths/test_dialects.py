"""Dialect files: those that come with the tool, a user's own, and bad ones."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from formats import examples

from matstd.probe_paths.control import interpret
from matstd.probe_paths.emit import Feeds, make_programs
from matstd.probe_paths.language import Dialect, read_dialect
from matstd.probe_paths.language.dialect_file import known_controls
from matstd.twin.errors import BadFile, DesignError

ROOT = Path(__file__).parents[2]


def test_defaults_are_the_file_of_the_itnc_530():
    assert read_dialect("itnc530") == Dialect()


def test_an_itnc_530_has_three_spellings_of_the_path_word():
    names = [name for name in known_controls() if name.startswith("itnc530")]
    assert {read_dialect(name).distance_word for name in names} == {"SET UP", "ABST", "DIST"}


@pytest.mark.parametrize("control", known_controls())
def test_every_control_has_the_same_touches(control, plan, chain, programs):
    """One plan: whatever the words, the text read back does the same."""
    dialect = read_dialect(control)
    made = make_programs(plan, dialect, Feeds(touches_per_file=24))
    for one, other in zip(made.programs, programs.programs, strict=True):
        ours, golden = (
            interpret(p.text.encode("ascii"), Path(p.file), m.masks.get, chain, dialect=dialect)
            for p, m in ((one, made), (other, programs))
        )
        assert [t.number for t in ours.touches] == [t.number for t in golden.touches]
        for a, b in zip(ours.touches, golden.touches, strict=True):
            assert (a.q == b.q).all()
            assert (a.direction == b.direction).all()
            assert (a.side == b.side).all()
            assert (a.distance, a.feed, a.back) == (b.distance, b.feed, b.back)


@pytest.mark.parametrize(
    ("control", "called", "words"),
    [
        ("itnc530", "TOOL CALL 30 Z", "CYCL DEF 13.0 ORIENTATION|CYCL DEF 13.1 ANGLE 0|M19"),
        ("linuxcnc", "T30 M6", "M19 R0 Q10"),
    ],
)
def test_the_spindle_is_oriented_after_the_call_where_the_dialect_says_so(
    control, called, words, plan, chain, programs
):
    dialect = replace(read_dialect(control), is_oriented=True)
    made = make_programs(plan, dialect)
    (program,) = made.programs
    lines = [re.sub(r"^\d+ ", "", line) for line in program.text.splitlines()]
    after = lines.index(called) + 1
    wanted = words.split("|")
    assert lines[after : after + len(wanted)] == wanted
    assert "M19" not in programs.programs[0].text
    for word in wanted:
        left = "\n".join(line for line in lines if line != word) + "\n"
        with pytest.raises(BadFile, match="the orientation of the spindle"):
            interpret(left.encode(), Path(program.file), made.masks.get, chain, dialect=dialect)


def test_a_file_of_the_users_own_is_seen_from_its_folder(tmp_path):
    (tmp_path / "hall4.toml").write_text(examples()["dialect.toml"], encoding="utf-8")
    dialect = read_dialect("hall4.toml", tmp_path)
    assert (dialect.cycle_name, dialect.tool, dialect.prefix) == ("MESSEN IN 3D", 12, "FF")
    assert dialect.on_control("A.H") == "TNC:\\CAL\\A.H"


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("tool = 12", "tool = 0", r"tool.*1"),
        ('prefix = "FF"', 'prefix = "1F"', "prefix"),
        ('prefix = "FF"', 'prefix = "FF"\ncycel = 4', "cycel"),
        ("folder = 'TNC:\\CAL'", "", r"folder: .*nothing.*a folder of the control"),
        ('distance_word = "ABST"', 'distance_word = "Abst"', "distance_word"),
        ('prefix = "FF"', "slow_feed = 12.0", r"slow_feed: .*cycle 4 touches once"),
        ('"klartext"', '"gcode"', r"folder: .*LinuxCNC logs where it was started"),
        ('"klartext"', '"siemens"', r"language.*klartext"),
        ('"dialect/1"', '"dialect/9"', r"format.*dialect/1"),
    ],
)
def test_a_bad_dialect_is_one_line(old, new, reason, tmp_path):
    text = examples()["dialect.toml"]
    assert old in text
    (tmp_path / "own.toml").write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(BadFile, match=reason) as refusal:
        read_dialect("own.toml", tmp_path)
    assert "\n" not in str(refusal.value)


def test_a_control_that_is_unknown_is_refused_before_any_work(tmp_path, refusal):
    with pytest.raises(DesignError, match="expected one of itnc530"):
        read_dialect("fanuc")
    project = ROOT / "examples" / "hsm600u.toml"
    error = refusal(["design", str(project), "-o", str(tmp_path / "out"), "--control", "fanuc"])
    assert re.match(r"matstd design: control 'fanuc': expected one of .*\n\Z", error)
    assert not (tmp_path / "out").exists()
