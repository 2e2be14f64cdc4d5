"""Contents, tables and print of a page."""

import csv
import re
from dataclasses import replace
from pathlib import Path

import openpyxl
import pytest
from html_tables import shown_tables

from matstd.report.layout import (
    KeyFigure,
    Page,
    Section,
    Table,
    marked,
    pdf,
    printer,
    write_page,
    write_pdf,
)
from matstd.report.layout.html import rendered
from matstd.report.layout.tables import plain, unmarked, value
from matstd.twin.errors import DesignError, MissingLibrary
from matstd.twin.words import deviations_in

LEFT = Table(
    ("artefact", ("left, µm", "rms"), ("left, µm", "95 %")),
    [["block", "1.50", "−2"], ["spheres\nfour", "3 of 4", ""]],
    "Two lines",
    best=[0],
)


def page_of(*sections: Section) -> Page:
    return Page("heading", "Verdict.", [KeyFigure("1 µm", "left", "good")], sections)


def test_every_section_is_in_the_contents(tmp_path: Path) -> None:
    titles = ("One", "Two & three", "One")
    page = rendered(page_of(Section(sentences=["First."]), *map(Section, titles)), tmp_path)
    links = re.findall(r'<a href="#([^"]+)">([^<]*)</a>', page)
    assert [text for _, text in links] == ["One", "Two &amp; three", "One"]
    assert re.findall(r'<h2 id="([^"]+)"', page) == [address for address, _ in links]
    assert len({address for address, _ in links}) == 3
    assert page.index("Verdict") < page.index("First.") < page.index("<nav") < page.index("<h2")


def test_short_pages_have_no_contents(tmp_path: Path) -> None:
    assert "<nav" not in rendered(page_of(Section("One"), Section("Two")), tmp_path)


