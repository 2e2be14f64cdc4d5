"""Contents, tables and print of a page."""

import csv
import re
from pathlib import Path

import openpyxl
import pytest

from matstd.diagnosis.choice.prediction import Choice, ChoiceRule
from matstd.report.pages import pdf
from matstd.report.pages.page import with_contents
from matstd.report.pages.pdf import printer, write_pdf
from matstd.report.pages.tables import page_tables, plain, value, write_tables
from matstd.twin.errors import DesignError, MissingLibrary

TEMPLATES = Path(pdf.__file__).parent / "templates"
PAGE = """<h2>What is <code>left</code></h2>
<table><caption>Two   lines</caption>
<tr><th rowspan="2">artefact</th><th colspan="2">left, µm</th></tr>
<tr><th>rms</th><th>95 %</th></tr>
<tr><td>block</td><td>1.50</td><td>−2</td></tr>
<tr><td>spheres<br>four</td><td>3 of 4</td></tr></table>
<h3>Empty</h3><table><tr><th>name</th></tr></table>
<table><tr><th>mass</th><td>26 kg</td></tr></table>"""


def test_every_section_is_in_the_contents() -> None:
    body = "<p>Verdict.</p><h2>One</h2>a<h2>Two &amp; three</h2>b<h2>One</h2>"
    page = str(with_contents(body))
    links = re.findall(r'<a href="#([^"]+)">([^<]*)</a>', page)
    assert [text for _, text in links] == ["One", "Two &amp; three", "One"]
    assert re.findall(r'<h2 id="([^"]+)"', page) == [address for address, _ in links]
    assert len({address for address, _ in links}) == 3
    assert page.index("Verdict") < page.index("<nav") < page.index("<h2")


def test_short_pages_have_no_contents() -> None:
    assert "<nav" not in with_contents("<h2>One</h2><h2>Two</h2>")


def test_tables_say_what_the_page_says(tmp_path: Path) -> None:
    """Cells that span are repeated; numbers are numbers in the workbook; bare headings go."""
    (tmp_path / "report.html").write_text(PAGE, encoding="utf-8")
    files = write_tables(tmp_path / "report.html")
    assert [f.relative_to(tmp_path).as_posix() for f in files] == [
        "tables/01-what-is-left.csv",
        "tables/02-empty.csv",
        "tables.xlsx",
    ]
    rows = list(csv.reader(files[0].read_text(encoding="utf-8").splitlines()))
    assert rows == [
        ["artefact", "left, µm", "left, µm"],
        ["artefact", "rms", "95 %"],
        ["block", "1.50", "-2"],
        ["spheres four", "3 of 4", ""],
    ]
    sheet = openpyxl.load_workbook(files[-1]).worksheets[0]
    assert sheet["A1"].value == "Two lines"
    assert [cell.value for cell in sheet[4]] == ["block", 1.5, -2]
    assert sheet["A2"].font.bold
    assert not sheet["A4"].font.bold


def test_numbers_are_written_as_programs_read_them() -> None:
    """A typographic minus and spaces between thousands are for the eye."""
    cells = ["−21, 62", "13\u202f000", "−1 300.5", "1 of 13 000", "27 31", "a − b"]
    found = [value(plain(" ".join(cell.split()))) for cell in cells]
    assert found == ["-21, 62", 13000.0, -1300.5, "1 of 13 000", "27 31", "a − b"]


def test_a_row_with_a_heading_cell_is_data() -> None:
    assert page_tables(PAGE)[-1].rows == [["mass", "26 kg"]]


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
    """A stand-in for the browser takes the page's address and writes where it is told to."""
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


def test_the_page_of_a_diagnosis_asks_a_choice_for_what_it_has() -> None:
    """A choice by prediction stands on few pages: its names are checked against its records."""
    html = (TEMPLATES / "diagnose.html").read_text(encoding="utf-8")
    for record, pattern in ((Choice, r"result\.choice\.(\w+)"), (ChoiceRule, r"\bway\.(\w+)")):
        asked = set(re.findall(pattern, html))
        assert asked
        assert asked <= set(dir(record)) | set(record.__dataclass_fields__)
