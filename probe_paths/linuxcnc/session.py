"""Starts an installed LinuxCNC on a machine of ours, answers its probe, and keeps its log."""

import json
import os
import pwd
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from matstd.probe_paths.emit import Program
from matstd.probe_paths.linuxcnc.machine_config import BESIDE, HEADLESS, MESSAGES, PROBER, PROGRAMS
from matstd.probe_paths.linuxcnc.twin_contact import TwinContact
from matstd.twin.errors import DesignError

NEEDED = ("linuxcnc", "halcmd", "halrun")
LOCK = Path("/tmp/linuxcnc.lock")  # LinuxCNC's own: one runs on a computer at a time

_TROUBLE = re.compile(r"error|failed|exited|abort|killed", re.IGNORECASE)

_PATIENCE = 3.0
"""Multiple of its planned duration, beside a minute, after which a program is stopped."""

_SHUTDOWN = 30.0  # how long LinuxCNC may take to end, s; it took 3 s


@dataclass(frozen=True)
class Session:
    """What one session left."""

    logs: Mapping[str, str]  # text of every log file by name, whole or as far as it came
    outcome: str  # empty where every program came to its end; else what stopped it, in one line
    said: str


def run_on_linuxcnc(
    programs: Sequence[Program],
    files: Mapping[str, str],
    contact: TwinContact,
    socket_path: Path,
    user: str = "",
) -> Session:
    """Run programs one after the other; raises DesignError.

    Args:
        socket_path: Where the component of the probe asks; its folder is the machine's.
        user: Who runs LinuxCNC; needed where we are root, as LinuxCNC refuses that.
    """
    folder = socket_path.parent
    _write(folder, files, programs)
    server = _listen(socket_path)
    answering = threading.Thread(target=_answer, args=(server, contact), daemon=True)
    answering.start()
    longest = sum(map(_longest, programs)) + _SHUTDOWN
    with (folder / "linuxcnc.txt").open("w") as said:
        # a session of its own, so that everything LinuxCNC starts can be ended with it
        process = subprocess.Popen(
            ["linuxcnc", "-r", "machine.ini"],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env=_environment(folder),
            user=user or None,
        )
        try:
            failed = _wait(process, contact, longest)
        finally:
            _stop(process, folder, user)
            server.close()
    text = (folder / "linuxcnc.txt").read_text(encoding="utf-8", errors="replace")
    logs = {p.name: p.read_text(errors="replace") for p in sorted(folder.glob("*_*.TXT"))}
    return Session(logs, failed or _outcome(folder, programs, text, logs), text)


def installed(user: str) -> str:
    """User who can run LinuxCNC here, empty for ourselves.

    Raises:
        DesignError: It is not installed, already runs, or we are root and no other user is named.
    """
    missing = [name for name in NEEDED if shutil.which(name) is None]
    if missing:
        found = f"LinuxCNC is not installed here ({', '.join(missing)} not found)"
        raise DesignError(f"{found}; docs/controls.md says how to install it")
    if LOCK.exists():
        raise DesignError(f"LinuxCNC is already running on this computer ({LOCK}); stop it first")
    if os.geteuid() == 0 and not user:
        raise DesignError("LinuxCNC refuses to run as root: name an ordinary user by --user")
    if user:
        try:
            entry = pwd.getpwnam(user)
        except KeyError:
            raise DesignError(f"--user {user}: no such user on this computer") from None
        if entry.pw_uid == 0:
            raise DesignError(f"--user {user}: LinuxCNC refuses root, expected an ordinary user")
        if os.geteuid() not in (0, entry.pw_uid):
            raise DesignError(f"--user {user}: only root can start LinuxCNC as another user")
        return user if entry.pw_uid != os.geteuid() else ""
    return ""


def machine_folder(user: str) -> Path:
    """A new folder in which that user may write; the caller removes it."""
    folder = Path(tempfile.mkdtemp(prefix="matstd-linuxcnc-"))
    if user:
        shutil.chown(folder, user)
    return folder


