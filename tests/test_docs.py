"""What the pages and docstrings name exists: modules, names, files, commands."""

import doctest
import importlib
import re
from pathlib import Path

import pytest
from faces import face_of

from matstd.cli import COMMANDS

ROOT = Path(__file__).parents[1]
ROOMS = (
    "twin",
    "importers",
    "sensitivity",
    "information",
    "nc",
    "artefact",
    "diagnosis",
    "cad_out",
    "probe_paths",
    "compensation",
    "report",
    "matstd",
)
PAGES = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")]
TEXTS = {"pages": PAGES} | {room: sorted((ROOT / room).rglob("*.py")) for room in ROOMS}
OURS = re.compile(r"`((?:{})(?:[./]\w+)+)(?:\([^`]*\))?`".format("|".join(ROOMS)))
FILES = {"html", "json", "csv", "toml", "md"}
"""Endings of files that a command writes: `diagnosis.json` is no module."""


def is_there(name: str) -> bool:
    """Whether a dotted name or a path means something in this repository."""
    words = name.replace("/", ".").split(".")
    if (ROOT / name).exists() or words[-1] in FILES:
        return True
    if words[0] != "matstd":
        return False  # a room is installed as `matstd.twin` alone
    for k in range(len(words), 0, -1):
        try:
            thing = importlib.import_module(".".join(words[:k]))
        except ImportError:
            continue
        for word in words[k:]:
            if not hasattr(thing, word):
                return False
            thing = getattr(thing, word)
        return True
    return False


def test_a_dead_name_is_seen() -> None:
    assert is_there("matstd.twin.machine.Chain")
    assert is_there("docs/conventions.md")
    assert not is_there("matstd.twin.machine.Chein")
    assert not is_there("matstd.twin.engine")
    assert not is_there("twin.machine")


@pytest.mark.parametrize("where", TEXTS)
def test_what_is_named_exists(where: str) -> None:
    for file in TEXTS[where]:
        text = file.read_text(encoding="utf-8")
        assert [(file, name) for name in OURS.findall(text) if not is_there(name)] == []
        commands = re.findall(r"`matstd ([a-z]+)[ `]", text)
        assert set(commands) <= set(COMMANDS), file


def test_links_of_the_pages_lead_somewhere() -> None:
    for file in PAGES:
        for goal in re.findall(r"\]\(([^)#]+)[^)]*\)", file.read_text(encoding="utf-8")):
            assert "://" in goal or (file.parent / goal).exists(), f"{file}: {goal}"


def anchors(page: Path) -> set[str]:
    """Anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings}


def test_links_to_parts_of_pages_lead_to_headings() -> None:
    for file in PAGES:
        for page, part in re.findall(r"\]\(([^)#:]*)#([^)]+)\)", file.read_text(encoding="utf-8")):
            assert part in anchors(file.parent / page if page else file), f"{file}: {page}#{part}"


def test_every_page_is_in_the_index() -> None:
    """`docs/README.md` links every page of its folder; that of the formats, all of its own."""
    for folder in (ROOT / "docs", ROOT / "docs" / "formats"):
        listed = set(re.findall(r"\]\(([\w/]+\.md)", (folder / "README.md").read_text("utf-8")))
        pages = {page.name for page in folder.glob("*.md")} - {"README.md"}
        assert pages - listed == set()


def test_the_readme_stays_short() -> None:
    assert (ROOT / "README.md").stat().st_size <= 15_000


def test_the_index_of_the_interface_names_what_is_there() -> None:
    """Every part has its chapter, every name in it exists; `make api` brings it up to date."""
    chapter, parts = "", []
    for line in (ROOT / "docs" / "api.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("### "):
            chapter = line.removeprefix("### ")
            parts.append(chapter)
        elif found := re.match(r"\| `(\w+)` \|", line):
            assert found[1] in face_of(importlib.import_module(chapter)), f"{chapter}.{found[1]}"
    listed = [
        f"matstd.{r}.{p}" for r in ROOMS[:-1] for p in importlib.import_module(f"matstd.{r}").PARTS
    ]
    assert parts == ["matstd", *listed]


@pytest.mark.parametrize("room", ROOMS)
def test_examples_of_docstrings_say_what_they_give(room: str) -> None:
    for file in TEXTS[room]:
        if file.parent.name == "api":
            continue  # its examples name files: tests/test_door.py
        if ">>>" in file.read_text(encoding="utf-8"):
            inner = ".".join(file.relative_to(ROOT).with_suffix("").parts)
            name = inner if room == "matstd" else f"matstd.{inner}"
            done = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
            assert done.failed == 0, name
