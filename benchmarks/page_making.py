"""What the moving part of a page adds to the command that makes it: processor time and memory.

    python benchmarks/page_making.py RUN.csv [--project PROJECT.toml] [--machine MACHINE.toml]

Every command runs twice in processes of its own: as it is, and with the view left out of the page,
which then has the still report alone. Differences are of processor time (user and system) and of
the largest memory. `matstd show` makes nothing else: its figures are those of the whole command,
the libraries that it loads among them.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from harness import parser_of

VIEWS = {
    "compare": ("matstd.report.pages.compare_page", "comparison_view"),
    "diagnose": ("matstd.report.pages.diagnosis_page", "diagnosis_view"),
    "learn": ("matstd.api.learning", "learnt_view"),
    "design": ("matstd.report.pages.design_page", "design_live"),
}
CHILD = """import importlib, sys
module, name = sys.argv[1:3]
if name:
    setattr(importlib.import_module(module), name, lambda *given, **named: None)
from matstd.cli import main
sys.exit(main(sys.argv[3:]))"""


def spent(words: list[str], module: str = "", name: str = "") -> tuple[float, float]:
    """Processor time, s, and largest memory, MB, of a command, with one function left out."""
    child = [sys.executable, "-c", CHILD, module, name, *words]
    process = subprocess.Popen(child, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0, words
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main() -> None:
    """All commands that the arguments suffice for."""
    parser = parser_of(__doc__)
    parser.add_argument("run")
    parser.add_argument("--project", help="a project to be designed, too; minutes")
    parser.add_argument("--machine", help="a machine to be shown, too")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        inputs = {"compare": given.run, "diagnose": given.run, "learn": given.run}
        inputs |= {"design": given.project} if given.project else {}
        for command, file in inputs.items():
            whole = spent([command, file, "-o", str(out / command)])
            still = spent([command, file, "-o", str(out / f"{command}-still")], *VIEWS[command])
            size = (out / command / "report.html").stat().st_size / 1e6
            print(
                f"{command}: {whole[0]:.1f} s and {whole[1]:.0f} MB, {still[0]:.1f} s and "
                f"{still[1]:.0f} MB without; the view adds {whole[0] - still[0]:.1f} s and "
                f"{whole[1] - still[1]:.0f} MB; page {size:.2f} MB"
            )
        if given.machine:
            page = out / "machine.html"
            whole = spent(["show", given.machine, "-o", str(page)])
            print(
                f"show: the whole command {whole[0]:.1f} s and {whole[1]:.0f} MB; page "
                f"{page.stat().st_size / 1e6:.2f} MB"
            )


if __name__ == "__main__":
    main()
