"""Damaged files over every reader: one line of refusal, or what stands in the file; no traceback.

`benchmarks/fuzz_readers.py` does the same thousands of times.
"""

import re

import numpy as np
import pytest
from border_cases import border_readers
from foreign_cases import foreign_readers, holes_said, mapped_said
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reader_cases import NUMBERS, damage, golden, machine_said, poses_said, readers, run_said

from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_text
from matstd.twin.files.toml import parse_toml
from matstd.twin.machine.chain import parse_notation

EACH = 60
"""Inputs of a reader: a few seconds in all."""
LONGEST = 900
"""Longest line of a refusal, characters."""
NAMES = (
    "machine",
    "errors",
    "run",
    "pose",
    "sensors",
    "project",
    "standard",
    "model",
    "log",
    "program",
)
"""Fmt: skip."""

OTHERS = (
    "holes", "laser", "encoders", "map", "mapped", "dh", "dialect", "workshop", "several",
    "gcode log", "gcode", "drift", "probed", "law", "task", "cmm", "loads", "part", "ngc",
)  # fmt: skip
"""Tables of others, dialects, the workshop of a project, two runs, a second control; what belongs
to drift, to tasks and calibrations, to parts."""


class Cases(dict):
    """Readers by name; its words are short, because hypothesis prints them with every example."""

    def __repr__(self) -> str:
        return "cases"


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    """Every reader with its valid text."""
    folder = tmp_path_factory.mktemp("files")
    made = [*readers(folder), *foreign_readers(folder, golden), *border_readers(folder, golden)]
    return Cases({r.name: (r, r.path.read_text(encoding="utf-8")) for r in made})


def check(reader, data: bytes) -> None:
    """The file is refused in one line, or says what was read."""
    reader.path.write_bytes(data)
    refusal = ""
    try:
        result = reader.read(reader.path)
    except DesignError as error:
        refusal = str(error).replace(str(reader.path), "FILE")
    assert "\n" not in refusal
    assert len(refusal) < LONGEST
    if not refusal and reader.said is not None:
        text = data.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n")
        assert reader.said(text, result)


def test_every_reader_has_its_file(cases) -> None:
    assert set(cases) == {*NAMES, *OTHERS}
    for reader, valid in cases.values():
        result = reader.read(reader.path)
        assert reader.said is None or reader.said(valid, result)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=EACH, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**32 - 1))
def test_damaged_files(cases, name, seed) -> None:
    """One to three things wrong: a number, a key, a line, a cell, bytes, the end."""
    reader, valid = cases[name]
    check(reader, damage(np.random.default_rng(seed), valid))


@pytest.mark.parametrize("name", OTHERS)
@settings(max_examples=EACH // 4, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**32 - 1))
def test_damaged_files_of_others(cases, name, seed) -> None:
    reader, valid = cases[name]
    check(reader, damage(np.random.default_rng(seed), valid))


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=EACH // 2, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=st.text(max_size=200), at=st.floats(0.0, 1.0))
def test_any_text_anywhere(cases, name, text, at) -> None:
    reader, valid = cases[name]
    place = int(at * len(valid))
    check(reader, (valid[:place] + text + valid[place:]).encode("utf-8", "surrogatepass"))


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=EACH // 2, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.binary(max_size=300))
def test_any_bytes(cases, name, data) -> None:
    check(cases[name][0], data)


def test_the_naive_reading_notices_a_wrong_number(cases) -> None:
    """The comparison can fail: results that are off by a thousandth are not what the files say."""
    reader, text = cases["pose"]
    reader.path.write_text(text, encoding="utf-8")
    q, length = reader.read(reader.path)
    assert poses_said(text, (q, length))
    assert not poses_said(text, (q * 1.001, length))
    reader, text = cases["run"]
    reader.path.write_text(text, encoding="utf-8")
    run = reader.read(reader.path)
    assert run_said(text, run)
    assert not run_said(text.replace("u_um = 0.6", "u_um = 0.61"), run)
    reader, text = cases["machine"]
    reader.path.write_text(text, encoding="utf-8")
    assert not machine_said(text.replace("-420.0", "-421.0"), reader.read(reader.path))
    reader, text = cases["holes"]
    reader.path.write_text(text, encoding="utf-8")
    read = reader.read(reader.path)
    assert holes_said(text, read)
    assert not holes_said(text.replace("100,003", "100,004"), read)
    reader, text = cases["mapped"]
    reader.path.write_text(text, encoding="utf-8")
    assert not mapped_said(text.replace("-0.4", "-0.41"), reader.read(reader.path))
    assert len(set(NUMBERS)) == len(NUMBERS)


@pytest.mark.parametrize(
    ("name", "said"),
    [("rum.csv", "no such file; did you mean run.csv?"), ("x/run.csv", "the folder")],
)
def test_a_file_that_is_missing_is_looked_for_beside_its_name(name, said, tmp_path) -> None:
    (tmp_path / "run.csv").write_text("", encoding="utf-8")
    with pytest.raises(BadFile, match=said.replace("?", r"\?")):
        read_text(tmp_path / name)


def test_primes_of_a_word_processor_are_primes() -> None:
    plain = parse_notation("[w C' B' X' f Y Z (C1) t]")
    assert parse_notation("[w C’ B′ X´ f Y Z (C1) t]") == plain


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ('machine = "C:\\Users\\machine.toml"', "two backslashes for one"),
        ("[probe   # of the spindle", "a ] behind the name of a table"),
    ],
)
def test_a_line_that_is_no_toml_says_what_is_missing(line, expected) -> None:
    with pytest.raises(BadFile, match=re.escape(expected)):
        parse_toml(f"{line}\n", "project.toml")


def test_a_whole_number_too_large_for_a_float_is_refused_in_a_saved_law(cases) -> None:
    reader, valid = cases["law"]
    damaged = re.sub(r'("mean": \[\s*)[^,\]\s]+', rf"\g<1>1{'0' * 400}", valid, count=1)
    assert damaged != valid
    reader.path.write_text(damaged, encoding="utf-8")
    with pytest.raises(BadFile, match="as matstd wrote it"):
        reader.read(reader.path)
