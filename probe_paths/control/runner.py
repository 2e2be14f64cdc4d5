"""Executes the blocks of a program one after the other and collects what they do."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from matstd.nc.grammar import COMPARISONS, MAX_DEPTH, Flow
from matstd.probe_paths.control.modes import check_cycle, read_datum, set_mode
from matstd.probe_paths.control.motion import retract_max, straight_line
from matstd.probe_paths.control.state import State
from matstd.probe_paths.control.steps import (
    STATUS,
    Halt,
    Move,
    Print,
    ProbeStep,
    Result,
    Step,
    Value,
)
from matstd.probe_paths.language import (
    Block,
    Interlock,
    Kind,
    Label,
    MaskLine,
    Q,
    head_mask,
    language_of,
    parse_mask,
    shared_masks,
)
from matstd.probe_paths.plan import Heading, ProgramFrame, Sensor
from matstd.twin.errors import BadFile
from matstd.twin.units import MINUTE

MaskSource = Callable[[str], str | None]
"""Gives the text of a mask file by its name without folder; None where there is none."""

_SILENT = {
    Kind.COMMENT,
    Kind.STRUCTURE,
    Kind.STOCK_LOW,
    Kind.STOCK_HIGH,
    Kind.SHIFT_NAME,
    Kind.STOP,
    Kind.BEGIN,
    Kind.PROBE_NAME,
    Kind.PROBE_RESULT,
    Kind.PROBE_VECTOR,
}

_DECIMALS = 6
_FORMAT = re.compile(r"%[\d.]+(?=LF|d)")


def _shape(lines: Sequence[MaskLine]) -> tuple[tuple[str, tuple[int | str, ...]], ...]:
    """Lines of a log without the widths of their numbers."""
    return tuple((_FORMAT.sub("%", line.text), line.arguments) for line in lines)


class Runner:
    """Executes blocks one after the other and collects what they do."""

    def __init__(
        self,
        blocks: Sequence[Block],
        places: dict[str, int],
        frame: ProgramFrame,
        path: Path,
        name: str,
        masks: MaskSource,
        head: Heading,
    ) -> None:
        self.blocks, self.places, self.frame, self.path = blocks, places, frame, path
        self.name, self.folder = name, ""
        self.source = masks
        self.masks: dict[str, tuple[MaskLine, ...]] = {}
        form = language_of(path).log
        rotary, remarks = frame.chain.rotary_axes, head.log_lines
        self.sensed = {sensor.parameter: sensor for sensor in head.sensors}
        texts = [head_mask(form, name, remarks)]
        texts += shared_masks(form, _DECIMALS, rotary, head.sensors).values()
        texts.append(head_mask(form, name, remarks, rotary, _DECIMALS))
        self.readable = {_shape(parse_mask(text, path)) for text in texts}
        self.touches: list[ProbeStep] = []
        self.logged: set[int] = set()
        self.branches = 0  # within each other, at this moment

    def run(self, start: int, state: State, is_branch: bool = False) -> list[Step]:
        """Steps from one block to the end of the program."""
        steps: list[Step] = []
        flow = Flow(self.path, self.places, 100 * len(self.blocks))
        i = start
        while True:
            block = self.blocks[i]
            flow.count(block.line)
            if block.kind is Kind.END:
                raise state.refusal(block, "M30 or LBL 0 before it", "END PGM")
            if block.kind is Kind.PROGRAM_STOP:
                self._check_end(state, block, flow)
                return steps
            if block.kind is Kind.ERROR:
                if state.fault is None:
                    self._check_halt(block, steps, is_branch)
                else:
                    self._check_alarm(i, state, state.fault)
                return [*steps, Halt(block.line, int(block.word("number")))]
            i = self._next(i, block, state, flow, steps)

    def _next(self, i: int, block: Block, state: State, flow: Flow, steps: list[Step]) -> int:
        """Execute one block; returns the index of the following one."""
        if block.kind is Kind.CALL:
            return flow.call(i, block.line, block.word("label"))
        if block.kind is Kind.LABEL and block.word("label") == "0":
            back = flow.end()
            if back is None:
                raise state.refusal(block, "M30 before subprograms", "LBL 0 without a call")
            return back
        if block.kind is Kind.JUMP:
            return self._jump(i, block, state)
        if block.kind in _SILENT:
            return i + 1
        if block.kind is Kind.LABEL and Label.stands_inside(int(block.word("label"))):
            return i + 1
        step = self._execute(i, block, state)
        if step is not None:
            steps.append(step)
        return i + 1

    def _jump(self, i: int, block: Block, state: State) -> int:
        """FN 11, 12: a number decides at once; for the status of a touch both branches are run."""
        than, q, label = block.word("than"), int(block.word("q")), block.word("label")
        value, is_less = state.value(block, q), than == "LT"
        if q == Q.START or Label.is_behind(int(label)):
            self._check_skip(i, block, state)
        target, limit = self.places[label] + 1, block.number("limit")
        if not isinstance(value, Result):
            if COMPARISONS[than](value, limit):
                return target
            state.note_test(q, int(label), limit, is_less)
            return i + 1
        if value.part != STATUS or limit != 0.0 or not is_less:
            raise state.refusal(block, "the status (fourth result) LT +0")
        touch = self.touches[value.touch]
        state.untested = None
        missed = state.copied()
        # a contact in the air ends the program, no contact continues it
        wrong, right = (i + 1, target) if touch.is_air else (target, i + 1)
        self.branches += 1
        if self.branches > MAX_DEPTH:  # a branch that comes back to its own touch
            raise state.refusal(block, "a program that comes to M30", "a loop without end")
        touch.on_miss.extend(self.run(wrong, missed, is_branch=True))
        self.branches -= 1
        if touch.is_air and not isinstance(touch.on_miss[-1], Halt):
            raise state.refusal(block, state.terms.halt, "a contact in the air that does not stop")
        return right

    def _check_skip(self, i: int, block: Block, state: State) -> None:
        """A visit is skipped after its turn and all tests, up to the retract of the next one."""
        state.check_is_as_planned(block)
        label = block.word("label")
        place = self.places[label]
        after = next(b for b in self.blocks[place + 1 :] if b.kind is not Kind.STRUCTURE)
        is_retract = after.kind is Kind.LINE and "M91" in after.word("functions")
        is_start = block.word("q") == str(int(Q.START)) and block.word("than") == "GT"
        is_start = is_start and Label.is_behind(int(label))
        if not (is_start and place > i and is_retract and state.is_retracted):
            expected = f"Q{Q.START:d} GT, a label behind the visit, a retract "
            raise state.refusal(block, f"{expected}({state.terms.retract}) before it and there")

    def _execute(self, i: int, block: Block, state: State) -> Step | None:
        """Execute a block that changes the state or makes a step."""
        if block.kind is Kind.LINE:
            return straight_line(state, block)
        if block.kind is Kind.RETRACT_MAX:
            return retract_max(state, block)
        if block.kind is Kind.PRINT:
            return self._print(block, state)
        if block.kind is Kind.PROBE_PATH:
            return self._probing(i, state)
        if block.kind is Kind.READ:
            read_datum(block, state)
        else:
            set_mode(block, state)
        return None

    def _probing(self, i: int, state: State) -> ProbeStep:
        """Execute cycle 4, whose other three blocks precede this one."""
        block, vector = self.blocks[i], self.blocks[i - 1]
        result = int(self.blocks[i - 2].word("q"))
        state.check_status_was_tested(block)
        state.check_ready(block, "a touch")
        state.check_turn_was_tested(block)
        column = state.frame.chain.axis_index("Z")
        moving = [*state.frame.linear, *state.frame.rotary]
        if not np.all(np.isfinite(state.q[moving])):
            raise state.refusal(block, "a position of every axis before it", "a touch")
        is_above = state.clearance is None or state.q[column] > state.clearance
        if is_above or state.way_back is not None:
            raise state.refusal(block, "a move down to its start before it", "a touch")
        direction = np.zeros(len(state.q))
        direction[state.frame.linear] = [vector.number(a) for a in "xyz"]
        length = float(np.linalg.norm(direction))
        check_cycle(state, block, vector, length)
        after = self.blocks[i + 1]
        goes_on = after.kind is Kind.JUMP and after.word("label") == str(int(Label.AIR))
        is_air = state.is_first and goes_on
        touch = ProbeStep(
            line=block.line,
            index=len(self.touches),
            q=np.nan_to_num(state.q),
            direction=direction / length,
            distance=block.number("distance"),
            feed=block.number("feed") / MINUTE,
            slow_feed=float(block.words.get("slow") or 0.0) / MINUTE,
            step_back=float(block.words.get("step") or 0.0),
            back=block.number("back"),
            side=state.side.copy(),
            number=0 if is_air else state.whole(block, Q.TOUCH, "touch"),
            pose=0 if is_air else state.whole(block, Q.POSE, "pose"),
            feature=0 if is_air else state.whole(block, Q.FEATURE, "feature"),
            is_air=is_air,
        )
        if not is_air:
            self._check_sides(block, state, touch)
        state.stale |= {Q.TOUCH, Q.FEATURE}
        left_over = state.parameters.get(result + STATUS)
        for part in range(4):
            state.write(block, result + part, Result(touch.index, part))
        # before a touch its status must be set to the opposite of the expected one
        if not isinstance(left_over, float) or (left_over >= 0.0) is not is_air:
            unset = state.terms.unset.format(q=result + STATUS)
            expected = f"{unset.replace('-1', '+0') if is_air else unset} before it"
            raise state.refusal(block, expected, "the status of the touch before")
        state.untested, state.way_back = touch.index, state.q.copy()
        state.is_synchronous = False
        self.touches.append(touch)
        return touch

    def _check_sides(self, block: Block, state: State, touch: ProbeStep) -> None:
        """Refuse stated sides that differ from those that the axes came from."""
        if any(other.number == touch.number for other in self.touches):
            raise state.refusal(block, "a number of its own", f"touch number {touch.number} again")
        names = state.frame.chain.rotary_axes
        for q, column, name in zip((Q.SIDE_1, Q.SIDE_2), state.frame.rotary, names, strict=False):
            stated = state.whole(block, q, f"side of {name}")
            if stated != touch.side[column]:
                expected = f"{touch.side[column]:+.0f}, as it last moved"
                raise state.refusal(block, expected, f"{name} said to come from side {stated:+d}")

    def _print(self, block: Block, state: State) -> Print:
        """FN 16 with the present values."""
        state.check_status_was_tested(block)
        if not state.is_synchronous:
            raise state.refusal(block, f"{state.terms.sync} before it", "a line printed ahead")
        self._check_place(block, state)
        lines = self._mask(block, state)
        wanted = {a for line in lines for a in line.arguments if isinstance(a, int)}
        values: dict[int, Value | Sensor] = {
            q: self.sensed.get(q) or state.value(block, q) for q in sorted(wanted)
        }
        self.logged |= {v.touch for v in values.values() if isinstance(v, Result)}
        return Print(block.line, lines, block.word("target").split("\\")[-1], values)

    def _check_place(self, block: Block, state: State) -> None:
        """Refuse a log of another name than the program's or in another folder than the masks."""
        target, mask = block.word("target"), block.word("mask")
        folder = target.rpartition("\\")[0]
        self.folder = self.folder or folder
        expected = f"{self.folder}\\{self.name}.TXT".lstrip("\\")
        if target != expected:
            raise state.refusal(block, expected, f"a log {target}")
        if mask.rpartition("\\")[0] != self.folder:
            raise state.refusal(block, f"a mask in {self.folder}, where the log is", f"mask {mask}")

    def _mask(self, block: Block, state: State) -> tuple[MaskLine, ...]:
        """Lines that a block prints; refuses those that the reader of logs does not know."""
        name = block.word("mask").split("\\")[-1]
        if name in self.masks:
            return self.masks[name]
        text = block.words["lines"] if "lines" in block.words else self.source(name)
        if text is None:
            raise state.refusal(block, "a mask file beside the program", f"mask {name}")
        lines = parse_mask(text, self.path.parent / name if name else self.path)
        if _shape(lines) not in self.readable:
            expected = "those of a head, a touch, a missed touch or an end, as they are emitted"
            found = f"{len(lines)} lines for the log that begin with {lines[0].text!r}"
            raise state.refusal(block, expected, found)
        if name:
            self.masks[name] = lines
        return lines

    def _check_end(self, state: State, block: Block, flow: Flow) -> None:
        state.check_status_was_tested(block)
        if flow.returns:
            raise state.refusal(block, "LBL 0 at its end", "M30 inside a subprogram")
        if not state.is_retracted:
            raise state.refusal(block, f"a retract ({state.terms.retract}) at the end", "M30")

    def _check_alarm(self, i: int, state: State, fault: Interlock) -> None:
        """Refuse a stop behind another label than that of its alarm."""
        label = next(b for b in reversed(self.blocks[:i]) if b.kind is Kind.LABEL)
        if label.word("label") != str(int(fault.label)):
            expected = f"LBL {fault.label:d}, the alarm of that"
            found = f"a stop behind LBL {label.word('label')} where {fault.what} is off"
            raise state.refusal(self.blocks[i], expected, found)

    def _check_halt(self, block: Block, steps: list[Step], is_branch: bool) -> None:
        """Refuse an early end other than after a touch without contact and a retract."""
        up = [step for step in steps if isinstance(step, Move)]
        if not is_branch or len(up) != 1 or up[0].checked:
            retract = language_of(self.path).terms.retract_max
            expected = f"{retract}, and no other move, after a touch without contact"
            raise BadFile(self.path, block.line, repr(block.text), expected)

    def check_logged(self) -> None:
        """Every touch ends up in the log; raises BadFile."""
        for touch in self.touches:
            if touch.index not in self.logged and not touch.is_air:
                found = f"touch {touch.number} without a log line"
                expected = f"{language_of(self.path).terms.printed} with its results"
                raise BadFile(self.path, touch.line, found, expected)
