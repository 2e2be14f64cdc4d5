"""Every command ends with the next one, which the command line understands."""

import importlib
import inspect
import shlex
from pathlib import Path
from types import SimpleNamespace

import pytest

from matstd.api.machines import machine_file
from matstd.cli import COMMANDS, FOLDERS, _parser, main
from matstd.commands.measured.diagnose import _again, _next, _unexplained
from matstd.compensation.field import State
from matstd.diagnosis.answer import Verdict
from matstd.next_steps import _AFTER, BY_RESULT, next_line
from matstd.twin.files import read_machine
from matstd.twin.library import parse_effect

CALLS = """
design project.toml -o OUT
sensitivity project.toml -o STUDY
sensitivity m.toml poses.csv -o table.csv
calibrate standard.toml --points cmm.csv -o calibrated.toml
calibrate standard.toml --program -o cmm.dmi
uncertainty a.csv b.csv --standard s.toml -o u.json
uncertainty a.csv b.csv --standard s.toml --task t.toml --model model.toml -o u.json
uncertainty a.csv b.csv c.csv --standard s.toml --model model.toml -o u.json
simulate MS_A_1.H --standard s.toml --machine m.toml -o run.csv
control-test OUT -o tested
evaluate MS_A_1.TXT --standard s.toml --machine m.toml -o run.csv
replan LOG.TXT --design OUT -o again
replan next_visit.csv --design OUT -o again
import laser.xlsx --positioning X -o run.csv
compare run.csv -o OUT
thermal LOG.csv -o OUT
thermal LOG.csv --law thermal.json -o OUT
thermal LOG.csv --law thermal.json --probed probed.csv -o OUT
compensate model.toml --tables DIR --tool-length 160
compensate m.toml --errors e.toml --tables DIR --tool-length 160
compensate model.toml --program part.H -o part_c.H --tool-length 160
serve model.toml --tool-length 160
serve m.toml --errors e.toml --tool-length 160 --linuxcnc machine.ini
contributions model.toml --tool-length 160 --program part.H -o OUT
contributions m.toml --errors e.toml --tool-length 160 --program part.H -o OUT
contributions model.toml --tool-length 160 --poses poses.csv -o OUT
volumetric m.toml e.toml poses.csv -o table.csv
show m.toml -o page.html
show m.toml --errors e.toml -o page.html
show m.toml --model model.toml -o page.html
show m.toml --program part.H -o page.html
show m.toml --errors e.toml --program part.H -o page.html
show m.toml --model model.toml --program part.H -o page.html
show m.toml --program MS_A_1.H MS_A_2.H --standard s.toml -o page.html
machines
machines hsm600u
machines hsm600u --errors
new machine
new project --machine m.toml
new project -o project.toml
new run -o run.csv
new effect -o effect.py
""".strip().splitlines()
"""Calls of every command whose arguments decide what follows, in each of its forms."""

ENDS = (
    "machines",
    "machines hsm600u",
    "effects",
    "effects spindle growth",
    "effects law",
    "effects drift-law",
    "effects backlash",
    "examples",
    "examples trend -o copied",
    "new machine",
    "new machine --like fork-portal -o fork.toml",
    "new run -o new/run.csv",
    "volumetric m.toml e.toml poses.csv -o table.csv",
    "sensitivity m.toml poses.csv -o table.csv",
    "contributions m.toml --errors e.toml --tool-length 160 --poses poses.csv -o OUT",
    "show m.toml --errors e.toml -o page.html",
)
"""Calls that take a second or two, in every case of the commands that are left to a test."""


PRINTED = ("machines hsm600u", "new machine")  # standard output is the file itself

POSES = "X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_length_mm\n100,50,-200,0,0,160\n100,50,-200,-90,90,160\n"


def parsed(words: list[str]):
    return _parser(words).parse_args(words)


def following(line: str) -> str:
    """The command that a line has, and that the command line reads with its arguments."""
    assert line.startswith("next: matstd ")
    words = shlex.split(line.removeprefix("next: matstd ").partition("   (")[0].partition(" > ")[0])
    return parsed(words).command


