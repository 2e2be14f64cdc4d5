"""Which family of features a standard has, and by how much it wins, in one line."""

from collections.abc import Sequence

from matstd.artefact.body import Standard
from matstd.artefact.hidden import SIZE
from matstd.artefact.place import CLEAR_LEAD, Family, FamilyFigures, Placement, score_of
from matstd.report.numbers import digits, euros, percent, plural, um

NAMES = {
    Family.BALLS: "balls alone",
    Family.FACES: "small faces",
    Family.FLAT: "flat pads",
    Family.WAVY: "one wavy face",
}

_GOALS = {
    "prove": "showing unmodelled effects",
    "identify": "the error that remains unknown in the workspace",
    "worst": "the error that remains unknown at the worst pose",
    "minutes": "showing unmodelled effects in equal time",
    "price": "the price",
}


def proving_words(standard: Standard, family: Family | None = None) -> str:
    """Features of a standard that prove: `one wavy face`, `5 balls that prove`."""
    if not standard.patches:
        return f"{plural(len(standard.proving), 'ball')} that prove"
    if family is Family.WAVY:
        return "one wavy face"
    return plural(len(standard.patches), "flat pad" if family is Family.FLAT else "freeform face")


def features_words(standard: Standard, family: Family | None = None) -> str:
    """All features of a standard: `13 balls and one wavy face`."""
    own = sum(not ball.proves for ball in standard.spheres)
    return f"{plural(own, 'ball')} and {proving_words(standard, family)}"


def family_line(placement: Placement) -> str:
    """The family that is built and by how much it leads, its figure, and those of the others.

    Empty where none was tried.
    """
    if not placement.families:
        return ""
    by_family = {one.family: one for one in placement.families}
    own = by_family.pop(placement.family)
    built = f"Built: {features_words(placement.standard, own.family)}"
    if own.family is Family.WAVY:
        a, b = (round(2.0 * half) for half in placement.standard.patches[0].half_size)
        built += f" of {a} x {b} mm"
    lead = _lead(placement, own, [*by_family.values()])
    words = f"{built}. {lead}{_shown(placement, own)}, and {_left(own)}"
    others = [_other(one) for one in by_family.values()]
    return f"{words}. Not built: {'; '.join(others)}." if others else f"{words}."


def shown_line(placement: Placement) -> str:
    """What one wavy face shows of effects that no model has; empty for other families."""
    own = [one for one in placement.families if one.family is placement.family is Family.WAVY]
    return f"{_shown(placement, own[0])}." if own else ""


def _shown(placement: Placement, own: FamilyFigures) -> str:
    roles = f"{len(placement.requests)} that identify, {len(placement.proof)} that prove"
    is_bump, width, direction = own.least
    least = "a short error of one axis" if is_bump else "a smooth field"
    return (
        f"After {_effort(own)} ({roles}) the effect of {um(SIZE)} rms that shows least ({least}, "
        f"{width:g} mm wide, along {direction}) has {digits(own.signal, 2)} times its standard "
        f"uncertainty (detected with {100.0 * own.power:.0f} %)"
    )


def _lead(placement: Placement, own: FamilyFigures, others: Sequence[FamilyFigures]) -> str:
    """By how much a family leads for the goal; empty for a family that was asked for by name."""
    goal, there = placement.goal, [one for one in others if not one.refused]
    if not there:
        return ""
    second = max(there, key=lambda one: score_of(one, goal))
    mine, theirs, name = score_of(own, goal), score_of(second, goal), NAMES[second.family]
    words = f"For {_GOALS[goal]} (goal '{goal}')"
    if mine >= theirs:
        return f"{words} it is {percent(mine / theirs - 1.0)} better than the next, {name}. "
    cost = second.rms_user / own.rms_user - 1.0
    why = (
        f"less than the {percent(CLEAR_LEAD - 1.0)} from which they are built"
        if second.family is Family.BALLS
        else f"but would leave {percent(cost)} more unknown in the workspace"
    )
    return f"{words} {name} would be {percent(theirs / mine - 1.0)} better, {why}. "


def _left(one: FamilyFigures) -> str:
    return (
        f"{um(one.rms_user)} rms, {um(one.worst_user)} at the worst pose, remain unknown in the "
        f"workspace{_price(one)}"
    )


def _price(one: FamilyFigures) -> str:
    return "" if one.price is None else f", {euros(one.price.value, one.price.u)}"


def _effort(one: FamilyFigures) -> str:
    scan = f" and {one.scan_points} points of a scan ({one.scan_minutes:.0f} min)"
    scan = scan if one.scan_points else ""
    return f"{one.touches} touches{scan}"


def _other(one: FamilyFigures) -> str:
    if one.refused:
        return f"{NAMES[one.family]}: cannot be built ({one.refused})"
    return f"{NAMES[one.family]}: {digits(one.signal, 2)} after {_effort(one)}, {_left(one)}"
