"""Refusals of the command line: one line, with the option, what was found and what was expected."""

import pytest

from matstd.cli import main

SIMULATE = "simulate a.H --standard s.toml --machine m.toml -o run.csv"
REFUSED = {
    "desing": "matstd: COMMAND: found 'desing'; did you mean design?, expected one of design,",
    "design": "matstd design: found no PROJECT.toml, -o/--output",
    "design a.toml b.toml -o out": "matstd design: b.toml: found one word too many",
    f"{SIMULATE} --noise-um hot": "simulate: --noise-um: found 'hot', expected a number",
    f"{SIMULATE} --seed 1.5": "simulate: --seed: found '1.5', expected a whole number",
    "diagnose run.csv --ouput x": "--ouput: found an unknown option; did you mean --output?",
    f"{SIMULATE} --nois-mu=3 --foo": "--nois-mu: found an unknown option; did you mean --noise-um?",
    f"{SIMULATE} --noise-um": "--noise-um: found nothing behind it",
    f"{SIMULATE} --errors e.toml --random-errors": "found beside --errors, expected one of the two",
    "evaluate a.TXT --z mid": "--z: found 'mid', expected one of gauge, tip",
    "evaluate a.TXT --origin-mm 1": "--origin-mm: expected 3 values behind it",
    "design p.toml --force=3": "--force: found '3' behind it, expected nothing",
}


@pytest.mark.parametrize("line", REFUSED)
def test_a_wrong_command_line_is_refused_in_one_line(line, capsys):
    with pytest.raises(SystemExit) as ended:
        main(line.split())
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert REFUSED[line] in said


def test_a_call_without_a_command_prints_the_help(capsys):
    assert main([]) == 2
    assert "design a material standard" in capsys.readouterr().out