def test_every_command_has_a_next_one_or_leaves_its_own() -> None:
    assert _AFTER.keys() | BY_RESULT.keys() == COMMANDS.keys()
    assert not _AFTER.keys() & BY_RESULT.keys()
    assert {call.split()[0] for call in CALLS} == _AFTER.keys()


@pytest.mark.parametrize("command", BY_RESULT)
def test_a_command_whose_result_decides_leaves_what_follows(command) -> None:
    folder = next(name for name, inside in FOLDERS.items() if command in inside)
    module = importlib.import_module(f"matstd.commands.{folder}.{command}")
    run = inspect.getsource(module.run)
    assert "args.next = " in run
    assert '"", ""' not in inspect.getsource(module)


@pytest.mark.parametrize("call", CALLS)
def test_the_next_command_is_one_that_the_command_line_reads(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_text("", encoding="utf-8")
    Path("STUDY").mkdir()
    assert following(next_line(parsed(shlex.split(call)))) in COMMANDS


def test_a_list_of_a_standard_is_no_file_of_one(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_text("", encoding="utf-8")
    args = parsed(["import", "plate.csv", "--standard", "-o", "run.csv"])
    assert "diagnose run.csv --auto -o diagnosis " in next_line(args)


def test_the_next_command_writes_over_nothing(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_text("", encoding="utf-8")
    args = parsed(["compare", "run.csv", "-o", "OUT"])
    for taken, stated in (("", "diagnosis"), ("diagnosis", "diagnosis-2")):
        if taken:
            Path(taken).mkdir()
        assert (
            next_line(args)
            == f"next: matstd diagnose run.csv --auto -o {stated}   (what the model lacks)"
        )


@pytest.mark.parametrize("call", ENDS)
def test_the_next_command_is_the_last_line(call, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("m.toml").write_text(machine_file("hsm600u").read_text("utf-8"), encoding="utf-8")
    Path("e.toml").write_text(machine_file("hsm600u", True).read_text("utf-8"), encoding="utf-8")
    Path("poses.csv").write_text(POSES, encoding="utf-8")
    Path("new").mkdir()
    assert main(shlex.split(call)) == 0
    out, err = capsys.readouterr()
    assert following((err if call in PRINTED else out).splitlines()[-1]) in COMMANDS
    assert ("next:" in out) == (call not in PRINTED)


def test_what_the_command_found_decides(tmp_path) -> None:
    args = parsed(["diagnose", "run.csv", "-o", "OUT"])
    assert next_line(args) == ""
    args.next = ("matstd compensate OUT/model.toml", "tables for the control")
    assert next_line(args) == "next: matstd compensate OUT/model.toml   (tables for the control)"


OWN = SimpleNamespace(is_behind_library=False)
BEHIND = SimpleNamespace(
    is_behind_library=True, library=SimpleNamespace(effect=SimpleNamespace(name="slip"))
)


@pytest.mark.parametrize(
    ("laws", "words"),
    [
        (None, "matstd learn run.csv -o OUT-law"),
        ({"laws": ()}, "matstd diagnose run.csv again.csv -o OUT-2"),
        ({"laws": (OWN,), "of_library": ["drift"]}, "matstd diagnose run.csv --add drift -o OUT-2"),
        ({"laws": (OWN, BEHIND), "of_library": []}, "matstd diagnose run.csv --add slip -o OUT-2"),
        (
            {"laws": (OWN,), "of_library": [], "effect_names": ["learnt-law"]},
            "matstd diagnose run.csv --effects OUT/effect.py --add learnt-law -o OUT-2",
        ),
    ],
)
def test_what_remains_gets_a_law_a_name_or_another_run(laws, words) -> None:
    args = parsed(["diagnose", "run.csv", "-o", "OUT"])
    found = SimpleNamespace(laws=laws and SimpleNamespace(**laws))
    assert _unexplained(args, found)[0] == words


def test_the_line_stands_at_the_end(tmp_path, capsys) -> None:
    path = tmp_path / "a b.toml"
    assert main(["new", "machine", "-o", str(path)]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    beside = tmp_path / "project.toml"
    why = "after its numbers are those of your machine"
    assert last == f"next: matstd new project --machine '{path}' -o {beside}   ({why})"


NO_LAWS = SimpleNamespace(laws=None)
MODELLED = ["--standard", "s.toml", "--start", "setup", "--effects", "a.py", "--effects", "b.py"]
MODELLED += ["--pitch", "X=10", "Y=5"]
STATED = ["--tool-length", "123.25", "--within", "X=-5:5", "--temperature", "spindle=21", "Z=20"]
STATED += ["--load", "-1.5", "0", "2", "--after", "90", "--effects", "a.py", "--switch", "EXX=0"]


@pytest.mark.parametrize(
    ("given", "kept", "follows"),
    [
        (["diagnose", "run.csv", *MODELLED, "--auto", "--only", "drift", "--add", "a", "-o", "O"],
         "standard start effects pitch auto only add", lambda args: _again(args)),
        (["diagnose", "run.csv", *MODELLED, "--add", "slip", "-o", "O"],
         "standard start effects pitch add", lambda args: _unexplained(args, NO_LAWS)[0]),
        (["compare", "run.csv", *MODELLED, "-o", "O"], "standard start effects pitch", None),
        (["contributions", "m.toml", *STATED, "--program", "p.H", "-o", "O"],
         "tool_length within temperature load after effects switch", None),
        (["compensate", "m.toml", *STATED, "--program", "p.H", "-o", "O"],
         "tool_length within temperature load after effects switch", None),
    ],
)  # fmt: skip
def test_the_next_command_keeps_what_was_stated(given, kept, follows) -> None:
    args = parsed(given)
    line = follows(args) if follows else next_line(args).partition("   (")[0].removeprefix("next: ")
    again = parsed(shlex.split(line.removeprefix("matstd ")))
    for name in kept.split():
        assert getattr(again, name) == getattr(args, name), name


def test_a_diagnosis_that_is_repeated_takes_more() -> None:
    args = parsed(["diagnose", "run.csv", "--add", "drift", "-o", "OUT"])
    line = _again(args, "--add", "slip", runs=("new.csv",))
    assert line == "matstd diagnose run.csv new.csv --add drift --add slip -o OUT-2"


class OwnColumns(SimpleNamespace):
    """An effect of a user's file, which looks up what it follows by itself."""

    def terms(self, touches):
        return touches.value["coolant_bar"] * touches.spindle_rpm


def test_compensation_gets_all_that_the_model_follows() -> None:
    """Members of a class that are averaged follow a sensor each."""
    chain = read_machine(machine_file("hsm600u"))
    state = {"temperature": {"scale": 24.26, "ambient": 20.61, "spindle": 31.0}}
    state |= {"spindle_rpm": 6000.0, "value": {"coolant_bar": 40.0, "air_bar": 6.0}}
    touches = State(time=6600.0, **state).touches(chain, chain.travels.mean(axis=1)[None], 160.0)
    named = parse_effect("thermal-expansion(X,scale)", chain)
    member = parse_effect("thermal-expansion(X,ambient)", chain)

    def words(*effects):
        learnt = SimpleNamespace(model=SimpleNamespace(effects=effects))
        steps = [SimpleNamespace(effect=None), SimpleNamespace(effect=named)]
        found = {"run": SimpleNamespace(touches=touches), "learnt": learnt, "steps": steps}
        found |= {"verdict": Verdict.MISSING, "withdrawn": (), "plans": ()}
        found["parts"] = SimpleNamespace(geometry=SimpleNamespace(beyond=()))
        args = parsed(["diagnose", "run.csv", "--auto", "--effects", "a.py", "-o", "O"])
        line = _next(args, SimpleNamespace(**found))[0]
        begin = "matstd compensate O/model.toml --effects a.py --tool-length 160 --tables tables"
        assert line.startswith(f"{begin} --after 110 ")
        return line.removeprefix(f"{begin} --after 110 ").removesuffix(" --within")

    sensors, others = "--temperature scale=24.3 ambient=20.6", "--value coolant_bar=40 --rpm 6000"
    assert words(named, member) == sensors
    assert words(named, OwnColumns(), member) == f"{sensors} {others}"
    assert words(parse_effect("thermal-lag(EZZ,spindle_rpm)", chain)) == "--rpm 6000"
