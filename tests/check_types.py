"""Checks the types with mypy: `make lint`.

mypy and editors read folders, and the rooms stand at the top of the project although they are
installed as `matstd.twin` and so on. So they are linked once as they are installed, in
build/types, where both read them; the links lead to the sources themselves.
"""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def link_folder(link: Path, goal: Path) -> None:
    """A folder under a second name; on Windows a junction, which needs no privilege."""
    if os.name == "nt":
        subprocess.run(["cmd", "/c", "mklink", "/J", link, goal], check=True, capture_output=True)
    else:
        link.symlink_to(goal, target_is_directory=True)


def remove_links(folder: Path) -> None:
    """The folder of links is removed, what they lead to is not."""
    for entry in folder.iterdir() if folder.exists() else ():
        if entry.is_dir() and entry.resolve() != entry.absolute():
            os.rmdir(entry) if os.name == "nt" else entry.unlink()
        else:
            entry.unlink()


def installed_layout(root: Path) -> Path:
    """build/types/matstd of a project, every folder and file where an installation has it."""
    layout = root / "build" / "types" / "matstd"
    layout.mkdir(parents=True, exist_ok=True)
    remove_links(layout)
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    for name, folder in project["tool"]["setuptools"]["package-dir"].items():
        if folder != "examples":  # scripts without annotations; tests run them
            link_folder(layout / name.removeprefix("matstd."), root / folder)
    for entry in (root / "matstd").iterdir():
        if entry.is_dir() and entry.name != "__pycache__":
            link_folder(layout / entry.name, entry)
        elif entry.is_file():
            shutil.copy2(entry, layout / entry.name)
    return layout


if __name__ == "__main__":
    installed_layout(ROOT)
    sys.exit(subprocess.run([sys.executable, "-m", "mypy"], cwd=ROOT, check=False).returncode)
