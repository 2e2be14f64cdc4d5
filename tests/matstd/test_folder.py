"""Results appear whole or not at all, and nothing of the user's is lost."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from matstd.cli import main
from matstd.twin.errors import DesignError
from matstd.twin.files import results_folder
from matstd.twin.files.whole import claimed, write_into


def test_whole(tmp_path: Path) -> None:
    out = tmp_path / "a" / "out"
    with results_folder(out) as work:
        (work / "sub").mkdir()
        (work / "sub" / "x.txt").write_text("x")
        assert not out.exists()
    assert (out / "sub" / "x.txt").read_text() == "x"
    assert [p.name for p in out.parent.iterdir()] == ["out"]


def test_nothing_is_left_of_a_failure(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def fail() -> None:
        with results_folder(out) as work:
            (work / "x.txt").write_text("x")
            raise ValueError("stopped")

    with pytest.raises(ValueError, match="stopped"):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_a_full_folder_is_refused_and_with_force_kept(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.txt").write_text("mine")
    (out / "x.txt").write_text("old")
    with pytest.raises(DesignError, match="--force"), results_folder(out):
        pass
    with results_folder(out, force=True) as work:
        (work / "x.txt").write_text("new")
    assert (out / "mine.txt").read_text() == "mine"
    assert (out / "x.txt").read_text() == "new"


def test_what_a_refused_run_leaves_does_not_stand_in_the_way(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "reach-refused.png").write_text("picture")
    with results_folder(out, refused=["reach-refused.png"]) as work:
        (work / "x.txt").write_text("x")
    assert [p.name for p in out.iterdir()] == ["x.txt"]


def test_a_report_alone_is_not_overwritten(tmp_path: Path) -> None:
    """Results that not every run has are removed when they are stale, not taken for an own."""
    (tmp_path / "report.html").write_text("mine")
    with pytest.raises(DesignError, match="--force"), results_folder(tmp_path, ours=["*.html"]):
        pass
    assert (tmp_path / "report.html").read_text() == "mine"


WORKS = """
import sys, time
from matstd.twin.files import results_folder
from matstd.twin.files.whole import claimed, write_into
with results_folder(sys.argv[1]) as work:
    (work / "half.txt").write_text("half")
    print("works", flush=True)
    time.sleep(60)
"""


def test_what_a_killed_run_left_goes_at_the_next_start(tmp_path: Path) -> None:
    """Only ours, only of the same results, and not while its process lives."""
    running, killed = (
        subprocess.Popen([sys.executable, "-c", WORKS, str(tmp_path / "out")], stdout=-1)
        for _ in range(2)
    )
    strangers = [tmp_path / ".out-01234567", tmp_path / ".other-0123abcd", tmp_path / ".out-backup"]
    try:
        for process in (running, killed):
            assert process.stdout is not None
            assert process.stdout.readline().strip() == b"works"
        killed.kill()
        killed.wait()
        for stranger in strangers:
            (stranger / "results").mkdir(parents=True)
        assert len(list(tmp_path.glob(".out-*/results/half.txt"))) == 2
        with results_folder(tmp_path / "out"):
            assert len(list(tmp_path.glob(".out-*/results/half.txt"))) == 1
    finally:
        for process in (running, killed):
            process.kill()
            process.communicate()
    with results_folder(tmp_path / "out", force=True):
        pass
    assert sorted(p for p in tmp_path.iterdir() if p.name != "out") == sorted(strangers)


RACES = """
import sys
from pathlib import Path
from matstd.twin.errors import DesignError
from matstd.twin.files import results_folder
from matstd.twin.files.whole import refuse_to_overwrite, write_whole
mine = sys.argv[1]
for line in sys.stdin:
    kind, name, force = line.rstrip("\\n").split("|")
    out, force = Path(name), force == "force"
    try:
        if kind == "folder":
            with results_folder(out, force, ours=["only-*"]) as work:
                for k in range(30):
                    (work / f"f{k}").write_text(mine)
                (work / f"only-{mine}").write_text(mine)
                print("ready", flush=True)
                sys.stdin.readline()
        else:
            refuse_to_overwrite(out, force)
            print("ready", flush=True)
            sys.stdin.readline()
            write_whole(out, mine)
        print("0|", flush=True)
    except DesignError as error:
        print(f"2|{error}", flush=True)
"""
"""A process that writes results whenever a line names them; it starts once for all races."""


@pytest.fixture(scope="module")
def racers() -> Iterator[list[subprocess.Popen[str]]]:
    """Four processes that write the same results, each its own letter."""
    words = [[sys.executable, "-c", RACES, mine] for mine in "abcd"]
    runs = [subprocess.Popen(w, stdin=-1, stdout=-1, text=True, bufsize=1) for w in words]
    yield runs
    for run in runs:
        run.communicate()
        assert run.returncode == 0


def raced(
    runs: list[subprocess.Popen[str]], kind: str, out: Path, force: str, together: bool
) -> list[tuple[int, str]]:
    """Exit code and last line of processes that all began before one of them had ended."""

    def answer(run: subprocess.Popen[str]) -> str:
        assert run.stdout is not None
        return run.stdout.readline().rstrip("\n")

    for run in runs:
        assert run.stdin is not None
        run.stdin.write(f"{kind}|{out}|{force}\n")
        assert answer(run) == "ready"
    ended = {}
    for run in reversed(runs):  # who began last ends first
        assert run.stdin is not None
        run.stdin.write("\n")
        if not together:
            ended[run] = answer(run)
    said = [(ended.get(run) or answer(run)).partition("|") for run in runs]
    return [(int(code), words.strip()) for code, _, words in said]


def held(out: Path) -> str:
    """Which run's results stand there, after a look whether they are of one run alone."""
    if out.is_file():
        return out.read_text()
    inside = {file.name: file.read_text() for file in out.iterdir()}
    (mine,) = set(inside.values())
    assert set(inside) == {f"only-{mine}", *(f"f{k}" for k in range(30))}
    return mine


