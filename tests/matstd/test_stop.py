"""A command that is asked to stop stops within a second, and leaves nothing half-written."""

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from matstd import stop
from matstd.stop import EXIT_STOPPED

BEGIN = """
import sys, time
from concurrent.futures import ThreadPoolExecutor
from matstd.twin.files import results_folder
from matstd.stop import clean_stop, leave
import numpy as np
try:
    with clean_stop(), results_folder(sys.argv[1]) as work:
        (work / "half.txt").write_text("half")
        print("works", flush=True)
        WORK
except KeyboardInterrupt:
    leave()
"""
"""As `matstd.__main__` runs a command."""

WORK = {
    "Python": "while True: sum(range(1000))",
    "a library": "np.linalg.svd(np.random.default_rng(0).random((5000, 5000)))",
    "waits for a pool": "with ThreadPoolExecutor() as pool: pool.submit(time.sleep, 30.0)",
}


@pytest.mark.skipif("sys.platform == 'win32'", reason="signals of the terminal are sent otherwise")
@pytest.mark.parametrize(
    ("work", "number"),
    [
        ("Python", signal.SIGINT),
        pytest.param("a library", signal.SIGINT, marks=pytest.mark.slow),
        ("a library", signal.SIGTERM),
        ("waits for a pool", signal.SIGTERM),
    ],
)
def test_it_ends_and_tidies_up(tmp_path: Path, work: str, number: int) -> None:
    code = [sys.executable, "-c", BEGIN.replace("WORK", WORK[work]), str(tmp_path / "out")]
    process = subprocess.Popen(code, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline().strip() == b"works"
    time.sleep(0.3)
    process.send_signal(number)
    try:
        _, message = process.communicate(timeout=20.0)  # work goes on for 30 s and more
    finally:
        process.kill()
    assert process.returncode == EXIT_STOPPED
    assert b"stopped" in message
    assert list(tmp_path.iterdir()) == []


def test_what_is_gone_already_does_not_keep_the_rest(tmp_path: Path, monkeypatch) -> None:
    """Another thread has removed the first folder and the first file."""
    folders, files = ([tmp_path / f"{word}{k}" for k in range(2)] for word in ("folder", "file"))
    folders[1].mkdir()
    (folders[1] / "half.txt").write_text("half")
    files[1].write_text("half")
    begun = {"WORKING": folders, "UNFINISHED": files}
    monkeypatch.setattr(stop, "_begun", lambda _, name: begun[name])
    monkeypatch.setattr(stop, "_LAST_WORDS", threading.Lock())
    monkeypatch.setattr("os._exit", sys.exit)
    with pytest.raises(SystemExit, match=str(EXIT_STOPPED)):
        stop.leave()
    assert list(tmp_path.iterdir()) == []
