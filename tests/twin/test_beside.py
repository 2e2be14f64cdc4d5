"""Calls in another process: the same results and errors, and nothing left behind."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from matstd.twin import beside as module
from matstd.twin.beside import beside, kept_beside
from matstd.twin.compute import blocks
from matstd.twin.errors import BadFile
from matstd.twin.files import read_machine


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "CORES", 2)


@pytest.mark.usefixtures("two_cores")
def test_the_result_comes_from_another_process_and_errors_come_back() -> None:
    with beside(os.getpid) as pid, beside(read_machine, "none.toml") as refused:
        assert pid() != os.getpid()
        with pytest.raises(BadFile, match=r"none\.toml"):
            refused()


@pytest.mark.usefixtures("two_cores")
def test_what_the_call_prints_does_not_come_between(capfd: pytest.CaptureFixture[str]) -> None:
    with beside(print, "a word", flush=True) as result:
        assert result() is None
    assert capfd.readouterr() == ("", "a word\n")  # nor does Python's own end complain


@pytest.mark.usefixtures("two_cores")
def test_what_cannot_be_sent_or_dies_is_done_here() -> None:
    here = threading.get_ident()
    with beside(lambda: threading.get_ident()) as result:
        assert result() == here
    with beside(_end_unless_in, os.getpid()) as result:
        assert result() == "here"


def _end_unless_in(process: int) -> str:
    if os.getpid() != process:
        os._exit(3)
    return "here"


def test_on_one_core_it_is_done_here_when_asked_for() -> None:
    order = []
    with beside(order.append, "called") as result:
        order.append("first")
        result()
    assert order == ["first", "called"]
    with beside(blocks, 1, 1):
        pass  # who does not ask gets nothing


@pytest.mark.usefixtures("two_cores")
def test_a_kept_process_serves_the_next_call_until_all_is_over() -> None:
    with kept_beside():
        with beside(os.getpid) as first, beside(os.getpid) as second:
            processes = {first(), second()}
        with beside(read_machine, "none.toml") as refused, pytest.raises(BadFile):
            refused()
        for _ in range(3):
            with beside(os.getpid) as again:
                assert again() in processes
        with kept_beside(), beside(time.sleep, 600.0):
            pass  # one that has not answered is not kept
        assert len(module._Kept.idle or []) == 1
    with beside(os.getpid) as other:
        assert other() not in processes


@pytest.mark.usefixtures("two_cores")
def test_leaving_ends_the_other_process(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def noted(*args: object, **options: object) -> subprocess.Popen[bytes]:
        begun.append(popen(*args, **options))  # type: ignore[call-overload]
        return begun[-1]

    monkeypatch.setattr(module.subprocess, "Popen", noted)
    with pytest.raises(KeyboardInterrupt), beside(time.sleep, 600.0):
        raise KeyboardInterrupt
    assert begun[0].poll() is not None


_LONE = """
import os, sys, time
from matstd.twin import beside
beside.CORES = 2
with beside.beside(time.sleep, 600.0):
    open(sys.argv[1], "w").write("begun")
    os._exit(0)
"""


def test_it_ends_with_the_first_process_however_that_ends(tmp_path: Path) -> None:
    """The pipe that it inherits is at its end when both are gone."""
    read, write = os.pipe()
    os.set_inheritable(write, True)
    command = [sys.executable, "-c", _LONE, str(tmp_path / "begun")]
    subprocess.run(command, check=True, pass_fds=[write], stderr=write, timeout=60.0)
    os.close(write)
    with os.fdopen(read) as pipe:
        assert pipe.read() == ""  # waits for the end of all who hold it
    assert (tmp_path / "begun").read_text() == "begun"
