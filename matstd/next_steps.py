"""The command that follows a command, filled in: the last line of every run that went well.

A command that knows more than its arguments (a verdict) leaves its own answer in `args.next`.
"""

import re
import shlex
from argparse import Namespace
from collections.abc import Callable
from pathlib import Path

LOGS = "LOG.TXT ..."  # logs of the control, whose names only the user knows
AUTO = "--auto"  # every effect that is found; without it a second diagnosis adds the first one
PLANTED = "thermal-lag(EZZ)=12um,tau=15min"  # in a trial on the twin: what the model does not know
YOUR_TABLE = "; --table-mm is the size of your table"  # a template states that of its kind
RUN = "RUN.csv"  # a run that is still to be measured
FEWEST_OF_A_TREND = 3  # runs of one machine, as `matstd trend` asks
MODELLED = ("standard", "model", "start", "pitch", "effects")
"""Options on what a run is compared with."""
STATED = (
    "datum",
    "within",
    "after",
    "temperature",
    "value",
    "rpm",
    "load",
    "add",
    "switch",
    "active",
)
"""Options on the state of a machine that is corrected."""


def next_line(args: Namespace) -> str:
    """`next: matstd ...   (why)`; "" for a command whose output is not there."""
    known = getattr(args, "next", None)
    if known is None and args.command in _AFTER:
        known = _AFTER[args.command](args)
    if not known or not known[0]:
        return ""
    words, why = known
    return f"next: {words}" + (f"   ({why})" if why else "")


Step = tuple[str, str] | None  # a command and why, None for none


def called(command: str, *words: object, more: str = "") -> str:
    """A command line: words are quoted where they need be, `more` stands as it is.

    An output that is there already gets another name, since no command writes over it unasked.
    """
    stated = [str(word) for word in words]
    output = stated.index("-o") + 1 if "-o" in stated else None
    if output is not None and Path(stated[output]).exists():
        from matstd.twin.files.whole import free_name  # help and refusals need no numpy

        stated[output] = str(free_name(Path(stated[output])))
    line = shlex.join(["matstd", command, *stated])
    return f"{line} {more}".rstrip()


def kept(args: Namespace, *names: str) -> list[object]:
    """Options as they were given, for a command that takes them too."""
    words: list[object] = []
    for name in names:
        given = getattr(args, name, None)
        if given is None or given is False or given == args.parser.get_default(name):
            continue
        option = f"--{name.replace('_', '-')}"
        if given is True:
            words.append(option)
        elif isinstance(given, list) and _is_repeated(args, name):
            words += [word for one in given for word in (option, one)]
        else:
            words += [option, *(f"{v:g}" if isinstance(v, float) else v for v in _each(given))]
    return words


def _is_repeated(args: Namespace, name: str) -> bool:
    """Whether an option takes one word each time that it is given."""
    return any(one.dest == name and one.nargs is None for one in args.parser._actions)


def _each(given: object) -> list[object]:
    return given if isinstance(given, list) else [given]


def _beside(output: str, name: str) -> Path:
    """A file or folder in the folder of an output."""
    return Path(output).parent / name


def _design(args: Namespace) -> Step:
    out = Path(args.output)
    kinds = (out / "programs").glob("*_A_*.*")
    program = next((f"*_A_*{p.suffix}" for p in sorted(kinds) if p.suffix in (".H", ".ngc")), "*.H")
    where = ["--standard", out / "standard.toml", "--machine", out / "machine.toml"]
    body = ["--body-degC", "20", "-o", _beside(args.output, "run.csv")]
    run = ["--random-errors", "--add", PLANTED, *body]
    words = called("simulate", *where, *run, more=f"{shlex.quote(str(out / 'programs'))}/{program}")
    sheet = out / "setup" / "setup.html"
    return words, f"a trial on the twin with a growth to be found; on the machine follow {sheet}"


