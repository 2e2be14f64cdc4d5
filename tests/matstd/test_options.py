"""Options that several commands share."""

import argparse

import pytest

from matstd.options import add_options


def test_an_option_that_is_given_again_keeps_what_it_had() -> None:
    parser = argparse.ArgumentParser()
    add_options(parser, {"--tool TOOL=MM ...": "lengths"})
    words = ["--tool", "1=100", "2=120", "--tool", "3=90"]
    for _ in range(2):  # the empty list of the option is not the one that is filled
        assert parser.parse_args(words).tool == ["1=100", "2=120", "3=90"]
    assert parser.parse_args([]).tool == []


def test_a_form_states_type_and_value_of_an_option() -> None:
    parser = argparse.ArgumentParser()
    forms = (
        "--noise=1.5",
        "--seed=0",
        "--z=gauge|tip",
        "--at=0.5 X Y",
        "--url=a:b=c URL",
        "--n:int N",
    )
    add_options(parser, dict.fromkeys(forms, "meaning"))
    plain = vars(parser.parse_args([]))
    assert plain == {
        "noise": 1.5,
        "seed": 0,
        "z": "gauge",
        "at": (0.5, 0.5),
        "url": "a:b=c",
        "n": None,
    }
    assert isinstance(plain["seed"], int)
    words = ["--noise", "2", "--seed", "7", "--z", "tip", "--at", "1", "2", "--n", "3"]
    stated = vars(parser.parse_args(words))
    assert stated == plain | {"noise": 2.0, "seed": 7, "z": "tip", "at": [1.0, 2.0], "n": 3}
    for wrong in (["--seed", "0.5"], ["--n", "x"], ["--z", "pole"]):
        with pytest.raises(SystemExit):
            parser.parse_args(wrong)
