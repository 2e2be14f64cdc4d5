"""The CAD kernel as another process: its crash becomes one clear error."""

import os
import signal
import subprocess
import sys
from pathlib import Path

from cad_out.worker import REFUSAL
from twin.errors import NotBuildable

_ROOT = Path(__file__).resolve().parent.parent


def run_kernel(task: str, folder: Path, *arguments: float, timeout: float = 150.0) -> None:
    """Run one task of `cad_out.worker` in a process of its own.

    Args:
        task: Name of the function.
        folder: Through which the two processes speak.
        arguments: Further numbers for the function.
        timeout: After which the process is stopped, s.

    Raises:
        NotBuildable: The task refuses; or the kernel crashes, fails or takes too long.
    """
    call = f"import cad_out.worker; cad_out.worker.{task}({str(folder)!r}, *{arguments!r})"
    path = os.pathsep.join(filter(None, [str(_ROOT), os.environ.get("PYTHONPATH")]))
    try:
        done = subprocess.run(
            [sys.executable, "-c", call],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise NotBuildable(
            f"the CAD kernel did not finish the task '{task}' within {timeout:g} s"
        ) from error
    refusal = folder / REFUSAL
    if done.returncode == 0 and not refusal.exists():
        return
    if refusal.exists():
        raise NotBuildable(refusal.read_text(encoding="utf-8"))
    raise NotBuildable(
        f"the CAD kernel {_end_of(done.returncode)} in the task '{task}'; nothing was written"
        + _last_line(done.stderr),
        exit_code=done.returncode,
    )


def _end_of(code: int) -> str:
    """Words for the way a process ended."""
    if code < 0:
        return f"crashed ({signal.Signals(-code).name}, exit code {code})"
    return f"failed (exit code {code})"


def _last_line(text: str) -> str:
    lines = [line for line in text.splitlines() if line.strip()]
    return f": {lines[-1].strip()}" if lines else ""
