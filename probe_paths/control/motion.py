"""L blocks and retracts: which moves one of our programs may make, and which never."""

import re

import numpy as np

from matstd.probe_paths.control.state import SAME, TOP_OF_TRAVEL, State
from matstd.probe_paths.control.steps import Move
from matstd.probe_paths.language import Block, Q
from matstd.probe_paths.plan import LINEAR
from matstd.twin.frames import Array
from matstd.twin.units import DEG, MINUTE

AXIS = re.compile(r"([A-Z])([+-][\d.]+)")  # an axis and its coordinate in an L block

MAX_FEED = 5000.0
"""Largest feed of a fed move, mm/min or degrees/min: it is fed because something is near."""

_FUNCTIONS = {"M91", "M126"}


def straight_line(state: State, block: Block) -> Move:
    """Execute an L block and return its move; raises BadFile."""
    state.check_status_was_tested(block)
    if state.fault is not None and state.fault.is_at_rest:
        state.check_is_as_planned(block)
    functions = set(block.word("functions").split())
    if not functions <= _FUNCTIONS:
        extra = " ".join(sorted(functions - _FUNCTIONS))
        raise state.refusal(block, "M91 or M126 and no other M function in an L block", extra)
    state.is_radius_off = state.is_radius_off or block.words["radius"] is not None
    if not state.is_radius_off:
        raise state.refusal(block, "R0 on the first move")
    target, letters = _target(state, block, "M91" in functions)
    feed = _feed(state, block)
    state.is_shorter_way = state.is_shorter_way or "M126" in functions
    state.check_travel(block, target)
    rotary = [a for a in letters if a not in LINEAR]
    if rotary:
        _turn(state, block, target, letters, rotary)
    elif "M91" in functions and letters == ["X", "Y"] and state.frame.chain.tool_rotary_axes:
        _go_to_turning_place(state, block)
    elif "M91" in functions:
        _retract(state, block, target, letters)
    else:
        _check_height(state, block, target, letters, feed is None)
    _arrive(state, block, target)
    scale = 1.0 if not rotary else DEG
    return Move(block.line, target, None if feed is None else feed * scale / MINUTE)


def _target(state: State, block: Block, is_machine_datum: bool) -> tuple[Array, list[str]]:
    """Readings at the end of the block, and the axes it names."""
    target = state.q.copy()
    letters: list[str] = []
    for letter, number in AXIS.findall(block.word("axes")):
        if letter in letters:
            raise state.refusal(block, "every axis once in a block", f"axis {letter} twice")
        letters.append(letter)
        column = state.frame.chain.axis_index(letter)
        if is_machine_datum and letter in LINEAR:
            target[column] = float(number)
        else:
            target[column] = (state.plane or state.frame).reading(letter, float(number))
    if not is_machine_datum:
        state.check_ready(block, repr(block.text))
        if state.is_tilted and state.plane is None and not set(letters).isdisjoint(LINEAR):
            raise state.refusal(block, "PLANE SPATIAL before it, as the head says")
    return target, letters


def _feed(state: State, block: Block) -> float | None:
    """Feed of the block, mm/min or degrees/min; None is rapid."""
    word = block.words["feed"]
    if word == "MAX":
        return None
    if word is not None:
        state.feed = float(word)
    if not state.feed:
        raise state.refusal(block, f"a feed above zero, or {state.terms.rapid}")
    if state.feed > MAX_FEED:
        raise state.refusal(
            block, f"F{MAX_FEED:.0f} at most, or {state.terms.rapid}", f"F{state.feed:.0f}"
        )
    return state.feed


def _turn(state: State, block: Block, target: Array, letters: list[str], rotary: list[str]) -> None:
    """Rules for a block with rotary axes; notes the direction that every axis came from."""
    if len(rotary) != len(letters):
        raise state.refusal(block, "rotary axes in a block of their own")
    if not state.is_retracted:
        raise state.refusal(block, f"a retract ({state.terms.retract}) before it")
    if state.plane is not None:
        raise state.refusal(block, f"{state.terms.plane} before it")
    state.stale |= {Q.POSE, Q.SIDE_1, Q.SIDE_2}
    state.turns, state.turn_tested = state.turns + 1, set()
    for letter in rotary:
        column = state.frame.chain.axis_index(letter)
        step = target[column] - state.q[column]
        if state.is_shorter_way and abs(step) > np.pi + SAME:
            expected = "at most 180 degrees, or the control takes the other way round"
            found = f"{letter} turning by {step / DEG:.1f} degrees with M126 active"
            raise state.refusal(block, expected, found)
        if np.isfinite(step) and abs(step) > SAME:
            state.side[column] = np.sign(step)