def _longest(program: Program) -> float:
    """Time after which a program is stopped, s."""
    return 60.0 + _PATIENCE * program.duration


def _write(folder: Path, files: Mapping[str, str], programs: Sequence[Program]) -> None:
    """Write all files that LinuxCNC reads."""
    queue = [f"{p.file} {_longest(p):.0f}\n" for p in programs]
    written = {p.file: p.text for p in programs} | dict(files) | {PROGRAMS: "".join(queue)}
    for name, text in written.items():
        (folder / name).write_text(text)
    for name in (PROBER, HEADLESS):
        shutil.copyfile(BESIDE / name, folder / name)
        (folder / name).chmod(0o755)
    owner = folder.stat()
    for path in folder.iterdir():
        os.chown(path, owner.st_uid, owner.st_gid)


def _environment(folder: Path) -> dict[str, str]:
    """No screen, and a home directory that LinuxCNC may write to."""
    keep = {k: v for k, v in os.environ.items() if k in ("PATH", "LANG", "LC_ALL", "TMPDIR")}
    return keep | {"HOME": str(folder)}


def _listen(path: Path) -> socket.socket:
    server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    server.bind(str(path))
    path.chmod(0o777)
    server.listen(1)
    return server


def _answer(server: socket.socket, contact: TwinContact) -> None:
    """Answer the component of the probe until it disconnects."""
    try:
        link, _ = server.accept()
    except OSError:  # LinuxCNC ended before it asked
        return
    with link, link.makefile("rw") as stream:
        for line in stream:
            _reply(stream, json.loads(line), contact)


def _reply(stream: TextIO, question: dict[str, Any], contact: TwinContact) -> None:
    answer = None
    if "late" in question:
        contact.arrived_late(float(question["late"]))
    else:
        try:
            answer = contact.travel(question["joints"], question["direction"])
        except DesignError as error:
            contact.failure = str(error)
    stream.write(json.dumps(answer) + "\n")
    stream.flush()


def _wait(process: subprocess.Popen[bytes], contact: TwinContact, longest: float) -> str:
    """Wait for the end; the reason where waiting is given up, or nothing."""
    end = time.monotonic() + longest
    while process.poll() is None:
        if contact.failure:
            return contact.failure
        if time.monotonic() > end:
            return "LinuxCNC took more than three times as long as planned and was ended"
        time.sleep(0.1)
    return ""


def _stop(process: subprocess.Popen[bytes], folder: Path, user: str) -> None:
    """End LinuxCNC and all that it started, and remove its lock."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGTERM)
        try:
            process.wait(_SHUTDOWN)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    if LOCK.exists():
        subprocess.run(
            ["halrun", "-U"],
            cwd=folder,
            env=_environment(folder),
            user=user or None,
            capture_output=True,
            timeout=_SHUTDOWN,
            check=False,
        )
        LOCK.unlink(missing_ok=True)


def _outcome(folder: Path, programs: Sequence[Program], said: str, logs: Mapping[str, str]) -> str:
    """Why not all programs are done, as far as known; empty where they are."""
    file = folder / MESSAGES
    lines = file.read_text().splitlines() if file.exists() else []
    stopped = [line for line in lines if line.startswith("stopped ")]
    if stopped:
        missed = re.findall(r"NOCONTACT P(\d+)", "".join(logs.values()))
        halt = (
            f"touch {missed[-1]} has no contact" if missed else "a test of probe, preset or machine"
        )
        return re.sub(r": (M0|1011|1014)\Z", f": {halt}", f"LinuxCNC {stopped[0]}")
    done = [line.removeprefix("done ") for line in lines if line.startswith("done ")]
    left = [p.file for p in programs if p.file not in done]
    if not left:
        return ""
    words = [line.strip() for line in said.splitlines() if _TROUBLE.search(line)]
    return f"LinuxCNC died in {left[0]}: {words[0][:200] if words else 'it said nothing of why'}"
