"""Which family of features a standard gets: balls alone, small faces, flat pads, one wavy face.

Every family that fits is designed and judged by the same figures after equally many touches. The
goal of the project states which one decides:

    identify    error of the tool point that is left unknown in the workspace, rms
    worst       the same at the worst pose
    prove       signal of the unmodelled effect that shows least
    minutes     the same per root of the time on the machine, as signals grow with touches
    price       price of the body in its cheaper construction

Families that leave over 2 % more unknown than the best balls alone are left out. A family with a
face is built unless balls alone are more than 5 % better: its face is a surface like a workpiece.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import Goal
from matstd.artefact.price import Estimate
from matstd.twin.units import MINUTE


class Family(StrEnum):
    """Features of a standard beside its balls; the values are those of the project file."""

    BALLS = "balls"
    FACES = "faces"
    FLAT = "flat"
    WAVY = "wavy"


MOST_COST = 1.02
"""Largest error over the workspace that a family may leave, relative to the best balls alone."""

SECONDS_PER_TOUCH = 3.6
"""Seconds a touch, with its share of the ways: 2.4 to 4.8 as planned for the examples."""

CLEAR_LEAD = 1.05
"""Figure of balls alone, relative to the best family with a face, above which they are built."""


@dataclass(frozen=True)
class FamilyFigures:
    """What one family would give on this machine."""

    family: Family
    # error of the tool point over the workspace that its touches leave unknown, mm
    rms_user: float = 0.0
    worst_user: float = 0.0  # the same at the worst pose, mm
    signal: float = 0.0  # of the unmodelled effect that it shows least
    power: float = 0.0  # probability that this effect is detected
    # that effect in words of its record: field or bump, width, direction
    least: tuple[bool, float, str] = (False, 0.0, "")
    touches: int = 0  # number of them, those of the proof included
    scan_minutes: float = 0.0  # time of the scan at its feed, min
    # of the cheaper construction, EUR; None for a material without rates
    price: Estimate | None = None
    scan_points: int = 0  # recorded points of its scan; 0 where it is touched only
    refused: str = ""  # why it cannot be built here; empty where it can


def chosen_family(figures: tuple[FamilyFigures, ...], goal: Goal, best_balls: float) -> Family:
    """The family that wins of those that can be built; see the module.

    Args:
        goal: One of `Goal`.
        best_balls: Error that the best balls alone leave over the workspace, mm.
    """
    there = {one.family: one for one in figures if not one.refused}
    most = MOST_COST * best_balls
    fit = {f: one for f, one in there.items() if f is Family.BALLS or one.rms_user <= most}
    score = {family: score_of(one, goal) for family, one in (fit or there).items()}
    faced = [family for family in score if family is not Family.BALLS]
    best = max(faced, key=score.__getitem__, default=Family.BALLS)
    if score.get(Family.BALLS, 0.0) > CLEAR_LEAD * score[best]:
        return Family.BALLS
    return best


def score_of(one: FamilyFigures, goal: Goal) -> float:
    """The figure that a goal compares, the larger the better; equal where it is not known."""
    if goal == "prove":
        return one.signal
    if goal == "minutes":  # the plan comes later: it differs by as much for all families
        return one.signal / np.sqrt(SECONDS_PER_TOUCH * one.touches / MINUTE + one.scan_minutes)
    if goal == "price":
        return 1.0 / one.price.value if one.price is not None else 1.0
    return 1.0 / (one.worst_user if goal == "worst" else one.rms_user)


def flat_pads(standard: Standard) -> Standard:
    """A standard with the mean planes of its faces in place of these."""
    return replace(standard, patches=tuple(face.mean_plane() for face in standard.patches))
