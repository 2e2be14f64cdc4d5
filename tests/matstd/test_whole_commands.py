"""What commands print and write on the files of one machine, whole."""

import re
import shutil

import bench
import pytest
from commands import steps_of_work
from scenes import scenes_alone
from workshop import EXAMPLES
from written import folder_text

from matstd.cli import COMMANDS, _parser, main
from matstd.twin.files import read_machine

STATE = "--after 90 --rpm 9000 --add thermal-lag(EZZ)=25um,tau=18min"
DATUM = "--tool-length 160 --datum X=10 Y=-20 Z=-390 B=-5 C=15"
ERRORS = f"machine.toml --errors errors.toml {DATUM} {STATE}"
PROGRAM = """G21 G90 G94
T1 M6
G0 X-60 Y10 Z50
G1 Z0 F800
G2 X60 Y10 I60 J0
G1 X60 Y-40 B-20
M2
"""
POSES = """X_mm,Y_mm,Z_mm,B_deg,C_deg
0,0,-300,0,0
120,-80,-250,-45,90
-150,150,-400,20,-180
"""
COMMANDS_ON = {
    "volumetric": "volumetric machine.toml errors.toml poses.csv -o out.csv",
    "sensitivity": "sensitivity machine.toml poses.csv -o out.csv",
    "study": "sensitivity project.toml -o out --draws 300 --tolerance-um 300",
    "contributions": f"contributions {ERRORS} --program part.ngc -o out",
    "contributions-poses": f"contributions {ERRORS} --poses poses.csv -o out",
    "tables": f"compensate {ERRORS} --tables out",
    "program": f"compensate {ERRORS} --program part.ngc -o out.ngc",
    "tables-of-a-model": "compensate model.toml --tool-length 160 --datum Z=-300 B=-20 C=40 "
    "--tables out --control sinumerik",
    "program-of-a-model": "compensate model.toml --tool-length 160 --datum Z=-400 "
    "--program part.ngc -o out.ngc",
    "contributions-of-a-model": "contributions model.toml --tool-length 160 --poses poses.csv "
    "-o out",
    "show": f"show {ERRORS} --program part.ngc -o out.html",
    "show-probing": "show machine.toml --program programs/MS_A_1.H --standard standard.toml "
    "-o out.html",
    "calibrate": "calibrate standard.toml --points cmm.csv -o out.toml",
    "dmis": "calibrate standard.toml --program --orientation 90 -o out.dmi",
    "task": "uncertainty monday.csv friday.csv --standard standard.toml --task task.toml "
    "--model model.toml -o out.json",
    "uncertainty": "uncertainty monday.csv friday.csv probed.csv --standard standard.toml "
    "-o out.json --page out.html",
    "simulate": "simulate programs/MS_A_1.H --standard standard.toml --machine machine.toml "
    "--random-errors --seed 5 --body-degC 22 --add thermal-lag(EZZ)=25um,tau=18min "
    "--setup-error X=50um,C=0.01deg --probe-error radius=2um -o out.csv --logs out",
    "evaluate": "evaluate logs/MS_A_1.TXT --standard standard.toml --machine machine.toml "
    "-o out.csv",
    "scan": "evaluate scan.csv --scan FF1 --radius-mm 3 --length-mm 160 --frame standard "
    "--standard standard.toml --machine machine.toml -o out.csv",
    "compare": "compare run.csv -o out",
    "compare-balls": "compare probed.csv --start setup --standard standard.toml -o out",
    "compare-model": "compare run.csv --model model.toml --no-report -o out",
    "diagnose": "diagnose run.csv --no-learn --no-report -o out --add backlash(X) "
    "--only thermal-lag(EZZ) thermal-lag(EZX) backlash",
    "trend": "trend trend -o out",
    "thermal": "thermal drift.csv --train-until 5 --sensor-noise 0.1 --probe-every 2 -o out",
    "thermal-law": "thermal drift.csv -o law; thermal --law law/thermal.json drift.csv "
    "--probed drifts.csv -o out",
    "machines": "machines",
    "machine": "machines hmc1995",
    "its-errors": "machines hmc1995 --errors",
    "effects": "effects",
    "effect": "effects gravity(EBB)",
    "effects-by-word": "effects growth",
    "new-machine": "new machine --like fork-portal",
    "new-project": "new project --machine machine.toml -o new.toml",
    "new-run": "new run",
    "new-effect": "new effect",
    "examples": "examples",
}


FEW = "poses = 100"
UNSTABLE = re.compile(r"(?<=model)(:?) [0-9a-f]{12}|(?m:^\.reduced\..*\n)")
"""What follows every digit of estimates: the hash of a model, matrices of weak columns."""


def sizes(folder) -> str:
    """Errors of different sizes: which is the largest depends on no rounding."""
    names = (symbol.name for symbol in read_machine(folder / "machine.toml").symbols)
    related = '[[errors.groups]]\nnames = ["EXX", "-EYX"]\ncorrelation = 0.5\n'
    related += '[errors.shapes]\nEXX = { shapes = ["parabolic"] }\n'
    return f"{related}[errors.parameters]\n" + "".join(
        f"{name} = [{10 + k}, {20 + 2 * k}]\n" for k, name in enumerate(names)
    )


@pytest.fixture(scope="module")
def files(workshop, tmp_path_factory):
    """The files of the workshop, and what commands want beside them."""
    place = shutil.copytree(workshop, tmp_path_factory.mktemp("commands") / "here")
    text = (place / "project.toml").read_text(encoding="utf-8").replace("poses = 2000", FEW)
    (place / "project.toml").write_text(text + sizes(place), encoding="utf-8")
    (place / "drifts.csv").write_text("time_min,z_um,u_um\n60,2.5,0.5\n121,3,0.5\n")
    shutil.copy(EXAMPLES / "task.toml", place)
    (place / "part.ngc").write_text(PROGRAM, encoding="utf-8")
    (place / "poses.csv").write_text(POSES, encoding="utf-8")
    (place / "errors.toml").write_text(bench.ERRORS, encoding="utf-8")
    return place


@pytest.fixture
def there(files, monkeypatch):
    """The same for one command, with the time of each; what the command makes goes."""
    monkeypatch.chdir(files)
    monkeypatch.setenv("COLUMNS", "100")
    before = {p: p.stat().st_mtime_ns for p in files.rglob("*")}
    yield files, before
    for path in sorted(set(files.rglob("*")) - before.keys(), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()


@pytest.mark.parametrize("words", COMMANDS_ON.values(), ids=COMMANDS_ON)
def test_what_a_command_prints_and_writes(
    words, there, rendered_alone, monkeypatch, capsys, unchanged
) -> None:
    figures, scenes, steps = rendered_alone(), scenes_alone(monkeypatch), steps_of_work(monkeypatch)
    folder, before = there
    for one in words.split("; "):
        assert main(one.split()) == 0
    printed = re.sub(r"(?m)\s+$", "", capsys.readouterr().out)
    text = "\n".join([printed, folder_text(folder, figures, before), *scenes, *steps, ""])
    unchanged(UNSTABLE.sub("", text))


def test_what_commands_can_be_given(unchanged) -> None:
    lines = []
    for command in COMMANDS:
        parser = _parser([command])._subparsers._group_actions[0].choices[command]
        lines.append(f"{command}: {parser.description}")
        for one in parser._actions[1:]:
            facts = one.nargs, one.default, getattr(one.type, "__name__", None), one.required
            names = " ".join(one.option_strings) or one.dest
            lines.append(f"  {names} {one.metavar} {facts}: {one.help}")
    unchanged("\n".join(lines) + "\n")
