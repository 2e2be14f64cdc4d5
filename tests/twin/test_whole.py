"""Files are written whole or not at all, never onto a device and never onto what is read."""

import os
from pathlib import Path

import pytest

from matstd.twin.errors import DesignError
from matstd.twin.files.whole import refuse_own_input, refuse_to_overwrite, write_whole


def test_a_device_is_no_output(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (pipe, tmp_path, Path("/dev/null")):
        with pytest.raises(DesignError, match=r"cannot be written \(it is a folder or a device"):
            write_whole(path, "x")
    assert Path("/dev/null").is_char_device()


def test_a_link_keeps_leading_to_its_file(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    link = tmp_path / "link.csv"
    link.symlink_to(tmp_path / "there" / "file.csv")
    write_whole(link, "x")
    assert link.is_symlink()
    assert (tmp_path / "there" / "file.csv").read_text() == "x"


@pytest.mark.parametrize("name", ["x" * 300 + ".csv", "a\0b.csv", "x" * 5000])
def test_names_that_no_system_takes(tmp_path: Path, name: str) -> None:
    refuse_to_overwrite(tmp_path / name)
    with pytest.raises(DesignError, match="cannot be written") as caught:
        write_whole(tmp_path / name, "x")
    assert len(str(caught.value)) < 400
    assert list(tmp_path.iterdir()) == []


def test_no_text_gets_the_name_of_a_spreadsheet(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"Run\.XLSX: no spreadsheet is written, .* run\.csv"):
        refuse_to_overwrite(tmp_path / "Run.XLSX", force=True)


def test_the_longest_name_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 251 + ".csv")
    write_whole(path, "x")
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_an_output_that_is_read_is_refused(tmp_path: Path) -> None:
    run, link, sub = tmp_path / "run.csv", tmp_path / "link.csv", tmp_path / "out"
    run.write_text("measurements")
    link.symlink_to(run)
    sub.mkdir()
    refuse_own_input(sub, [run, "--force", "no such file"])
    refuse_own_input(tmp_path / "new", [run])
    for output in (run, link):
        with pytest.raises(DesignError, match="is an input of this command"):
            refuse_own_input(output, [run])
    with pytest.raises(DesignError, match=r"holds run.csv, an input of this command"):
        refuse_own_input(tmp_path, [run])


def test_a_command_keeps_its_input(tmp_path: Path, refusal) -> None:
    poses = tmp_path / "poses.csv"
    poses.write_text("X_mm\n1\n")
    machine = tmp_path / "machine.toml"
    machine.write_text("")
    words = ["volumetric", str(machine), str(machine), str(poses)]
    assert "is an input of this command" in refusal([*words, "-o", str(poses), "--force"])
    assert poses.read_text() == "X_mm\n1\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
def test_words_that_find_no_room_are_one_line() -> None:
    import subprocess
    import sys

    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "matstd", "effects"],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "matstd effects: cannot write its words (No space left on device)\n"
