"""Variables and tool table of LinuxCNC, as text."""

from collections.abc import Mapping, Sequence

SYSTEMS = 9
"""Coordinate systems G54 to G59.3."""


def variables(offsets: Mapping[int, Sequence[float]]) -> str:
    """Text of a file of variables with G54 in force.

    Args:
        offsets: X, Y and Z of the zero of coordinate systems by number, 1 is G54, mm; others have
            none.
    """
    # 5161, 5181: G28 and G30; 5210 to 5219: G92; 5220: system in force; 5221 + 20 k: its offsets
    values = [*enumerate([0.0] * 9, 5161), *enumerate([0.0] * 9, 5181)]
    values += [*enumerate([0.0] * 10, 5210), (5220, 1.0)]
    for system in range(SYSTEMS):
        rest = [0.0] * 7  # A to W, and the rotation
        xyz = offsets.get(system + 1, (0.0, 0.0, 0.0))
        values += enumerate([*xyz, *rest], 5221 + 20 * system)
    return "".join(f"{number}\t{value:.6f}\n" for number, value in values)


def tool_table(number: int, length: float, radius: float) -> str:
    """Text of a tool table with one tool, mm."""
    return f"T{number} P{number} Z{length:.6f} D{2.0 * radius:.6f}\n"
