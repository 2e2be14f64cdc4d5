"""Component errors in words: the positioning error of X, the tilt of C about X."""

from twin.machine import Symbol

_OWN = {**dict(zip("ABCUVW", "XYZXYZ", strict=True)), "S": "Z"}


def motion(symbol: Symbol) -> str:
    """Where an error moves the tool, whichever body carries it: `along Z`, `about X`."""
    return f"{'about' if symbol.is_angular else 'along'} {'XYZ'[symbol.component % 3]}"


def component_title(symbol: Symbol) -> str:
    """What the six component errors of an axis are called.

    Example:
        `straightness of X along Y` for EYX.
    """
    axis, letter = symbol.link, symbol.link[0]
    is_own = "XYZ"[symbol.component % 3] == _OWN.get(letter, letter)
    if letter in "XYZUVW":
        if symbol.is_angular:
            return f"roll of {axis}" if is_own else f"tilt of {axis} {motion(symbol)}"
        return (
            f"positioning error of {axis}" if is_own else f"straightness of {axis} {motion(symbol)}"
        )
    if symbol.is_angular:
        return f"positioning error of {axis}" if is_own else f"tilt of {axis} {motion(symbol)}"
    return f"axial motion of {axis}" if is_own else f"radial motion of {axis} {motion(symbol)}"


def location_title(symbol: Symbol) -> str:
    """What a constant of an axis, of the workpiece or of the tool is called."""
    if symbol.link in "wt":
        whose = "workpiece" if symbol.link == "w" else "tool"
        what = "rotation" if symbol.is_angular else "displacement"
        return f"{what} of the {whose} {motion(symbol)}"
    axis, letter = symbol.link, symbol.link[0]
    is_linear = letter in "XYZUVW"
    is_own = "XYZ"[symbol.component % 3] == _OWN.get(letter, letter)
    if is_own and symbol.is_angular != is_linear:
        return f"zero position of {axis}"
    if is_linear:
        return f"squareness of {axis} {motion(symbol)}"
    what = "tilt" if symbol.is_angular else "displacement"
    return f"{what} of the line of {axis} {motion(symbol)}"
