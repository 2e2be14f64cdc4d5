"""What is installed: one name, whole, which nothing in the user's folder disturbs."""

import os
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

from matstd.commands.machine.examples import EXAMPLES

ROOT = Path(__file__).parents[1]
TRAPS = ("report", "twin", "information", "diagnosis", "artefact", "compensation", "sensitivity")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel of the tracked files, built by setuptools alone: no index is asked."""
    source, place = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        check=True,
    ).stdout.decode()
    for name in filter(None, listed.split("\0")):
        if not name.startswith(("tests/", "benchmarks/")) and (ROOT / name).exists():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, source / name)
    code = f"from setuptools.build_meta import build_wheel; print(build_wheel({str(place)!r}))"
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        cwd=source,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return next(place.glob("*.whl"))


@pytest.fixture(scope="module")
def user(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of a user with modules of the rooms' names, and the wheel in an environment."""
    place = tmp_path_factory.mktemp("user")
    for name in TRAPS:
        (place / f"{name}.py").write_text("raise SystemExit('the user file ran')\n")
    venv.create(place / "env", with_pip=False)
    site = next((place / "env").rglob("site-packages"))
    zipfile.ZipFile(wheel).extractall(site)
    # the libraries of this environment, behind the wheel; none of its hooks of editable installs
    libraries = Path(pytest.__file__).parents[1]
    (site / "libraries.pth").write_text(f"{libraries}\n", encoding="utf-8")
    return place


def run(user: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python of the clean environment in the user's folder."""
    folder = "Scripts" if os.name == "nt" else "bin"
    outside = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}
    return subprocess.run(
        [user / "env" / folder / "python", *arguments],
        cwd=user,
        env=outside,
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_wheel_adds_one_name(wheel: Path) -> None:
    names = {name.partition("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {name for name in names if not name.endswith(".dist-info")} == {"matstd"}


def test_a_wheel_is_whole(wheel: Path) -> None:
    """Every module, template and dialect of the rooms is in it."""
    inside = set(zipfile.ZipFile(wheel).namelist())
    others = ("matstd", "examples")
    rooms = [p for p in ROOT.iterdir() if p.name not in others and (p / "__init__.py").exists()]
    assert len(rooms) >= 9
    for room in [*rooms, ROOT / "matstd"]:
        for file in room.rglob("*"):
            if file.is_file() and "__pycache__" not in file.parts:
                inner = file.relative_to(ROOT).as_posix()
                assert (inner if room.name == "matstd" else f"matstd/{inner}") in inside, inner


@pytest.mark.slow
def test_a_users_type_checker_reads_the_wheel(user: Path) -> None:
    """`py.typed`: strict mypy knows what the door returns, and finds the one mistake."""
    (user / "script.py").write_text(
        "import matstd\n\n"
        "found: matstd.Diagnosis = matstd.diagnose('run.csv')\n"
        "wrong: int = matstd.read_run('run.csv')\n"
    )
    python = next((user / "env").glob("*/python"))
    command = [sys.executable, "-m", "mypy", "--strict", "--python-executable", str(python)]
    done = subprocess.run(
        [*command, "script.py"], cwd=user, capture_output=True, text=True, check=False
    )
    assert done.stdout.splitlines() == [
        'script.py:4: error: Incompatible types in assignment (expression has type "Run", variable '
        'has type "int")  [assignment]',
        "Found 1 error in 1 file (checked 1 source file)",
    ]


def test_every_example_is_in_the_wheel(wheel: Path) -> None:
    """What `matstd examples` copies; pictures and records of other licences stay behind."""
    inside = {name for name in zipfile.ZipFile(wheel).namelist() if "/examples/" in name}
    for example in EXAMPLES.values():
        for pattern in example.files:
            wanted = [p for p in (ROOT / "examples").glob(pattern) if p.name != "__init__.py"]
            assert wanted or pattern.endswith(".json"), pattern
            for path in wanted:
                assert f"matstd/{path.relative_to(ROOT).as_posix()}" in inside, path
    assert not any(name.startswith("matstd/examples/fl_thermal") for name in inside)


def test_modules_of_the_user_change_nothing(user: Path) -> None:
    """His own report.py or twin.py in the folder is not imported, in his folder or a notebook."""
    for file in (ROOT / "examples" / "hidden_effect").iterdir():
        if file.is_file():
            shutil.copyfile(file, user / file.name)
    code = (
        "import sys, matstd\n"
        "from matstd.twin.files import read_run\n"
        "run = read_run('warm_up.csv')\n"
        "assert 'touches' in repr(run) and '<' in run._repr_html_()\n"
        f"assert 'env' in matstd.__file__ and not set({TRAPS}) & set(sys.modules)\n"
        "print(True)"
    )
    done = run(user, "-c", code)
    assert done.stdout.strip() == "True", done.stderr


def test_the_command_runs_from_the_wheel(user: Path) -> None:
    """Templates, machines and a computation, outside the checkout."""
    for name, options in (("machine.toml", ()), ("errors.toml", ("--errors",))):
        done = run(user, "-m", "matstd", "machines", "hsm600u", *options)
        assert done.returncode == 0, done.stderr
        (user / name).write_text(done.stdout, encoding="utf-8")
    (user / "poses.csv").write_text("X_mm,Y_mm,Z_mm,C_deg,B_deg\n10,20,-30,40,-50\n")
    done = run(
        user, "-m", "matstd", "volumetric", "machine.toml", "errors.toml", "poses.csv",
        "-o", "out.csv",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert len((user / "out.csv").read_text(encoding="utf-8").splitlines()) >= 2
    done = run(user, "-m", "matstd", "new", "effect", "-o", "own.py")
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_a_standard_is_designed_from_the_wheel(user: Path) -> None:
    for name in ("hsm600u.toml", "hsm600u-machine.toml"):
        shutil.copyfile(ROOT / "examples" / name, user / name)
    done = run(user, "-m", "matstd", "design", "hsm600u.toml", "-o", "out")
    assert done.returncode == 0, done.stderr
    assert (user / "out" / "standard.step").exists()