def test_tables_say_what_the_page_says(tmp_path: Path) -> None:
    """Groups are repeated; numbers are numbers in the workbook; a table without rows goes."""
    page = page_of(
        Section("What is `left`", table=LEFT),
        Section("Empty", table=Table(("name",), [])),
        Section("Mass", is_part=True, table=Table((), [["mass", "26 kg"]])),
    )
    write_page(tmp_path / "report.html", page)
    files = sorted(p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*.*"))
    assert files == [
        "report.html",
        "tables.xlsx",
        "tables/01-what-is-left.csv",
        "tables/02-mass.csv",
    ]
    rows = list(csv.reader((tmp_path / files[2]).read_text(encoding="utf-8").splitlines()))
    assert rows == [
        ["artefact", "left, µm", "left, µm"],
        ["artefact", "rms", "95 %"],
        ["block", "1.50", "-2"],
        ["spheres four", "3 of 4", ""],
    ]
    sheet = openpyxl.load_workbook(tmp_path / "tables.xlsx").worksheets[0]
    assert sheet["A1"].value == "Two lines"
    assert [cell.value for cell in sheet[4]] == ["block", 1.5, -2]
    assert sheet["A2"].font.bold
    assert not sheet["A4"].font.bold
    shown, mass = shown_tables((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert (shown.section, shown.caption, shown.headings) == ("What is left", "Two lines", 2)
    assert shown.rows == [rows[0], rows[1][1:], ["block", "1.50", "−2"], rows[3]]
    assert mass.rows == [["mass", "26 kg"]]


def test_numbers_stand_to_the_right_and_the_best_row_in_bold(tmp_path: Path) -> None:
    page = rendered(page_of(Section("One", table=LEFT)), tmp_path)
    assert '<tr class="best"><td>block</td><td class="n">1.50</td><td class="n">−2</td>' in page
    assert '<th rowspan="2">artefact</th><th colspan="2">left, µm</th>' in page


def test_marks_are_for_the_page_alone() -> None:
    words = "see [the sheet](setup.html), **u_{cal}** of `a_{b} -1`"
    assert marked(words) == (
        'see <a href="setup.html">the sheet</a>, <b>u<sub>cal</sub></b> of <code>a_{b} -1</code>'
    )
    assert unmarked("`--opposite` of **u_{cal}** in [the sheet](setup.html)") == (
        "--opposite of ucal in the sheet"
    )
    assert marked("a < b & [backlash(X) or one of 3]") == (
        "a &lt; b &amp; [backlash(X) or one of 3]"
    )


def test_tables_of_an_angle_instrument_are_in_its_unit(tmp_path: Path) -> None:
    with deviations_in("µrad"):
        write_page(tmp_path / "report.html", page_of(Section("One", table=LEFT)))
    assert "left, µrad" in (tmp_path / "tables" / "01-one.csv").read_text(encoding="utf-8")
    assert "µm" not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_numbers_are_written_as_programs_read_them() -> None:
    """A typographic minus and spaces between thousands are for the eye."""
    cells = ["−21, 62", "13\u202f000", "−1 300.5", "1 of 13 000", "27 31", "a − b"]
    found = [value(plain(" ".join(cell.split()))) for cell in cells]
    assert found == ["-21, 62", 13000.0, -1300.5, "1 of 13 000", "27 31", "a − b"]


@pytest.fixture
def without_weasyprint(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is installed here: the import fails as it does where it is not."""
    monkeypatch.setitem(__import__("sys").modules, "weasyprint", None)


@pytest.mark.usefixtures("without_weasyprint")
def test_nothing_to_print_with_is_said_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pdf.shutil, "which", lambda name: None)
    with pytest.raises(MissingLibrary, match="neither WeasyPrint nor a browser"):
        printer()


@pytest.mark.usefixtures("without_weasyprint")
@pytest.mark.skipif("sys.platform == 'win32'", reason="the stand-in browser is a shell script")
@pytest.mark.parametrize("fails", [False, True])
def test_a_browser_prints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: bool) -> None:
    """A stand-in for the browser takes the page's address and writes where it is asked to."""
    browser = tmp_path / "chromium"
    line = 'case "$a" in --print-to-pdf=*) cp page.html "${a#--print-to-pdf=}";; esac'
    body = "echo no screen >&2; exit 3" if fails else f"for a in $@; do {line}; done"
    browser.write_text(f"#!/bin/sh\ncd {tmp_path}\n{body}\n")
    browser.chmod(0o755)
    monkeypatch.setattr(pdf.shutil, "which", lambda name: str(browser))
    (tmp_path / "page.html").write_text("<p>page</p>")
    if fails:
        with pytest.raises(DesignError, match="no screen"):
            write_pdf(tmp_path / "page.html", tmp_path / "page.pdf", printer())
        assert not (tmp_path / "page.pdf").exists()
    else:
        write_pdf(tmp_path / "page.html", tmp_path / "page.pdf", printer())
        assert (tmp_path / "page.pdf").read_text() == "<p>page</p>"
    assert sorted(p.name for p in tmp_path.iterdir() if p.name.startswith(".")) == []


def test_a_box_says_what_a_result_means_and_what_to_do(tmp_path: Path) -> None:
    page = replace(page_of(Section("One")), means="It holds.", next="Use `it`.")
    html = rendered(page, tmp_path)
    assert "<dt>What it means</dt><dd>It holds.</dd>" in html
    assert "<dt>What to do</dt><dd>Use <code>it</code>.</dd>" in html
    assert "What it means" not in rendered(replace(page, means=""), tmp_path)
    assert 'class="box"' not in rendered(page_of(Section("One")), tmp_path)


def test_a_table_may_be_a_file_alone(tmp_path: Path) -> None:
    """The page has a link in place of its rows; the file has all of them."""
    table = Table(("pair",), [["EXX, EYY"]], "All pairs", is_file=True)
    write_page(
        tmp_path / "report.html", page_of(Section("Lists", table=LEFT), Section(table=table))
    )
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "EXX, EYY" not in html
    assert '<a href="tables/02-lists.csv">' in html
    assert "EXX, EYY" in (tmp_path / "tables" / "02-lists.csv").read_text(encoding="utf-8")


def test_a_fold_may_be_for_the_screen_alone(tmp_path: Path) -> None:
    both = Section(fold="more", sentences=["Words."])
    assert 'class="screen"' not in rendered(page_of(both), tmp_path)
    html = rendered(page_of(replace(both, is_for_screen=True)), tmp_path)
    assert '<details class="screen">' in html
    assert "details.screen { display: none; }" in html
