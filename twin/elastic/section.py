"""Cross-sections of beams, as users write them: `220x180x20`, `d120`.

Areas and moments in mm. Shear coefficients of Cowper, by which Timoshenko beams are close to solids
from a slenderness of two.

Reference: Cowper, G. R., J. Appl. Mech. 33, 1966; Bredt (torsion of closed thin walls); Roark.
"""

import math
import re
from dataclasses import dataclass

_NUMBER = r"(\d+(?:\.\d+)?)"
_BOX = re.compile(rf"{_NUMBER}x{_NUMBER}(?:x{_NUMBER})?\Z")
_ROUND = re.compile(rf"d{_NUMBER}(?:x{_NUMBER})?\Z")


@dataclass(frozen=True)
class Section:
    """A doubly symmetric cross-section; the first direction is that of the width."""

    area: float  # mm2
    # second moments for deflection along the width and along the height, mm4
    bending: tuple[float, float]
    # areas that bear shear along the width and along the height, mm2
    shear_area: tuple[float, float]
    torsion: float  # torsion constant, mm4
    depth: float  # largest extent, mm


def section(word: str, poisson: float) -> Section | None:
    """A section from `WIDTHxHEIGHT`, `WIDTHxHEIGHTxWALL`, `dDIAMETER`, `dDIAMETERxWALL`, mm.

    None where it is none of these, or its wall fills it.
    """
    box, tube = _BOX.match(word), _ROUND.match(word)
    if box:
        w, h, t = (float(v) if v else 0.0 for v in box.groups())
        if min(w, h) <= 2.0 * t or min(w, h) <= 0.0:
            return None
        return _hollow(w, h, t) if t else _rectangle(w, h, poisson)
    if tube:
        d, t = (float(v) if v else 0.0 for v in tube.groups())
        return None if d <= 2.0 * t or d <= 0.0 else _tube(d, t, poisson)
    return None


def _rectangle(w: float, h: float, poisson: float) -> Section:
    kappa = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson)
    a, b = max(w, h), min(w, h)
    torsion = a * b**3 * (1.0 / 3.0 - 0.21 * b / a * (1.0 - (b / a) ** 4 / 12.0))
    bending = (h * w**3 / 12.0, w * h**3 / 12.0)
    shear = (kappa * w * h, kappa * w * h)
    return Section(area=w * h, bending=bending, shear_area=shear, torsion=torsion, depth=a)


def _hollow(w: float, h: float, t: float) -> Section:
    """A box with one thickness of wall: webs bear the shear, a closed wall the torsion."""
    iw, ih = w - 2.0 * t, h - 2.0 * t
    bending = ((h * w**3 - ih * iw**3) / 12.0, (w * h**3 - iw * ih**3) / 12.0)
    mw, mh = w - t, h - t
    torsion = 2.0 * t * (mw * mh) ** 2 / (mw + mh)
    return Section(
        area=w * h - iw * ih,
        bending=bending,
        shear_area=(2.0 * t * mw, 2.0 * t * mh),
        torsion=torsion,
        depth=max(w, h),
    )


def _tube(d: float, t: float, poisson: float) -> Section:
    """A solid bar, or a tube."""
    inner = d - 2.0 * t if t else 0.0
    area = math.pi / 4.0 * (d**2 - inner**2)
    bending = math.pi / 64.0 * (d**4 - inner**4)
    m = inner / d
    ratio = (1.0 + m**2) ** 2
    kappa = (
        6.0 * (1.0 + poisson) * ratio
        / ((7.0 + 6.0 * poisson) * ratio + (20.0 + 12.0 * poisson) * m**2)
    )  # fmt: skip
    return Section(
        area=area,
        bending=(bending, bending),
        shear_area=(kappa * area, kappa * area),
        torsion=2.0 * bending,
        depth=d,
    )