@pytest.mark.parametrize("together", [False, True])
@pytest.mark.parametrize(("kind", "name"), [("folder", "out"), ("file", "run.csv")])
def test_of_runs_that_race_the_first_stays_and_the_others_are_kept(
    racers: list[subprocess.Popen[str]], tmp_path: Path, kind: str, name: str, together: bool
) -> None:
    out = tmp_path / name
    ended = raced(racers, kind, out, "no", together)
    codes = [code for code, _ in ended]
    assert sorted(codes) == [0, 2, 2, 2]
    first = held(out)
    assert first == "abcd"[codes.index(0)]
    if not together:
        assert first == "d"  # the first that ends, though it began last
    kept = {"abcd"[k]: said for k, (code, said) in enumerate(ended) if code}
    for mine, said in kept.items():
        there = Path(said.rsplit(" are in ", 1)[1])
        assert said.startswith(f"{out}: another run has written it meanwhile")
        assert held(there) == mine
    assert len(list(tmp_path.iterdir())) == 4  # no locks and no parts


@pytest.mark.parametrize("before", [False, True])
@pytest.mark.parametrize(("kind", "name"), [("folder", "out"), ("file", "run.csv")])
def test_forced_runs_that_race_leave_one_whole_result(
    racers: list[subprocess.Popen[str]], tmp_path: Path, kind: str, name: str, before: bool
) -> None:
    out = tmp_path / name
    if before:
        raced(racers[:1], kind, out, "no", together=False)
    for _ in range(3):
        assert raced(racers, kind, out, "force", together=True) == [(0, "")] * 4
        assert held(out) in "abcd"
        assert [p.name for p in tmp_path.iterdir()] == [name]


def test_a_move_that_fails_puts_the_old_results_back(tmp_path: Path) -> None:
    """A file that cannot be moved: its folder is a file of the user's."""
    out = tmp_path / "out"
    out.mkdir()
    (out / "a.txt").write_text("old")
    (out / "z").write_text("mine")
    with pytest.raises(DesignError, match="cannot be written"), results_folder(out, True) as work:  # noqa: PT012
        for name in ("a.txt", "b.txt", "z/x.txt"):
            (work / name).parent.mkdir(exist_ok=True)
            (work / name).write_text("new")
    assert {p.name: p.read_text() for p in out.iterdir()} == {"a.txt": "old", "z": "mine"}
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_the_folder_one_stands_in_takes_results(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with results_folder(".") as work:
        (work / "x.txt").write_text("x")
    assert [p.name for p in tmp_path.iterdir()] == ["x.txt"]


def test_an_output_that_another_command_writes_meanwhile_is_not_lost(
    tmp_path: Path, monkeypatch, capsys
) -> None:
    """The command line itself: a file appears while the command works."""
    import matstd.commands.machine.new as new

    template = new.template

    def slow(kind: str, like: str | None = None) -> str:
        (tmp_path / "run.csv").write_text("of another")
        return template(kind, like)

    monkeypatch.setattr(new, "template", slow)
    assert main(["new", "run", "-o", str(tmp_path / "run.csv")]) == 2
    assert "run-2.csv" in capsys.readouterr().err
    assert (tmp_path / "run.csv").read_text() == "of another"
    assert (tmp_path / "run-2.csv").read_text() == template("run")


def test_files_into_a_folder_of_others_are_not_overwritten_unasked(tmp_path: Path) -> None:
    """The logs of a second run are kept beside those of the first."""
    logs = tmp_path / "logs"
    assert write_into(logs, {"MS_A_1.TXT": "first\n"}, newline="\r\n") == [logs / "MS_A_1.TXT"]
    write_into(logs, {"MS_LOC.TXT": "search\n"})
    with pytest.raises(DesignError, match=r"MS_A_1\.TXT: another run has written it .*logs-2"):
        write_into(logs, {"MS_A_1.TXT": "second\n", "MS_A_2.TXT": "second\n"})
    assert (logs / "MS_A_1.TXT").read_bytes() == b"first\r\n"
    assert sorted(p.name for p in (tmp_path / "logs-2").iterdir()) == ["MS_A_1.TXT", "MS_A_2.TXT"]
    write_into(logs, {"MS_A_1.TXT": "third\n"}, force=True)
    assert (logs / "MS_A_1.TXT").read_text() == "third\n"


def test_a_claimed_folder_is_refused_to_a_second_process(tmp_path: Path) -> None:
    """While LinuxCNC writes into it, whether the second gives --force or not."""
    out = tmp_path / "out"
    code = (
        "import sys; from matstd.twin.files.whole import claimed; from pathlib import Path\n"
        "try:\n with claimed(sys.argv[1], force=True): print('in')\n"
        "except Exception as error: print(error)"
    )
    words = [sys.executable, "-c", code, str(out)]
    with claimed(out) as folder:
        (folder / "linuxcnc.txt").write_text("half")
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        assert "another run is writing it" in done.stdout
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout == "in\n"
    with pytest.raises(DesignError, match="--force"), claimed(out):
        pass
