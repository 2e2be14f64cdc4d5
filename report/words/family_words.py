"""Which family of features a standard has, and by how much it wins, in one line."""

from matstd.artefact.hidden import SIZE
from matstd.artefact.place import CLEAR_LEAD, Family, FamilyFigures, Placement
from matstd.report.numbers import digits, percent, um

NAMES = {
    Family.BALLS: "balls alone",
    Family.FACES: "small faces",
    Family.FLAT: "flat pads",
    Family.WAVY: "one wavy face",
}


def family_line(placement: Placement) -> str:
    """The family that is built, its figure, and those of the others; empty for none tried."""
    if not placement.families:
        return ""
    by_family = {one.family: one for one in placement.families}
    own = by_family.pop(placement.family)
    face = placement.standard.patches[0] if placement.family is Family.WAVY else None
    what = NAMES[own.family]
    if face is not None:
        a, b = (round(2.0 * half) for half in face.half_size)
        what += f" of {a} x {b} mm"
    is_bump, width, direction = own.least
    least = "a short error of one axis" if is_bump else "a smooth field"
    words = (
        f"Built: {len(placement.standard.spheres)} balls with {what}. After {_effort(own)} the "
        f"effect of {um(SIZE)} rms that shows least ({least}, {width:g} mm wide, along "
        f"{direction}) has {digits(own.signal, 2)} times its standard uncertainty (detected with "
        f"{100.0 * own.power:.0f} %)"
    )
    others = [_other(one) for one in by_family.values()]
    balls = by_family.get(Family.BALLS)
    if balls is not None and balls.signal > CLEAR_LEAD * own.signal:
        first = f"Balls alone would show {percent(balls.signal / own.signal - 1.0)} more. "
    else:
        first = ""
    return f"{first}{words}; {'; '.join(others)}." if others else f"{words}."


def _effort(one: FamilyFigures) -> str:
    scan = f" and {one.scan_points} points of a scan" if one.scan_points else ""
    return f"{one.touches} touches{scan}"


def _other(one: FamilyFigures) -> str:
    if one.refused:
        return f"{NAMES[one.family]}: cannot be built ({one.refused})"
    return (
        f"{NAMES[one.family]}: {digits(one.signal, 2)} after {_effort(one)}, "
        f"{um(one.rms_user)} rms left in the workspace"
    )
