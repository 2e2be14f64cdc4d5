"""The three parts of a verdict in words: geometry, named effects, what remains.

In: a `Diagnosis` or a `Comparison`. Out: lines for the console and a section of the page.
"""

from matstd.report.verdict.part_words import (
    part_lines,
    promise_words,
    repeatability_words,
)

__all__ = ["part_lines", "promise_words", "repeatability_words"]
