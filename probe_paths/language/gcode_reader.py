"""Text of a LinuxCNC program to the blocks of the closed list, and one clear line for the rest."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from matstd.nc.grammar import SIGNED, gcode_lines
from matstd.probe_paths.language import gcode as g
from matstd.probe_paths.language.blocks import Block, Kind, physical_lines
from matstd.probe_paths.language.dialect import TOOL_LENGTH, Label, Q
from matstd.probe_paths.language.language import SKIP
from matstd.probe_paths.language.text import parameter
from matstd.twin.errors import BadFile

Words = dict[str, str | None]

_SYSTEM = "|".join(re.escape(text) for text in g.SYSTEM.values())
_ARGUMENTS = {name: SIGNED for name in ("x", "y", "z", "distance", "feed", "back", "slow", "step")}
_ARGUMENTS |= {"feed": r"\d+", "slow": r"\d+"}
_CALL = " ".join(rf"\[(?P<{name}>{form})\]" for name, form in _ARGUMENTS.items())
_TOUCH = re.compile(rf"O{g.TOUCH} CALL {_CALL}\Z")

_LINES = {
    Kind.BEGIN: r"\(BEGIN PGM (?P<name>\S+) (?P<unit>\S+)\)",
    Kind.END: r"\(END PGM (?P<name>\S+) (?P<unit>\S+)\)",
    Kind.STRUCTURE: r";\* (?P<text>.+)",
    Kind.COMMENT: r";(?P<text>.*)",
    Kind.SPINDLE_OFF: r"M5",
    Kind.ORIENTATION: r"M19 R0 Q10",
    Kind.TCPM_OFF: re.escape(g.MODES),
    Kind.PLANE_OFF: r"G61",
    Kind.SHIFT: r"G92\.1",
    Kind.PRESET: r"G43 G5(?P<row>[4-9])",
    Kind.TOOL_CALL: r"T(?P<tool>\d+) M6(?P<speed> S.*)?",
    Kind.RETRACT_MAX: rf"G53 G0 Z(?P<z>{SIGNED}) \(RETRACT\)",
    Kind.LINE: (
        rf"(?P<machine>G53 )?(?P<g>G[01])(?P<axes>(?: [A-Z]{SIGNED})+)"
        r"(?: F(?P<feed>\d+))?"
    ),
    Kind.READ: rf"#(?P<q>\d+) = (?P<datum>{_SYSTEM})",
    Kind.ASSIGN: rf"#(?P<q>\d+) = (?P<value>{SIGNED})",
    Kind.SUBTRACT: (rf"#(?P<q>\d+) = \[#(?P<from>\d+) - (?:(?P<value>{SIGNED})|#(?P<other>\d+))\]"),
    Kind.WAIT: re.escape(g.WAIT),
    Kind.CALL: r"O(?P<label>[1-9]\d*) CALL",
    Kind.LABEL: r"O(?P<label>[1-9]\d*) (?P<what>SUB(?: \(.*\))?|ENDSUB)",
    Kind.STOP: r"M0",
    Kind.ERROR: r"\(ABORT,(?P<number>\d+)\)",
    Kind.PROGRAM_STOP: r"M30",
}
_PATTERNS = {kind: re.compile(pattern + r"\Z") for kind, pattern in _LINES.items()}
_IF = re.compile(r"O(\d+) IF \[#(?P<q>\d+) (?P<than>LT|GT) (?P<limit>[+-]\d+(?:\.\d+)?)\]\Z")
_SKIP_IF = re.compile(r"O(?P<number>\d+) IF \[#(?P<q>\d+) LE (?P<limit>[+-]\d+(?:\.\d+)?)\]\Z")
_SKIPPED = re.compile(r"O(\d+) ENDIF\Z")
_LOG = re.compile(r"\(LOG,(.*)\)\Z")
_APPEND = re.compile(r"\(LOGAPPEND,([A-Z0-9_.]+)\)\Z")
_VALUE = re.compile(r"#(\d+)")

LONGEST_LINE = 255  # characters of a line that LinuxCNC reads

_EXPECTED = (
    (r"G[01] |G53", "G53 G0 Z<signed>, G0 <axis><signed> ... or G1 <axis><signed> ... F<whole>"),
    (r"G38", f"probing moves stand in subprogram {g.TOUCH} only"),
    (r"G", f"{g.MODES}, G61, G92.1, G43 G54 to G59, G53, G0 or G1, each in a line of its own"),
    (r"M0?[34]\b", "no spindle start: there is a probe in the spindle"),
    (r"\(LOG", "(LOGAPPEND,<name>), (LOG,..) with parameters of our programs, (LOGCLOSE)"),
    (r"O", "O<number> SUB, ENDSUB, CALL, or IF [#<q> LT <signed>] with a CALL and ENDIF"),
    (r"#", "#<q> = <signed>, or a system parameter that our programs read"),
)
_ANYTHING = "a line of the closed list: ( ; G T M # O and a touch"


def read_gcode(data: bytes, path: str | Path) -> list[Block]:
    """Blocks of a program file, subprograms after the program's end as other languages have them.

    Raises:
        BadFile: A byte outside ASCII, mixed line ends, a last line cut off or one that is too long,
            another touch than ours, a line that is not in the closed list.
    """
    own = gcode_lines(physical_lines(data, path))
    lines = [" ".join(line.text.split()) for line in own]
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            found = f"{len(line)} characters: {line[:40]!r}..."
            raise BadFile(path, number, found, f"{LONGEST_LINE} at most, as LinuxCNC reads")
    blocks = list(_Reader(lines, path).blocks())
    inside: list[Block] = []
    outside: list[Block] = []
    within = False
    for block in blocks:
        if block.kind is Kind.LABEL and Label.is_behind(int(block.word("label"))):
            outside.append(block)
            continue
        ends = block.kind is Kind.LABEL and block.word("label") == "0"
        begins = block.kind is Kind.LABEL and not ends
        if begins == within and (begins or ends):
            raise BadFile(path, block.line, repr(block.text), "ENDSUB after every SUB")
        within = (within or begins) and not ends
        (inside if within or ends else outside).append(block)
    return [*outside[:-1], *inside, *outside[-1:]]


class _Reader:
    """Goes through the lines; some blocks have several."""

    def __init__(self, lines: Sequence[str], path: str | Path) -> None:
        self.lines, self.path, self.i = lines, path, 0
        self.has_touch = False

    def blocks(self) -> Iterator[Block]:
        """All blocks in the order of the file."""
        while self.i < len(self.lines):
            text = self.lines[self.i]
            if text.startswith(f"O{g.TOUCH} SUB"):  # it must agree word for word
                for expected in g.TOUCH_BODY.split(g.LINE_END):
                    self._must(expected)
                self.has_touch = True
            elif text.startswith("(LOGAPPEND"):
                yield self._printed()
            elif _IF.match(text):
                yield self._test()
            elif match := _SKIP_IF.match(text) or _SKIPPED.match(text):
                yield self._skip(match, text)
            else:
                yield from self._single(text)

    def _take(self, expected: str) -> str:
        """The next line; refuses the end of the file."""
        if self.i == len(self.lines):
            raise BadFile(self.path, self.i, "the end of the file after it", expected)
        self.i += 1
        return self.lines[self.i - 1]

    def _must(self, expected: str) -> None:
        found = self._take(expected)
        if found != expected:
            raise BadFile(self.path, self.i, repr(found), expected)

    def _test(self) -> Block:
        line, text = self.i + 1, self._take("")
        match = _IF.match(text)
        assert match is not None
        called = _PATTERNS[Kind.CALL].match(self._take("O<number> CALL"))
        if called is None:
            raise BadFile(self.path, self.i, repr(self.lines[self.i - 1]), "O.. CALL")
        self._must(f"O{match[1]} ENDIF")
        words: Words = {**match.groupdict(), "label": called["label"]}
        return Block(line, Kind.JUMP, words, text)

    def _skip(self, match: re.Match[str], text: str) -> Block:
        """Begin or end of a visit that may be skipped."""
        self.i += 1
        number = int(match[1]) - SKIP
        if not Label.is_behind(number):
            raise BadFile(self.path, self.i, repr(text), "an IF or ENDIF of our programs")
        label: Words = {"label": str(number)}
        if not match.groupdict():
            return Block(self.i, Kind.LABEL, label, text)
        words: Words = {"q": match["q"], "than": "GT", "limit": match["limit"]}
        return Block(self.i, Kind.JUMP, {**words, **label}, text)

    def _printed(self) -> Block:
        """Lines of a log as those of a mask file."""
        line, text = self.i + 1, self._take("")
        target = _APPEND.match(text)
        if target is None:
            raise BadFile(self.path, line, repr(text), "(LOGAPPEND,<name>)")
        lines: list[str] = []
        asked = ""
        while (found := self._take("(LOGCLOSE)")) != "(LOGCLOSE)":
            if found in (g.WAIT, g.DATE):
                asked = "SECONDS" if found == g.WAIT else "CALENDAR"
                continue
            lines.append(self._log_line(found, asked))
        words = {"mask": "", "target": target[1], "lines": "\n".join(lines)}
        return Block(line, Kind.PRINT, words, text)

    def _log_line(self, text: str, asked: str) -> str:
        """A line of the log in the form of a mask; `asked` is what the input now holds."""
        match = _LOG.match(text)
        if match is None or '"' in text or "%" in text:
            raise BadFile(self.path, self.i, repr(text), _EXPECTED[4][1])
        arguments = []
        for number in _VALUE.findall(match[1]):
            own = {g.INPUT[1:]: asked, g.LENGTH[1:]: f"Q{TOOL_LENGTH}"}.get(number, f"Q{number}")
            if not own:
                found = f"{text!r} before {g.WAIT} or {g.DATE}"
                raise BadFile(self.path, self.i, found, "the clock read in this log")
            arguments.append(own)
        return f'"{_VALUE.sub("%1.6LF", match[1])}"' + "".join(f",{a}" for a in arguments) + ";"

    def _single(self, text: str) -> Iterator[Block]:
        """Blocks of one line; a touch and the reset of shifts are several to the interpreter."""
        self.i += 1
        line, touch = self.i, _TOUCH.match(text)
        if touch is not None:
            if not self.has_touch:
                raise BadFile(self.path, line, repr(text), f"O{g.TOUCH} SUB before it")
            yield from _touch_blocks(line, text, touch)
            return
        for kind, pattern in _PATTERNS.items():
            match = pattern.match(text)
            if match is not None:
                many = [_meant(kind, match.groupdict())]
                if kind is Kind.SHIFT:
                    shifts = enumerate("XYZ", 1)
                    many = [{"index": str(i), "axis": a, "value": "+0"} for i, a in shifts]
                yield from (Block(line, kind, one, text) for one in many)
                return
        expected = next((e for begin, e in _EXPECTED if re.match(begin, text)), _ANYTHING)
        raise BadFile(self.path, line, repr(text), expected)


def _touch_blocks(line: int, text: str, match: re.Match[str]) -> Iterator[Block]:
    yield Block(line, Kind.PROBE_NAME, {}, text)
    yield Block(line, Kind.PROBE_RESULT, {"q": str(int(Q.RESULT_X))}, text)
    yield Block(line, Kind.PROBE_VECTOR, match.groupdict(), text)
    yield Block(line, Kind.PROBE_PATH, {**match.groupdict(), "system": "0"}, text)


def _meant(kind: Kind, words: Words) -> Words:
    """Words of a line as the closed list has them."""
    if kind is Kind.PRESET:
        return {"row": parameter(int(words["row"] or 0) - 3)}
    if kind is Kind.LINE:  # G0 is rapid whatever feed was before; G53 is for one line, as M91
        functions = " M91" if words["machine"] else ""
        feed = "MAX" if words["g"] == "G0" else words["feed"]
        return {"axes": words["axes"], "radius": " R0", "feed": feed, "functions": functions}
    if kind is Kind.SUBTRACT and f"#{words['from']}" == g.LENGTH and words["other"] is None:
        return {**words, "from": str(TOOL_LENGTH)}
    if kind is Kind.LABEL and words["what"] == "ENDSUB":
        return {"label": "0"}
    return words
