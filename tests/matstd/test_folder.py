"""Results appear whole or not at all, and nothing of the user's is lost."""

from pathlib import Path

import pytest

from matstd.folder import results_folder
from twin.errors import DesignError


def test_whole(tmp_path: Path) -> None:
    out = tmp_path / "a" / "out"
    with results_folder(out) as work:
        (work / "sub").mkdir()
        (work / "sub" / "x.txt").write_text("x")
        assert not out.exists()
    assert (out / "sub" / "x.txt").read_text() == "x"
    assert [p.name for p in out.parent.iterdir()] == ["out"]


def test_nothing_is_left_of_a_failure(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def fail() -> None:
        with results_folder(out) as work:
            (work / "x.txt").write_text("x")
            raise ValueError("stopped")

    with pytest.raises(ValueError, match="stopped"):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_a_full_folder_is_refused_and_with_force_kept(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.txt").write_text("mine")
    (out / "x.txt").write_text("old")
    with pytest.raises(DesignError, match="--force"), results_folder(out):
        pass
    with results_folder(out, force=True) as work:
        (work / "x.txt").write_text("new")
    assert (out / "mine.txt").read_text() == "mine"
    assert (out / "x.txt").read_text() == "new"
