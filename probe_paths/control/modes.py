"""Modes, system data and numbers of cycle 4: what a block may set, read and ask for."""

import math
from collections.abc import Callable, Mapping

import numpy as np

from matstd.probe_paths.control.state import State
from matstd.probe_paths.language import TOOL_LENGTH, Block, Datum, Kind, Label, language_of
from matstd.probe_paths.plan import LINEAR
from matstd.twin.units import DEG

MAX_PROBING_FEED = 1000.0
"""Above this a cycle 4 is refused, mm/min: the trigger delay and the overtravel grow with it."""

SHORTEST_BACK = 1.0
"""Retract after a contact, mm: with less the ball still lies on the surface when it moves off."""

_UNKNOWN_READING = 17.31
"""Reading of an axis that the tool changer left anywhere, mm: not zero, so that a test of the
preset that forgot to read where the axis stands is seen."""

LONGEST_SEARCH = 10.0
"""Beyond the expected contact, mm: what a probe may be driven into where nothing is expected."""

_PRESET = "preset "  # before the letter of an axis: its coordinate from the preset
_CALIBRATED: Mapping[Datum, Callable[[State], float]] = {
    Datum.RADIUS: lambda state: state.frame.probe.radius,
    Datum.LENGTH: lambda state: state.frame.probe.tool_length,
    Datum.OFFSET_X: lambda _: 0.0,
    Datum.OFFSET_Y: lambda _: 0.0,
    Datum.TOOL_X: lambda _: 0.0,
    Datum.TOOL_Y: lambda _: 0.0,
    Datum.ROTATION: lambda _: 0.0,
    Datum.CYCLE_ROTATION: lambda _: 0.0,
    Datum.MIRROR: lambda _: 0.0,
    **{Datum[f"SCALE_{a}"]: lambda _: 1.0 for a in LINEAR},
    Datum.TOP: lambda state: state.frame.chain.link("Z").range[1],
}


def system_datum(block: Block, state: State) -> float:
    """Calibration of the probe, number of the tool, positions, end of Z, basic rotation."""
    system, word = language_of(state.path).system, block.word("datum")
    datum = next((d for d, text in system.items() if text == word), None)
    if datum is None or not _is_known(datum, state):
        available = ", ".join(text for d, text in system.items() if _is_known(d, state))
        raise state.refusal(block, f"one of {available}", word)
    letter = datum.removeprefix(_PRESET)
    is_place = letter in state.frame.letters
    if is_place and not state.is_synchronous:
        raise state.refusal(block, f"{state.terms.sync} before it", "a position read ahead")
    fault = state.fault
    is_off = fault is not None and datum == (fault.work or fault.datum)
    if fault is not None and fault.label == Label.TURNED:  # the first move goes to zero
        is_off = is_off and state.turns > 1
    if is_place:
        value = _place(letter, datum != letter, state)
    else:
        value = float(state.tool or 0) if datum is Datum.TOOL else _CALIBRATED[datum](state)
    return value + is_off * state.off


def _is_known(datum: Datum, state: State) -> bool:
    """Whether a system datum has a value here: a tool is called, the machine has the axis."""
    if datum is Datum.TOOL:
        return state.tool is not None
    return datum in _CALIBRATED or datum.removeprefix(_PRESET) in state.frame.letters


def read_datum(block: Block, state: State) -> None:
    """Execute a read of a system datum; where a rotary axis stands is known by its parameter."""
    q = int(block.word("q"))
    state.write(block, q, system_datum(block, state))
    system = language_of(state.path).system
    for letter in state.frame.chain.rotary_axes:
        if block.word("datum") == system.get(Datum(letter)):
            state.reached[q] = letter, 0.0


def _place(letter: str, is_preset: bool, state: State) -> float:
    """Position of an axis: its reading, or relative to the preset."""
    frame = state.frame
    reading = float(state.q[frame.chain.axis_index(letter)])
    reading = _UNKNOWN_READING if math.isnan(reading) else reading
    if is_preset:
        return (state.plane or frame).coordinate(letter, reading)
    return reading if letter in LINEAR else reading / DEG


def check_cycle(state: State, block: Block, vector: Block, length: float) -> None:
    """Numbers of a cycle 4 that make sense."""
    if abs(length - 1.0) > 1e-3:
        raise state.refusal(vector, "length 1", f"a vector of length {length:.4f}")
    if block.word("system") != "0":
        raise state.refusal(block, "REFERENCE SYSTEM:0", "REFERENCE SYSTEM:1")
    if not 0.0 < block.number("feed") <= MAX_PROBING_FEED:
        raise state.refusal(block, f"F1 to F{MAX_PROBING_FEED:.0f}", f"F{block.word('feed')}")
    back, distance = block.number("back"), block.number("distance")
    if not SHORTEST_BACK <= back <= distance:
        raise state.refusal(block, f"{state.terms.back} between {SHORTEST_BACK:g} mm and the path")
    is_down = state.is_search and vector.number("z") == -1.0
    if distance - back > LONGEST_SEARCH and not is_down:
        raise state.refusal(
            block, f"at most {LONGEST_SEARCH:g} mm beyond the surface that is expected",
            f"a path of {distance:g} mm with {state.terms.back} {back:g}",
        )  # fmt: skip


