"""Cross-sections of beams, and deflection of a Timoshenko beam at a point that moves along it.

Users write sections as `220x180x20` or `d120`. Shear coefficients are those of Cowper, by which
Timoshenko beams are close to solids from a slenderness of two.

A beam of span S is held at its ends, a cantilever at its root alone. At x a force and a moment act
on whatever sits there; beside them the weight of the beam. All is exact for constant sections: two
elements meet at x, of which the stiffness matrices are known in closed form.

Reference: Przemieniecki, Theory of Matrix Structural Analysis, 1968, 5.6 (beam with shear);
Cowper, G. R., J. Appl. Mech. 33, 1966; Bredt (torsion of closed thin walls); Roark.
"""

import math
import re
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from matstd.twin.frames import Array

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


Support = Literal["cantilever", "supported", "clamped"]
SUPPORTS: tuple[Support, ...] = ("cantilever", "supported", "clamped")


class Plane(NamedTuple):
    """Bending in one plane: stiffness, and what it gives at a point, (N,) each."""

    by_force: Array  # deflection per force, and rotation per moment's unit work: mm/N
    coupled: Array  # rotation per force, which is deflection per moment: 1/N
    by_moment: Array  # rotation per moment: 1/(N mm)
    own: Array  # deflection under a uniform load, mm per N/mm
    own_rotation: Array  # rotation under it, rad per N/mm


def bending(support: Support, x: Array, span: Array, EI: float, GA: float) -> Plane:
    """Flexibility at a point of a beam.

    Args:
        x: Places of the point from the first end, (N,), mm.
        span: Length of the beam, (N,), mm; of a ram that leaves its guide, its overhang x.
        EI: Bending stiffness, N mm2.
        GA: Shear stiffness, N.
    """
    if support == "cantilever":
        return _cantilever(x, span, EI, GA)
    held = support == "clamped"
    K1, p1 = _side(x, EI, GA, held, 1.0)
    K2, p2 = _side(span - x, EI, GA, held, -1.0)
    # of 2 by 2, and all of it is wanted
    C: Array = np.asarray(np.linalg.inv(K1 + K2), dtype=np.float64)
    own = np.einsum("nij,nj->ni", C, p1 + p2)
    return Plane(
        by_force=C[:, 0, 0],
        coupled=C[:, 0, 1],
        by_moment=C[:, 1, 1],
        own=own[:, 0],
        own_rotation=own[:, 1],
    )


def _cantilever(x: Array, span: Array, EI: float, GA: float) -> Plane:
    """Closed forms; the weight beyond x loads it as a force and a moment do."""
    own = x**2 * (6.0 * span**2 - 4.0 * span * x + x**2) / (24.0 * EI)
    own = own + x * (2.0 * span - x) / (2.0 * GA)
    turned = x * (3.0 * span**2 - 3.0 * span * x + x**2) / (6.0 * EI)
    force: Array = x**3 / (3.0 * EI) + x / GA
    both: Array = x**2 / (2.0 * EI)
    moment: Array = x / EI
    return Plane(by_force=force, coupled=both, by_moment=moment, own=own, own_rotation=turned)


def _side(length: Array, EI: float, GA: float, held: bool, sign: float) -> tuple[Array, Array]:
    """Stiffness (N, 2, 2) and load of one element at the point, its far end condensed.

    Args:
        held: Whether the far end cannot turn.
        sign: 1 for the element before the point, -1 for the one behind.
    """
    L, shear = length, 12.0 * EI / (GA * length**2)
    k = EI / (L**3 * (1.0 + shear))
    own = (4.0 + shear) * L**2 * k
    K = np.empty((len(L), 2, 2))
    K[:, 0, 0], K[:, 1, 1] = 12.0 * k, own
    K[:, 0, 1] = K[:, 1, 0] = -sign * 6.0 * L * k
    load = np.column_stack([L / 2.0, -sign * L**2 / 12.0])
    if not held:  # the far end is free to turn
        far = np.column_stack([-sign * 6.0 * L * k, (2.0 - shear) * L**2 * k])
        K -= far[:, :, None] * far[:, None, :] / own[:, None, None]
        load -= far * (sign * L**2 / 12.0 / own)[:, None]
    return K, load


def along(support: Support, x: Array, span: Array, stiffness: float) -> Array:
    """Motion along the beam per force, or rotation about it per moment, at the point, (N,).

    The stiffness is EA in N, or GJ in N mm2; supported ends hold both.
    """
    if support == "cantilever":
        return x / stiffness
    return x * (span - x) / (span * stiffness)
