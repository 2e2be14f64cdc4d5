"""Options that several commands share."""

import argparse

from matstd.options import add_options


def test_an_option_that_is_given_again_keeps_what_it_had() -> None:
    parser = argparse.ArgumentParser()
    add_options(parser, {"--tool TOOL=MM ...": "lengths"})
    words = ["--tool", "1=100", "2=120", "--tool", "3=90"]
    for _ in range(2):  # the empty list of the option is not the one that is filled
        assert parser.parse_args(words).tool == ["1=100", "2=120", "3=90"]
    assert parser.parse_args([]).tool == []
