"""What the page of a machine shows, and what it says of that."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.report.machine.error_series import ErrorFunction
from matstd.report.machine.played import Played
from matstd.report.machine.solids import Drawn
from matstd.report.machine.swivel import swivel_remarks
from matstd.report.numbers import digits, microns, plural, um
from matstd.twin.machine import Chain, parse_symbol
from matstd.twin.units import UM
from matstd.twin.words import listed

PLAIN = "Bodies are drawn from the chain, not to scale."
_ASSUMED = (
    "No errors are given. Listed are those that this machine can have, each linear over its travel "
    "in the size expected of its class; all are switched off at first: switch them on one by one. "
    "Errors of a spindle that is not programmed and of the set-up, which the error parameters of a "
    "design count too, are left out."
)
_NAMED = 3  # errors that the box at the head names
_OWN_BODIES = "Bodies of {} are from your files."


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownMachine:
    """What a page of a machine shows."""

    chain: Chain
    length: float  # of the tool at first, mm
    duration: float  # over which the errors hold after the time of their state, s
    errors: Sequence[ErrorFunction] = ()  # as functions of the readings
    source: str = ""  # where they are from; empty where none are given
    is_assumed: bool = False  # whether sizes are those expected of the classes
    bodies: Sequence[Drawn] = ()  # beside the plain ones, or in place of them
    replaced: Sequence[str] = ()  # links whose plain bodies are left out
    from_files: Sequence[str] = ()  # links whose bodies are from the user's files
    program: Played | None = None  # that is played, if any
    # readings and tool length of the preset, to which deviations may refer
    datum: tuple[np.ndarray, float] | None = None
    remarks: Sequence[str] = ()  # sentences on the model


def shown_lines(shown: ShownMachine) -> list[str]:
    """What is on the page, for the console: counts, then what is left out."""
    chain = shown.chain
    count = plural(len(shown.errors), "error")
    out = [f"{chain.name}: {count}" + (f" of {shown.source}" if shown.source else "")]
    if shown.program is not None:
        played = shown.program
        out[0] += f", {plural(len(played), 'position')} of {listed(list(played.names[:3]))}"
    return [*out, *(f"- {note}" for note in _own_notes(shown))]


def machine_lead(shown: ShownMachine) -> str:
    """What is seen, in a sentence or two."""
    words = [f"Kinematic chain {shown.chain.notation}."]
    if shown.program is not None:
        words.append(f"Plays {listed(list(shown.program.names[:3]))}.")
    if shown.source:
        words.append(f"Errors of {shown.source}.")
    words.append(PLAIN)
    if shown.from_files:
        words.append(_OWN_BODIES.format(listed(list(shown.from_files))))
    return " ".join(words)


def machine_notes(shown: ShownMachine) -> list[str]:
    """What the user should know of the errors and of the machine."""
    return [*_own_notes(shown), *shown.chain.remarks, *swivel_remarks(shown.chain)]


def _own_notes(shown: ShownMachine) -> list[str]:
    """The same without what the machine file leaves open."""
    out = [_ASSUMED] if shown.is_assumed else []
    out += [] if shown.errors or shown.is_assumed else ["No errors are given."]
    missing = [one.name for one in shown.errors if one.left_out]
    if missing:
        out.append(
            f"Not on this page: {listed(missing)}. They depend on more than three readings at once."
        )
    worst = max((s.off for one in shown.errors for s in one.series), default=0.0)
    if worst > 0.01 * UM:
        names = [e.name for e in shown.errors if any(s.off > 0.01 * UM for s in e.series)]
        out.append(
            f"Steps or kinks of {listed(names)} are drawn smoothed, by up to {microns(worst)} at "
            "the poses that were checked."
        )
    return [*out, *shown.remarks]


def machine_meaning(shown: ShownMachine) -> str:
    """What the errors do to the tool point, and how near the probe comes to a body."""
    return " ".join(filter(None, (_size_of_errors(shown), _nearest(shown.program))))


def _size_of_errors(shown: ShownMachine) -> str:
    """The largest errors and their deviations."""
    if not shown.errors:
        return (
            "" if shown.program is not None else "Without errors the page shows the ideal machine."
        )
    largest = ", ".join(f"{_title(one)} {um(one.size)}" for one in shown.errors[:_NAMED])
    more = len(shown.errors) - _NAMED
    rest = f"; {plural(more, 'other error')} displace it less" if more > 0 else ""
    most = f"displace the tool point most (rms over the travels, tool {shown.length:g} mm): "
    if shown.is_assumed:
        return (
            "These errors are those to expect of such a machine, not those of yours. In their "
            f"expected sizes these {most}{largest}{rest}."
        )
    return f"These errors {most}{largest}{rest}."


def _title(one: ErrorFunction) -> str:
    symbol = parse_symbol(one.name)
    return f"{one.title or (symbol.title if symbol is not None else one.name)} [{one.name}]"


def _nearest(played: Played | None) -> str:
    """Where the probe comes nearest to a body, or into one."""
    if played is None or played.clearance is None or played.nearest is None:
        return ""
    k = int(np.nanargmin(played.clearance))
    gap, what = float(played.clearance[k]), played.nearest[k]
    where = f"at {played.place(k)} of {played.names[played.which[k]]}"
    if gap <= 0.0:
        return f"The tool runs into {what} {where}."
    return (
        f"The tool above its ball keeps {digits(gap)} mm clear of every body; {what} is nearest, "
        f"{where}."
    )


def machine_next(shown: ShownMachine) -> str:
    """What to do with the page."""
    played = shown.program
    if played is not None and played.touch is not None:
        return _before_probing(played)
    if shown.is_assumed or not shown.errors:
        return (
            "Design a standard (`matstd design`), probe it and diagnose the run. `matstd show "
            "MACHINE.toml --model model.toml` then shows the errors of your machine."
        )
    if played is not None:
        return (
            "Look at what is largest where the program cuts. `matstd compensate` writes the "
            "program, or tables of the control, with these deviations taken off."
        )
    return (
        "Move the axes to where you machine: the largest contributions there are what to adjust or "
        "compensate first. `--program` plays a part program through these errors."
    )


def _before_probing(played: Played) -> str:
    """Of probing programs."""
    if played.clearance is None:
        return "`--standard STANDARD.toml` shows the standard and how clear of it the probe stays."
    if np.nanmin(played.clearance) <= 0.0:
        return "Do not run these programs: move the body, state it in the project and design again."
    return (
        "Compare bodies and places with what stands on the machine, then follow the set-up sheet: "
        "single block and feed low at first. The programs know no body that is not drawn here."
    )
