"""Numbers and words as they stand in blocks of both languages."""

import re

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
"""A number as programs of any origin write it."""

SIGNED = r"[+-]\d{1,5}(?:\.\d{0,7})?"
"""A coordinate as our own programs write it and controls save it: always with its sign."""

_WORD = re.compile(rf"([A-Z])({NUMBER})")
_WORDS = re.compile(rf"(?:[A-Z]{NUMBER})*")


def split_words(text: str) -> list[tuple[str, float]]:
    """Words of a block: letters with their numbers.

    Raises:
        ValueError: Something that is no word, which is the message.
    """
    bare = "".join(text.split())
    if not _WORDS.fullmatch(bare):
        raise ValueError(_WORD.sub("", bare))
    return [(letter, float(number)) for letter, number in _WORD.findall(bare)]