def set_mode(block: Block, state: State) -> None:
    """Execute a block that changes a mode or sets a parameter; raises BadFile."""
    if block.kind in _SETS:
        setattr(state, *_SETS[block.kind])
        return
    if block.kind is Kind.PRESET:
        state.preset = int(block.word("row"))
    elif block.kind is Kind.ASSIGN:
        state.write(block, int(block.word("q")), block.number("value"))
    elif block.kind is Kind.PLANE_OFF:
        state.is_plane_off, state.plane = True, None
    elif block.kind in _SETTERS:
        _SETTERS[block.kind](block, state)
    else:
        raise state.refusal(block, "a subprogram that is called, after M30")


def _plane(block: Block, state: State) -> None:
    """A tilted plane: announced in the head, square to the tool, activated at the retract."""
    rotary = state.q[state.frame.rotary]
    if not state.is_tilted:
        raise state.refusal(block, "a head that says FRAME SPATIAL")
    if not state.is_retracted or not np.all(np.isfinite(rotary)):
        retract = state.terms.retract
        raise state.refusal(block, f"a retract ({retract}) and the turn before")
    angles = np.array([block.number(a) for a in "abc"])
    if not state.frame.is_plane(angles, rotary):
        angles = state.frame.plane(rotary)
        words = " ".join(f"SP{a}{v:+.4f}" for a, v in zip("ABC", angles, strict=True))
        raise state.refusal(block, f"{words}, square to the tool as it stands")
    master = float(rotary[-1]) if len(rotary) else 0.0
    stated = float(f"{block.words['which']}1") if block.words["which"] else 0.0
    if stated != np.sign(round(master / DEG, 4)):
        raise state.refusal(block, "the solution that the axes stand at")
    state.plane = state.frame.tilted(rotary)


def _shift(block: Block, state: State) -> None:
    axis = LINEAR[int(block.word("index")) - 1]
    if block.word("axis") != axis or block.number("value") != 0.0:
        raise state.refusal(block, f"{axis}+0: only the preset may shift")
    state.shift_off.add(axis)


def _tool_call(block: Block, state: State) -> None:
    if block.words["speed"] is not None:
        raise state.refusal(block, "no speed: there is a probe in the spindle")
    if not state.is_tcpm_off or not state.is_retracted:
        terms = state.terms
        raise state.refusal(block, f"{terms.reset} and a retract with {terms.machine} before it")
    state.tool = int(block.word("tool"))
    is_other = state.fault is not None and state.fault.datum is None
    state.parameters[TOOL_LENGTH] = state.frame.probe.tool_length + is_other * state.off
    # the tool changer leaves the linear axes wherever its builder wanted
    state.q[state.frame.linear] = np.nan
    state.is_retracted = False


def _orientation(block: Block, state: State) -> None:
    """A block that orients the spindle; the tool changer turns it, so it follows the call."""
    if state.tool is None:
        raise state.refusal(block, f"{state.terms.tool} before it")
    state.orientation_left -= 1


def _subtract(block: Block, state: State) -> None:
    """FN 2: a parameter minus a number or another parameter."""
    value, is_number = state.value(block, int(block.word("from"))), block.words["other"] is None
    other = block.number("value") if is_number else state.value(block, int(block.word("other")))
    if not isinstance(value, float) or not isinstance(other, float):
        raise state.refusal(block, "numbers, not results of touches")
    held = state.reached.get(int(block.word("from"))) if is_number else None
    state.write(block, int(block.word("q")), value - other)
    if held is not None:
        state.reached[int(block.word("q"))] = held[0], held[1] + other


_SETS = {
    Kind.TCPM_ON: ("is_tcpm_off", False),
    Kind.TCPM_OFF: ("is_tcpm_off", True),
    Kind.SHORTER_WAY: ("is_shorter_way", True),
    Kind.SHORTER_WAY_OFF: ("is_shorter_way", False),
    Kind.SPINDLE_OFF: ("is_spindle_off", True),
    Kind.WAIT: ("is_synchronous", True),
}
"""What a block alone sets in the state."""

_SETTERS: Mapping[Kind, Callable[[Block, State], None]] = {
    Kind.HEAD_OFF: lambda block, state: state.head_left.discard(block.word("mode")),
    Kind.ORIENTATION: _orientation,
    Kind.PLANE: _plane,
    Kind.SHIFT: _shift,
    Kind.TOOL_CALL: _tool_call,
    Kind.SUBTRACT: _subtract,
}
