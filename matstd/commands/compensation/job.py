"""What compensate, serve and contributions begin with: errors of a machine, state, datum."""

import argparse
from collections.abc import Sequence

from matstd.api.compensating import Compensation, ProgramOptions, compensate
from matstd.compensation.field import State
from matstd.console import say_each
from matstd.effect_kinds import register_effects
from matstd.options import named_numbers
from matstd.report.words import remark_sentence
from matstd.twin.errors import DesignError
from matstd.twin.units import DEG, MINUTE

_SUCH_AS = "a name and a number, such as X=100"


def read_job(args: argparse.Namespace) -> Compensation:
    """What the command line says of machine, state and datum; raises DesignError."""
    register_effects(*args.effects)
    machine = compensate(
        args.model,
        args.errors,
        tool_length=args.tool_length,
        datum=named_readings("--datum", args.datum),
        within=dict(_range(word) for word in args.within),
        state=machine_state(args),
        add=args.add,
        switch=named_numbers("--switch", args.switch, _SUCH_AS),
        active=args.active,
    )
    say_each(remark_sentence(remark) for remark in machine.remarks)
    return machine


def machine_state(args: argparse.Namespace) -> State:
    """What the options `DRIVEN` say of the state of a machine."""
    return State(
        time=args.after * MINUTE,
        temperature=named_numbers("--temperature", args.temperature, _SUCH_AS),
        spindle_rpm=args.rpm,
        value=named_numbers("--value", args.value, _SUCH_AS),
        force=tuple(args.load),
    )


def program_options(args: argparse.Namespace) -> ProgramOptions:
    """What the options `PROGRAM` say of a part program."""
    return ProgramOptions(
        tools=_by_tool("--tool", args.tool),
        radii=_by_tool("--tool-radius", args.tool_radius),
        pass_m=args.pass_m,
        tcp_m=args.tcp_m or (),
        loads=args.loads,
    )


def _by_tool(option: str, words: Sequence[str]) -> dict[int | str, float]:
    """Lengths or radii of tools by number, or by name in capitals, mm; raises DesignError."""
    return {
        int(name) if name.isdigit() else name.upper(): size
        for name, size in named_numbers(option, words, _SUCH_AS).items()
    }


def named_readings(option: str, words: Sequence[str]) -> dict[str, float]:
    """Readings by axis: of linear axes in mm, of rotary axes, whose letter is A, B or C, in rad."""
    given = named_numbers(option, words, _SUCH_AS)
    return {axis: value * (DEG if axis[0] in "ABC" else 1.0) for axis, value in given.items()}


def _range(word: str) -> tuple[str, tuple[float, float]]:
    """An axis and its ends."""
    name, _, ends = word.partition("=")
    low, colon, high = ends.partition(":")
    if not colon:
        raise DesignError(f"--within {word}: expected an axis and its ends, such as X=-100:100")
    both = [named_readings("--within", [f"{name}={end}"])[name] for end in (low, high)]
    return name, (both[0], both[1])
