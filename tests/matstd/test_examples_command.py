"""`matstd examples` copies what can be run at once, and replaces nothing of the user's."""

import shlex

import pytest

from matstd.cli import main
from matstd.commands.machine.examples import EXAMPLES
from matstd.twin.files import read_run


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_copy_has_what_the_next_command_reads(name, tmp_path, answer):
    folder = tmp_path / "copy"
    last = answer(["examples", name, "-o", str(folder)]).splitlines()[-1]
    words = shlex.split(last.removeprefix("next: ").partition("   (")[0])
    files = [word for word in words if word.startswith(str(folder))]
    assert files
    for file in files:
        assert (folder / file).is_file() or len(list((folder / file).glob("*.csv"))) > 2, file
        if file.endswith(".csv"):
            assert len(read_run(file)) > 50


def test_files_of_the_user_are_not_replaced(tmp_path, refusal):
    mine = tmp_path / "hidden_effect" / "warm_up.csv"
    mine.parent.mkdir()
    mine.write_text("mine", encoding="utf-8")
    assert "already exists" in refusal(["examples", "hidden-effect", "-o", str(tmp_path)])
    assert [p.name for p in mine.parent.iterdir()] == ["warm_up.csv"]
    assert mine.read_text(encoding="utf-8") == "mine"
    assert main(["examples", "hidden-effect", "-o", str(tmp_path), "--force"]) == 0
    assert mine.read_text(encoding="utf-8") != "mine"
