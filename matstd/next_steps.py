"""The command that follows a command, filled in: the last line of every run that went well.

A command that knows more than its arguments (a verdict) leaves its own answer in `args.next`.
"""

import shlex
from argparse import Namespace
from collections.abc import Callable
from pathlib import Path

LOGS = "LOG.TXT ..."  # logs of the control, whose names only the user knows


def next_line(args: Namespace) -> str:
    """`next: matstd ...   (why)`; "" for a command whose output is its text alone."""
    known = getattr(args, "next", None)
    if known is None and args.command in _AFTER:
        known = _AFTER[args.command](args)
    if not known or not known[0]:
        return ""
    words, why = known
    return f"next: {words}" + (f"   ({why})" if why else "")


Step = tuple[str, str] | None
"""A command and why, None for none."""


def called(command: str, *words: object, more: str = "") -> str:
    """A command line: words are quoted where they need be, `more` stands as it is."""
    line = shlex.join(["matstd", command, *(str(word) for word in words)])
    return f"{line} {more}".rstrip()


def _beside(output: str, name: str) -> Path:
    """A file or folder in the folder of an output."""
    return Path(output).parent / name


def _design(args: Namespace) -> Step:
    out = Path(args.output)
    kinds = (out / "programs").glob("*_A_*.*")
    program = next((f"*_A_*{p.suffix}" for p in sorted(kinds) if p.suffix in (".H", ".ngc")), "*.H")
    where = ["--standard", out / "standard.toml", "--machine", out / "machine.toml"]
    run = ["--random-errors", "--body-degC", "20", "-o", _beside(args.output, "run.csv")]
    words = called("simulate", *where, *run, more=f"{shlex.quote(str(out / 'programs'))}/{program}")
    sheet = out / "setup" / "setup.html"
    return words, f"a trial on the twin; on the machine follow {sheet}"


def _run_file(args: Namespace) -> Step:
    """Of a run file: what the model lacks, drawn on the standard that was probed."""
    if not Path(args.output).exists():
        return None
    standard = getattr(args, "standard", None)
    probed = ["--standard", standard] if standard else []
    words = called("diagnose", args.output, *probed, "-o", _beside(args.output, "diagnosis"))
    return words, "what the model lacks"


def _control_test(args: Namespace) -> Step:
    return called("diagnose", Path(args.output) / "run.csv", "-o", "diagnosis"), ""


def _replan(args: Namespace) -> Step:
    design = Path(args.design)
    where = ["--standard", design / "standard.toml", "--machine", design / "machine.toml"]
    out = "visit.csv" if args.logs[0].lower().endswith(".csv") else "run.csv"
    words = called("evaluate", *where, "-o", out, more=LOGS)
    return words, f"after the programs in {Path(args.output) / 'programs'} have run"


def _calibrate(args: Namespace) -> Step:
    if args.program:
        words = called("calibrate", args.standard, "--points", "cmm.csv", "-o", "calibrated.toml")
        return words, f"after the CMM has run {args.output}"
    words = called("evaluate", "--standard", args.output, "--machine", "machine.toml")
    return f"{words} -o run.csv {LOGS}", ""


def _compare(args: Namespace) -> Step:
    return called("diagnose", args.run_file, "-o", "diagnosis"), "what the model lacks"


def _learn(args: Namespace) -> Step:
    out = Path(args.output)
    known = ["--effects", out / "effect.py"] if (out / "effect.py").exists() else []
    words = called("compare", "--model", out / "model.toml", *known, "-o", "after", more="RUN.csv")
    return words, "the law on another run"


def _thermal(args: Namespace) -> Step:
    if args.law:
        return None
    law, out = Path(args.output) / "thermal.json", "predicted"
    return called("thermal", "--law", law, "-o", out, more="LOG.csv"), "predict another day"


def _compensate(args: Namespace) -> Step:
    if args.tables is None:
        return None
    words = called("compare", "--model", args.model, "-o", "after", more="RUN.csv")
    return words, "after the tables are in the control and the programs have run again"


def _sensitivity(args: Namespace) -> Step:
    if args.poses is not None or not Path(args.output).is_dir():
        return None
    return called("design", args.source, "-o", "OUT"), ""


def _uncertainty(args: Namespace) -> Step:
    if args.model:
        return None
    words = called("diagnose", *args.run_files, "-o", "diagnosis")
    return words, "a model in uncertainty --model corrects results and lowers U"


def _volumetric(args: Namespace) -> Step:
    words = called("show", args.machine, "--errors", args.errors, "-o", "machine.html")
    return words, "the machine with these errors in motion"


def _show(args: Namespace) -> Step:
    """Of a machine file that its user has just written."""
    if args.errors or args.model or args.program or not Path(args.machine).exists():
        return None
    project = _beside(args.machine, "project.toml")
    if project.exists():
        return called("design", project, "-o", _beside(args.machine, "out")), ""
    words = called("new", "project", "--machine", args.machine, "-o", project)
    return words, "if every axis turns about its place and in its direction"


def _contributions(args: Namespace) -> Step:
    if args.program is None or args.errors:
        return None
    tool = ["--tool-length", f"{args.tool_length:g}"] if args.tool_length is not None else []
    out = f"compensated{Path(args.program).suffix}"
    return called("compensate", args.model, *tool, "--program", args.program, "-o", out), ""


def _new(args: Namespace) -> Step:
    if args.output is None:
        return None
    output = args.output
    project, folder = _beside(output, "project.toml"), _beside(output, "out")
    return {
        "machine": (called("new", "project", "--machine", output, "-o", project), ""),
        "project": (called("design", output, "-o", folder), ""),
        "run": (called("diagnose", output, "-o", _beside(output, "diagnosis")), ""),
        "effect": (called("effects", "--effects", output), "reads it and tries it"),
    }[args.kind]


_AFTER: dict[str, Callable[[Namespace], Step]] = {
    "design": _design,
    "sensitivity": _sensitivity,
    "calibrate": _calibrate,
    "uncertainty": _uncertainty,
    "simulate": _run_file,
    "control-test": _control_test,
    "evaluate": _run_file,
    "replan": _replan,
    "import": _run_file,
    "compare": _compare,
    "learn": _learn,
    "thermal": _thermal,
    "compensate": _compensate,
    "contributions": _contributions,
    "volumetric": _volumetric,
    "show": _show,
    "new": _new,
}

WITHOUT = {
    "examples": "what was copied decides: `args.next`",
    "diagnose": "its verdict decides: `args.next`",
    "trend": "what changed decides: `args.next`",
    "serve": "ends when it is stopped",
    "machines": "prints a file or a list",
    "effects": "prints a list",
}
"""Commands without an entry, and why."""
