"""What is asked of a placement."""

from dataclasses import dataclass, field

from matstd.artefact.worth import CriterionOptions, TouchOptions
from matstd.twin.units import UM


@dataclass(frozen=True)
class PlacementOptions:
    """What is designed, how much is tried, and what for.

    Attributes:
        name: Type of the standard.
        serial: Of the piece.
        patches: Number of freeform patches.
        balls: Number of balls, fewer where no more find room.
        sites: Number of random faces to choose from.
        noise: Standard deviation of one touch, mm.
        criterion: What faces, balls, poses and touches are chosen for.
        choice: How many touches at how many table poses.
    """

    name: str = "FFS"
    serial: str = ""
    patches: int = 6
    balls: int = 13
    sites: int = 400
    noise: float = 1.0 * UM
    criterion: CriterionOptions = field(default_factory=lambda: CriterionOptions(potential=0.3))
    choice: TouchOptions = field(default_factory=TouchOptions)