def _go_to_turning_place(state: State, block: Block) -> None:
    """Rules for X and Y with M91, to where a head turns: at the retract."""
    if not state.is_tcpm_off:
        raise state.refusal(block, f"{state.terms.reset} before {state.terms.machine}")
    if not state.is_retracted:
        raise state.refusal(block, f"a retract ({state.terms.retract}) before it")


def _retract(state: State, block: Block, target: Array, letters: list[str]) -> None:
    """Rules for Z with M91: alone, up, to the top of its travel."""
    if not state.is_tcpm_off:
        raise state.refusal(block, f"{state.terms.reset} before {state.terms.machine}")
    if letters != ["Z"]:
        machine = state.terms.machine
        raise state.refusal(block, f"Z alone with {machine}, or X and Y where a head turns")
    column = state.frame.chain.axis_index("Z")
    top = state.frame.chain.link("Z").range[1]
    if target[column] < top - TOP_OF_TRAVEL:
        raise state.refusal(
            block,
            f"at least Z{top - TOP_OF_TRAVEL:+.4f}",
            f"Z{target[column]:+.4f} {state.terms.machine}",
        )
    if target[column] < state.q[column] - SAME:
        raise state.refusal(block, "a retract that does not go down")
    state.is_retracted, state.clearance = True, None


def _check_height(
    state: State, block: Block, target: Array, letters: list[str], is_rapid: bool
) -> None:
    """Rules for X, Y, Z blocks: free above the clearance height, fed and along Z below it."""
    column = state.frame.chain.axis_index("Z")
    before, after = state.q[column], target[column]
    if not np.isfinite(before):
        raise state.refusal(block, f"a retract ({state.terms.retract}) first")
    if state.is_retracted:
        if "Z" not in letters:
            return
        if letters != ["Z"] or not np.all(np.isfinite(target[state.frame.linear])):
            raise state.refusal(block, "X and Y at the retract, then Z alone")
        state.check_is_as_planned(block)
        state.is_retracted, state.clearance = False, after
        return
    assert state.clearance is not None
    # straight up leads away from everything and may be rapid
    is_up = letters == ["Z"] and after >= before
    if is_rapid and not is_up and min(before, after) < state.clearance - SAME:
        raise state.refusal(
            block, "no rapid move below the clearance height, where this pose was entered"
        )
    is_back = state.way_back is not None
    if letters != ["Z"] and not is_back and min(before, after) < state.clearance - SAME:
        raise state.refusal(
            block, "below the clearance height only moves along Z, or back from a touch"
        )


def _arrive(state: State, block: Block, target: Array) -> None:
    """Move the state to the target."""
    if state.way_back is not None:
        if not np.allclose(target, state.way_back, rtol=0.0, atol=SAME, equal_nan=True):
            raise state.refusal(block, "a move back to the start of the touch first")
        state.way_back = None
    for column in state.frame.linear:
        step = target[column] - state.q[column]
        if np.isfinite(step) and abs(step) > SAME:
            state.side[column] = np.sign(step)
    state.q = target
    state.is_synchronous = False


def retract_max(state: State, block: Block) -> Move:
    """Execute the retract after a missed touch: along the tool axis to the end of the travel."""
    state.check_status_was_tested(block)
    if not state.is_tcpm_off:
        raise state.refusal(block, f"{state.terms.reset} before {state.terms.retract_max}")
    target = state.q.copy()
    column = state.frame.chain.axis_index("Z")
    target[column] = state.frame.chain.link("Z").range[1]
    state.q, state.is_retracted, state.clearance = target, True, None
    state.way_back, state.is_synchronous = None, False
    return Move(block.line, target, None, checked=False)