def _run_file(args: Namespace) -> Step:
    """Of a run file: what the model lacks, drawn on the standard that was probed."""
    if not Path(args.output).exists():
        return None
    standard = getattr(args, "standard", None)
    # `import --standard` says what its lists are, and names no file
    probed = ["--standard", standard] if isinstance(standard, str) else []
    words = called("diagnose", args.output, *probed, AUTO, "-o", _beside(args.output, "diagnosis"))
    return words, "what the model lacks"


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
    words = called("diagnose", args.run_file, *kept(args, *MODELLED), AUTO, "-o", "diagnosis")
    return words, "what the model lacks"


def _thermal(args: Namespace) -> Step:
    if args.law is None:
        law = Path(args.output) / "thermal.json"
        return called("thermal", "--law", law, "-o", "predicted", more="LOG.csv"), "another day"
    if args.probed is None:
        options = ["--law", args.law, "--probed", "probed.csv", "-o", f"{args.output}-2"]
        return called("thermal", *args.logs, *options), "with drifts probed on a standard"
    return called("effects", "drift-law"), "how the law enters a model, tables and the service"


def _errors(args: Namespace) -> list[object]:
    """The model, or the machine with its known errors, and the tool."""
    return [args.model, *kept(args, "errors", "effects", "tool_length", *STATED)]


def _probed_again(args: Namespace) -> str:
    """What the same programs show of a machine that is corrected."""
    if args.errors:  # of a machine file; a model predicts
        return called("diagnose", AUTO, "-o", "after", more=RUN)
    return called("compare", "--model", args.model, "-o", "after", more=RUN)


def _compensate(args: Namespace) -> Step:
    if args.program is not None:
        words = called("contributions", *_errors(args), "--program", args.program, "-o", "shares")
        return words, "which errors were corrected along this program"
    why = "after the tables are in the control and the programs have run again"
    return _probed_again(args), why


def _contributions(args: Namespace) -> Step:
    if args.program is None:
        return called("compensate", *_errors(args), "--tables", "tables"), "tables for the control"
    out = f"compensated{Path(args.program).suffix}"
    return called("compensate", *_errors(args), "--program", args.program, "-o", out), ""


def _sensitivity(args: Namespace) -> Step:
    if args.poses is None or Path(args.output).is_dir():
        return called("design", args.source, "-o", "OUT"), ""
    words = called("volumetric", args.source, "errors.toml", args.poses, "-o", "deviation.csv")
    return words, "what errors of a stated size do there; matstd machines NAME --errors has some"


def _uncertainty(args: Namespace) -> Step:
    runs = args.run_files
    if not args.model:
        words = called("diagnose", *runs, "--standard", args.standard, AUTO, "-o", "diagnosis")
        return words, "a model in uncertainty --model corrects results and lowers U"
    if len(runs) >= FEWEST_OF_A_TREND:
        return called("trend", *runs, "-o", "trend"), "whether the machine stays as it was"
    task = ["--task", args.task] if args.task else []
    options = ["--standard", args.standard, *task, "--model", args.model]
    words = called("uncertainty", *runs, "again.csv", *options, "-o", "uncertainty.json")
    return words, "another visit: more degrees of freedom lower U"


def _volumetric(args: Namespace) -> Step:
    words = called("show", args.machine, "--errors", args.errors, "-o", "machine.html")
    return words, "the machine with these errors in motion"


def _show(args: Namespace) -> Step:
    if args.program:
        return _after_playing(args)
    tool = ["--tool-length", f"{args.tool_length:g}", "--tables", "tables"]
    if args.model:
        return called("compensate", args.model, *tool), "tables against these errors"
    if args.errors:
        words = called("compensate", args.machine, "--errors", args.errors, *tool)
        return words, "tables against these errors"
    project = _beside(args.machine, "project.toml")
    if project.exists():
        return called("design", project, "-o", _beside(args.machine, "out")), ""
    table = _stated_table(args.machine)
    words = called("new", "project", "--machine", args.machine, *table, "-o", project)
    why = "if every axis turns about its place and in its direction"
    return words, why + (YOUR_TABLE if table else "")


