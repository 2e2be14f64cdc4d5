"""Results appear whole or not at all, and nothing of the user's is lost."""

import subprocess
import sys
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


def test_what_a_refused_run_leaves_does_not_stand_in_the_way(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "reach-refused.png").write_text("picture")
    with results_folder(out, refused=["reach-refused.png"]) as work:
        (work / "x.txt").write_text("x")
    assert [p.name for p in out.iterdir()] == ["x.txt"]


def test_a_report_alone_is_not_overwritten(tmp_path: Path) -> None:
    """Results that not every run has are removed when they are stale, not taken for an own."""
    (tmp_path / "report.html").write_text("mine")
    with pytest.raises(DesignError, match="--force"), results_folder(tmp_path, ours=["*.html"]):
        pass
    assert (tmp_path / "report.html").read_text() == "mine"


WORKS = """
import sys, time
from matstd.folder import results_folder
with results_folder(sys.argv[1]) as work:
    (work / "half.txt").write_text("half")
    print("works", flush=True)
    time.sleep(60)
"""


def test_what_a_killed_run_left_goes_at_the_next_start(tmp_path: Path) -> None:
    """Only ours, only of the same results, and not while its process lives."""
    running, killed = (
        subprocess.Popen([sys.executable, "-c", WORKS, str(tmp_path / "out")], stdout=-1)
        for _ in range(2)
    )
    strangers = [tmp_path / ".out-01234567", tmp_path / ".other-0123abcd", tmp_path / ".out-backup"]
    try:
        for process in (running, killed):
            assert process.stdout is not None
            assert process.stdout.readline().strip() == b"works"
        killed.kill()
        killed.wait()
        for stranger in strangers:
            (stranger / "results").mkdir(parents=True)
        assert len(list(tmp_path.glob(".out-*/results/half.txt"))) == 2
        with results_folder(tmp_path / "out"):
            assert len(list(tmp_path.glob(".out-*/results/half.txt"))) == 1
    finally:
        for process in (running, killed):
            process.kill()
            process.communicate()
    with results_folder(tmp_path / "out", force=True):
        pass
    assert sorted(p for p in tmp_path.iterdir() if p.name != "out") == sorted(strangers)
