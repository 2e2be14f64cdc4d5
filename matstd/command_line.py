"""The parser of the command line; it refuses as files are refused: what was found and expected."""

import argparse
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

from matstd.twin.words import did_you_mean

_OURS = {
    r"invalid float value: (.*)": r"found \1, expected a number",
    r"invalid int value: (.*)": r"found \1, expected a whole number",
    r"expected one argument": r"found nothing behind it",
    r"expected at least one argument": r"found nothing behind it",
    r"expected (\d+) arguments": r"expected \1 values behind it",
    r"not allowed with argument (.+)": r"found beside \1, expected one of the two",
    r"ignored explicit argument (.+)": r"found \1 behind it, expected nothing",
}
"""What argparse says of an argument, and how a refusal of ours reads."""


class CommandLine(argparse.ArgumentParser):
    """A parser whose refusals are one line, with what may be meant."""

    # words of the call: argparse asks for what is missing before it sees what it does not know
    given: Sequence[str] = ()

    def error(self, message: str) -> NoReturn:
        """Refuse, exit code 2."""
        print(f"{self.prog}: {self._words(message)} ({self.prog} --help)", file=sys.stderr)
        raise SystemExit(2)

    def _words(self, message: str) -> str:
        name, _, reason = message.partition(": ")
        if name == "the following arguments are required":
            options = [o for action in self._actions for o in action.option_strings]
            words = [w.partition("=")[0] for w in self.given if w.startswith("--")]
            mistyped = [w for w in words if not any(o.startswith(w) for o in options)]
            return self._unknown(mistyped[0]) if mistyped else f"found no {reason}"
        if name == "unrecognized arguments":
            return self._unknown(reason.partition(" ")[0].partition("=")[0])
        of = name.removeprefix("argument ")
        if choice := re.fullmatch(
            r"invalid choice: '(.*?)' \(choose from (.*)\)", reason, re.DOTALL
        ):
            known = choice[2].replace("'", "").split(", ")
            meant = did_you_mean(choice[1], known)
            return f"{of}: found '{choice[1]}'{meant}, expected one of {', '.join(known)}"
        for theirs, ours in _OURS.items():
            if match := re.fullmatch(theirs, reason, re.DOTALL):
                return f"{of}: {match.expand(ours)}"
        return message

    def _unknown(self, word: str) -> str:
        """Of a word that neither an option nor a file took."""
        if not word.startswith("-"):
            return f"{word}: found one word too many"
        known = [name for action in self._actions for name in action.option_strings]
        return f"{word}: found an unknown option{did_you_mean(word, known)}"
