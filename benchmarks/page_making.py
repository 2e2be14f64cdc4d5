"""What the moving part of a page adds to the command that makes it: processor time and memory.

    python benchmarks/page_making.py RUN.csv [--project PROJECT.toml] [--machine MACHINE.toml]

Processor time is that of the function that makes the view, within the command. Memory is the
largest of the command against that of a run with the view left out of the page, each in a process
of its own. `matstd show` makes nothing else.
"""

import os
import re
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
    "show": ("matstd.api.showing", "machine_html"),
}
CHILD = """import importlib, sys, time
from matstd.cli import main
module, name, how = sys.argv[1:4]
place = importlib.import_module(module)
made = getattr(place, name)
def timed(*given, **named):
    begun = time.process_time()
    try:
        return made(*given, **named)
    finally:
        print(f"VIEW {time.process_time() - begun}", file=sys.stderr)
setattr(place, name, timed if how == "timed" else lambda *given, **named: None)
sys.exit(main(sys.argv[4:]))"""


def spent(command: str, words: list[str], how: str) -> tuple[float, float, float]:
    """Processor time of a command, that of its view alone, s, and the largest memory, MB."""
    child = [sys.executable, "-c", CHILD, *VIEWS[command], how, command, *words]
    with subprocess.Popen(
        child, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        said = process.stderr.read() if process.stderr else ""
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = status
    assert status == 0, said
    view = re.search(r"VIEW (\S+)", said)
    whole = usage.ru_utime + usage.ru_stime
    return whole, float(view[1]) if view else 0.0, usage.ru_maxrss / 1024


def one(command: str, words: list[str], page: Path) -> None:
    """A line on one command."""
    whole, view, memory = spent(command, [*words, "--force"], "timed")
    size = page.stat().st_size / 1e6
    more = ""
    if command != "show":
        less = spent(command, [*words, "--force"], "without")[2]
        more = f", {memory - less:.0f} MB more than without it"
    print(
        f"{command}: the view takes {view:.2f} s of {whole:.1f} s of processor{more}; largest "
        f"memory {memory:.0f} MB; page {size:.2f} MB",
        flush=True,
    )


def main() -> None:
    """All commands that the arguments suffice for."""
    parser = parser_of(__doc__)
    parser.add_argument("run")
    parser.add_argument("--project", help="a project to be designed, too; minutes")
    parser.add_argument("--machine", help="a machine to be shown, too")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        for command in ("compare", "diagnose", "learn"):
            place = out / command
            one(command, [given.run, "-o", str(place)], place / "report.html")
        if given.machine:
            page = out / "machine.html"
            one("show", [given.machine, "-o", str(page)], page)
        if given.project:
            place = out / "design"
            one("design", [given.project, "-o", str(place)], place / "report.html")


if __name__ == "__main__":
    main()
