"""All that follows from a standard by rule."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from matstd.artefact.body import Standard
from matstd.cad_out.details.lettering import Lettering, lettering_of
from matstd.cad_out.details.mounting import Pad, Screw, pads_of, screws_of
from matstd.cad_out.details.places import (
    HEAVY,
    Bore,
    Side,
    lifting_holes,
    sides_of,
    thermometer_pocket,
)
from matstd.cad_out.details.seats import Seat, seat_of
from matstd.twin.frames import Array, apply


@dataclass(frozen=True, eq=False)
class Details:
    """What the workshop adds."""

    seats: dict[str, Seat]  # of the balls, by their names
    pads: tuple[Pad, ...]  # on which it stands; none where it stands on its whole underside
    screws: tuple[Screw, ...]  # by size
    sides: dict[str, Side]  # of the plate by name: DATUM_B, DATUM_C, NAME, THERMO
    bores: tuple[Bore, ...]  # lifting holes and thermometer pocket
    lettering: tuple[Lettering, ...]
    missing: tuple[str, ...]

    @property
    def face_names(self) -> tuple[str, ...]:
        """Names of the body's faces that come from here."""
        seats = tuple(f"{name}_SEAT" for name in self.seats)
        pads = tuple(pad.name for pad in self.pads) or ("SEAT",)
        return ("DATUM_B", "DATUM_C", *seats, *pads, *(bore.name for bore in self.bores))


def details_of(standard: Standard) -> Details:
    """The details of a standard; raises NotBuildable for a post too thin for its ball."""
    sides, bores, lettering, missing = _added(standard)
    return Details(
        seats={sphere.name: seat_of(sphere) for sphere in standard.spheres},
        pads=pads_of(standard, sides.values()),
        screws=screws_of(standard),
        sides=sides,
        bores=bores,
        lettering=lettering,
        missing=missing,
    )


def engraved_on(standard: Standard) -> Array:
    """Where the lettering of a standard is spotted, (N, 3), mm."""
    places = [np.empty((0, 3))]
    for line in _added(standard)[2]:
        flat = np.column_stack([line.dots, np.zeros(len(line.dots))])
        places.append(apply(line.T_artefact_text, flat))
    return np.concatenate(places)


@lru_cache(maxsize=2)
def _added(
    standard: Standard,
) -> tuple[dict[str, Side], tuple[Bore, ...], tuple[Lettering, ...], tuple[str, ...]]:
    """Sides, bores, lettering, and what found no room."""
    mass, sides = standard.mass(step=6.0), sides_of(standard)
    lifting = lifting_holes(standard, mass)
    pocket = thermometer_pocket(standard, sides["THERMO"], lifting)
    bores = (*lifting, *([pocket] if pocket else []))
    lettering, nameless = lettering_of(standard, sides, bores)
    missing = [f"lettering of {name}" for name in nameless]
    missing += ["lifting holes"] if mass > HEAVY and not lifting else []
    missing += [] if pocket else ["a pocket for a thermometer"]
    return sides, bores, lettering, tuple(missing)
