"""Which family of features a standard gets: balls alone, small faces, flat pads, one wavy face.

Every family that fits is designed and judged by the same two figures: what its touches leave
unknown of the tool point in the workspace, and the signal of the unmodelled effect that
it shows least, after equally many touches. The rule:

    identify    the family that leaves least unknown
    prove       of those that leave at most 2 % more than the best balls alone, the one with the
                largest signal

Balls alone are judged beside them and said first where they show more than 5 % more.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

from matstd.artefact.body import Standard


class Family(StrEnum):
    """Features of a standard beside its balls; the values are those of the project file."""

    BALLS = "balls"
    FACES = "faces"
    FLAT = "flat"
    WAVY = "wavy"


MOST_COST = 1.02
"""Largest error over the workspace that a family may leave, relative to the best balls alone."""

CLEAR_LEAD = 1.05
"""Signal of balls alone, relative to what is built, above which a design says so first."""


@dataclass(frozen=True)
class FamilyFigures:
    """What one family would give on this machine.

    Attributes:
        rms_user: Error of the tool point over the workspace that its touches leave unknown, mm.
        signal: Of the unmodelled effect that it shows least.
        power: Probability that this effect is detected.
        least: That effect in words of its record: field or bump, width, direction.
        touches: Number of them, those of the proof included.
        scan_points: Recorded points of its scan; 0 where it is touched only.
        refused: Why it cannot be built here; empty where it can.
    """

    family: Family
    rms_user: float = 0.0
    signal: float = 0.0
    power: float = 0.0
    least: tuple[bool, float, str] = (False, 0.0, "")
    touches: int = 0
    scan_points: int = 0
    refused: str = ""


def chosen_family(figures: tuple[FamilyFigures, ...], goal: str, best_balls: float) -> Family:
    """The family that wins of those that can be built; see the module.

    Args:
        goal: `identify` or `prove`.
        best_balls: Error that the best balls alone leave over the workspace, mm.
    """
    there = [one for one in figures if not one.refused]
    if goal == "identify":
        return min(there, key=lambda one: one.rms_user).family
    fit = [one for one in there if one.rms_user <= MOST_COST * best_balls] or there
    return max(fit, key=lambda one: one.signal).family


def flat_pads(standard: Standard) -> Standard:
    """A standard with the mean planes of its faces in place of these."""
    return replace(standard, patches=tuple(face.mean_plane() for face in standard.patches))
