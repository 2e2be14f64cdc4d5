"""Work in a process of its own: a crash of the CAD kernel becomes one clear error."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.cad_out.kernel.worker import MESH, STEP
from matstd.twin.errors import DesignError, NotBuildable
from matstd.twin.frames import Array

REFUSAL = "refusal.txt"  # file in the shared folder that holds the reason of a refusal

HUNG_AFTER = 3600.0
"""Seconds after which the kernel counts as hung: forty times what it needs, for a busy machine."""

_CALL = """\
import pathlib, {module}, matstd.twin.errors
try:
    {module}.{task}{arguments}
except matstd.twin.errors.DesignError as refusal:
    pathlib.Path({refusal!r}).write_text(str(refusal), encoding="utf-8")
"""


@dataclass(frozen=True, slots=True)
class Ending:
    """How a task in another process ended."""

    code: int | None  # exit code; negative for a signal, None for a task that was stopped
    refusal: str  # what the task itself refused, in one line; empty if nothing
    last_line: str  # last line of what it complained about

    @property
    def is_good(self) -> bool:
        """Whether the task ran to its end and refused nothing."""
        return self.code == 0 and not self.refusal

    def __str__(self) -> str:
        if self.refusal:
            return self.refusal
        if self.code is None:
            return "did not finish in time and was stopped"
        words = f"failed (exit code {self.code})"
        if self.code < 0:
            words = f"crashed ({signal.Signals(-self.code).name}, exit code {self.code})"
        return f"{words}: {self.last_line}" if self.last_line else words


def run_apart(
    module: str,
    task: str,
    folder: Path,
    *arguments: float | str,
    timeout: float = 150.0,
    environment: dict[str, str] | None = None,
) -> Ending:
    """Run ``module.task(folder, *arguments)`` in a new process; raises nothing, returns its ending.

    Args:
        task: A function that takes the folder and the arguments; a `DesignError` that it raises is
            its refusal.
        timeout: After which the process is stopped, s.
    """
    refusal = folder / REFUSAL
    call = _CALL.format(
        module=module, task=task, arguments=(str(folder), *arguments), refusal=str(refusal)
    )
    try:
        # without stdin a task that asks for input fails instead of waiting
        done = subprocess.run(
            [sys.executable, "-c", call],
            env={**os.environ, **(environment or {})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=timeout,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Ending(None, "", "")
    reason = refusal.read_text(encoding="utf-8") if refusal.exists() else ""
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return Ending(done.returncode, reason, lines[-1] if lines else "")


def run_kernel(
    task: str, folder: Path, *arguments: float | str, timeout: float = HUNG_AFTER
) -> None:
    """Run one task of `matstd.cad_out.kernel.worker` in a process of its own.

    Args:
        timeout: After which the process is stopped, s.

    Raises:
        NotBuildable: The task refuses; or the kernel crashes, fails or takes too long.
        DesignError: The folder takes no more.
    """
    ending = run_apart("matstd.cad_out.kernel.worker", task, folder, *arguments, timeout=timeout)
    if ending.refusal:
        raise NotBuildable(ending.refusal)
    if ending.last_line.startswith("OSError: "):  # it could not even write down why
        raise DesignError(f"{folder.parent}: cannot be written ({ending.last_line[9:]})")
    if not ending.is_good:
        raise NotBuildable(
            f"the CAD kernel {ending} (task '{task}'); nothing was written", exit_code=ending.code
        )


CHORD = 0.3
"""Distance between triangles and faces that is asked for, mm: less than a pixel of a page."""


def step_triangles(path: Path, chord: float = CHORD) -> Array:
    """Triangles of all bodies of a STEP file, (T, 3, 3), mm; raises NotBuildable."""
    with tempfile.TemporaryDirectory(prefix="step-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        shutil.copyfile(path, folder / STEP)
        run_kernel("mesh_step", folder, chord)
        with np.load(folder / MESH) as mesh:
            return np.asarray(mesh["corners"][mesh["triangles"]], dtype=np.float64)