def _after_playing(args: Namespace) -> Step:
    """A probing program is run on the twin; of a part program the errors are counted."""
    if args.standard:
        known = ["--errors", args.errors] if args.errors else []
        options = ["--standard", args.standard, "--machine", args.machine, *known, "-o", "run.csv"]
        return called("simulate", *args.program, *options), "what the twin measures with them"
    if not (args.errors or args.model):
        options = ["--errors", "errors.toml", "--program", *args.program, "-o", "errors.html"]
        return called("show", args.machine, *options), "the same with errors of the machine"
    known = [args.model] if args.model else [args.machine, "--errors", args.errors]
    options = ["--tool-length", f"{args.tool_length:g}", "--program", *args.program, "-o", "shares"]
    return called("contributions", *known, *options), "which of the errors act along it"


def _machines(args: Namespace) -> Step:
    if args.name is None:
        return "matstd machines hsm600u > my.toml", "the file of one; --errors: of its errors"
    if args.errors:
        options = ["--errors", "my-errors.toml", "-o", "machine.html"]
        return called("show", "my.toml", *options), "kept as my-errors.toml: the machine in motion"
    return called("show", "my.toml", "-o", "machine.html"), "kept as my.toml: the machine in motion"


def _new(args: Namespace) -> Step:
    if args.output is None:
        like = ["--like", args.like] if args.like else []
        machine = ["--machine", args.machine] if args.machine else []
        name = {"run": "run.csv", "effect": "effect.py"}.get(args.kind, f"{args.kind}.toml")
        return called("new", args.kind, *like, *machine, "-o", name), "the same, in a file"
    output = args.output
    project, folder = _beside(output, "project.toml"), _beside(output, "out")
    table = _stated_table(output)
    return {
        "machine": (
            called("new", "project", "--machine", output, *table, "-o", project),
            "after its numbers are those of your machine" + (YOUR_TABLE if table else ""),
        ),
        "project": (called("design", output, "-o", folder), ""),
        "run": (called("diagnose", output, AUTO, "-o", _beside(output, "diagnosis")), ""),
        "effect": (called("effects", "--effects", output), "reads it and tries it"),
    }[args.kind]


def _stated_table(machine: str) -> list[str]:
    """The size of the table that the head of a template states, as an option."""
    head = Path(machine).read_text(encoding="utf-8")[:1000] if Path(machine).exists() else ""
    stated = re.search(r"of this size: ([\d x]+) mm", head)
    return ["--table-mm", *stated[1].split(" x ")] if stated else []


_AFTER: dict[str, Callable[[Namespace], Step]] = {
    "design": _design,
    "sensitivity": _sensitivity,
    "calibrate": _calibrate,
    "uncertainty": _uncertainty,
    "simulate": _run_file,
    "control-test": lambda args: (
        called("diagnose", Path(args.output) / "run.csv", AUTO, "-o", "diagnosis"),
        "",
    ),
    "evaluate": _run_file,
    "replan": _replan,
    "import": _run_file,
    "compare": _compare,
    "thermal": _thermal,
    "compensate": _compensate,
    "serve": lambda args: (
        _probed_again(args),
        "after the programs have run again while it corrects",
    ),
    "contributions": _contributions,
    "volumetric": _volumetric,
    "show": _show,
    "machines": _machines,
    "new": _new,
}

BY_RESULT = {
    "examples": "what was copied decides",
    "diagnose": "its verdict decides",
    "learn": "whether there is a law decides",
    "trend": "what changed decides",
    "effects": "what was found decides",
}
"""Commands whose `run` leaves the next one in `args.next`, and why."""


def prints_a_file(args: Namespace) -> bool:
    """Whether standard output is a file to be kept: `matstd machines hsm600u > my.toml`."""
    return (args.command == "new" and args.output is None) or (
        args.command == "machines" and args.name is not None
    )
