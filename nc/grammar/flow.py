"""Flow of a program: labels, nested subprograms, repeats.

The rules are those of Klartext; a reader of another language brings its subprograms as labels.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path

from matstd.twin.errors import BadFile

MAX_DEPTH = 8
"""Nesting of subprograms on Heidenhain's controls."""


def label_places(found: Iterable[tuple[int, int, str]], path: Path) -> dict[str, int]:
    """Index of the block of every label; raises BadFile.

    Found are the index of a block, its line and the name of its label; "0" ends a subprogram.
    """
    places: dict[str, int] = {}
    lines: dict[str, int] = {}
    for index, line, name in found:
        if name in places:
            expected = f"every label once; it is in line {lines[name]}"
            raise BadFile(path, line, f"LBL {name} again", expected)
        if name != "0":
            places[name], lines[name] = index, line
    return places


class Flow:
    """One run of a program, by the indices of its blocks.

    Args:
        most: Blocks that a program may execute before it counts as one without an end.
    """

    def __init__(self, path: Path, places: Mapping[str, int], most: int) -> None:
        self.path, self.places, self.most = path, places, most
        self.executed = 0
        self.returns: list[int] = []
        self.left: dict[int, int] = {}

    def count(self, line: int) -> None:
        """Count a block that is executed; raises BadFile beyond the limit."""
        self.executed += 1
        if self.executed > self.most:
            found = f"a loop without end: {self.most} blocks"
            raise BadFile(self.path, line, found, "a program that ends")

    def behind(self, line: int, name: str) -> int:
        """Index of the block behind a label; raises BadFile for one that is not defined."""
        if name not in self.places:
            available = ", ".join(self.places) or "none"
            expected = f"a label that is defined; available: {available}"
            raise BadFile(self.path, line, f"LBL {name}", expected)
        return self.places[name] + 1

    def call(self, index: int, line: int, name: str) -> int:
        """Index of the first block of a subprogram that a block calls; raises BadFile."""
        start = self.behind(line, name)
        if len(self.returns) >= MAX_DEPTH:
            found = f"subprograms {len(self.returns) + 1} deep"
            raise BadFile(self.path, line, found, f"{MAX_DEPTH} at most")
        self.returns.append(index + 1)
        return start

    def repeat(self, index: int, line: int, name: str, times: int) -> int:
        """Index of the block at which a call with REP goes on; raises BadFile."""
        start = self.behind(line, name)
        left = self.left.pop(index, times)
        if not left:
            return index + 1
        self.left[index] = left - 1
        return start

    def end(self) -> int | None:
        """Index behind the call that a subprogram returns to; None where none was called."""
        return self.returns.pop() if self.returns else None
