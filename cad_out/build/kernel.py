"""The CAD kernel as another process: its crash becomes one clear error."""

from pathlib import Path

from matstd.cad_out.build.process import run_apart
from matstd.twin.errors import DesignError, NotBuildable


def run_kernel(task: str, folder: Path, *arguments: float | str, timeout: float = 400.0) -> None:
    """Run one task of `matstd.cad_out.build.worker` in a process of its own.

    Args:
        task: Name of the function.
        folder: Through which the two processes speak.
        arguments: Further arguments of the function.
        timeout: After which the process is stopped, s.

    Raises:
        NotBuildable: The task refuses; or the kernel crashes, fails or takes too long.
        DesignError: The folder takes no more.
    """
    ending = run_apart("matstd.cad_out.build.worker", task, folder, *arguments, timeout=timeout)
    if ending.refusal:
        raise NotBuildable(ending.refusal)
    if ending.last_line.startswith("OSError: "):  # it could not even write down why
        raise DesignError(f"{folder.parent}: cannot be written ({ending.last_line[9:]})")
    if not ending.is_good:
        raise NotBuildable(
            f"the CAD kernel {ending} (task '{task}'); nothing was written", exit_code=ending.code
        )
