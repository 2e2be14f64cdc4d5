"""Numbers of the machine file as a run has them, each with all others that explain it equally."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry.quantities import Quantity
from matstd.diagnosis.geometry.rivals import Descriptions, FoundNumber
from matstd.diagnosis.geometry.rows import GeometryRow
from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array
from matstd.twin.machine import LETTERS, Link


@dataclass(frozen=True, slots=True)
class Correction:
    """A number of the machine file as the run has it."""

    key: str  # `axis.C.point`, `axis.Y.direction`, `probe.length_mm`
    stated: tuple[float, ...]  # what the file says, mm
    found: tuple[float, ...]
    # standard uncertainty of every number; of those that stay as stated it is None
    u: tuple[float | None, ...]
    # other numbers that explain the run equally: of all of them one is wrong
    rivals: tuple[FoundNumber, ...] = ()


def corrections(
    fit: Fit, rows: Sequence[GeometryRow]
) -> tuple[tuple[Correction, ...], tuple[FoundNumber, ...]]:
    """Points and directions of axes as the run has them, where they differ clearly.

    A displacement of a rotary axis's line moves its point, a tilt and a squareness turn the
    direction, ``d' = d + omega x d``. Only what the run determines by itself.

    Returns:
        The corrections, and numbers that each explain alone all lines that are far from
        where they are stated: a zero of a rotary axis tilts and displaces the axes that it carries.
    """
    kinds = (Quantity.ROTARY_LINE, Quantity.SQUARENESS)
    clear = [
        r
        for r in rows
        if r.quantity in kinds
        and r.is_determined
        and abs(r.estimate.value) > POLICY.clear_excess * r.estimate.u
    ]
    if not clear:
        return (), ()
    out = []
    descriptions = Descriptions(fit)
    for name in dict.fromkeys(r.axes[-1] for r in clear):
        link = fit.model.chain.link(name)
        own = {r.symbol: r.estimate for r in clear if r.axes[-1] == name}
        for made, letters in ((moved_point, LETTERS[:3]), (turned_direction, LETTERS[3:])):
            wrong = {s: e for s, e in own.items() if s[1] in letters}
            if wrong:
                rivals = descriptions.rivals([(s, e.value) for s, e in wrong.items()])
                found = {letters.index(s[1]): (e.value, e.u) for s, e in wrong.items()}
                out.append(replace(made(link, found), rivals=rivals))
    # only lines that are wrong beyond an ordinary error may have one common cause
    far = [r for r in clear if r.is_far or r.is_beyond_expected]
    together = descriptions.rivals([(r.symbol, r.estimate.value) for r in far])
    return tuple(out), together if len({key_of(r) for r in far}) > 1 else ()


def key_of(row: GeometryRow) -> str:
    """The key of a machine file that a line or a squareness would be put right in."""
    return f"axis.{row.axes[-1]}.{'direction' if row.symbol[1] in 'ABC' else 'point'}"


def moved_point(link: Link, moved: Mapping[int, tuple[float, float]]) -> Correction:
    """A point of an axis by what is added to some coordinates, with its standard uncertainty."""
    added, u = np.array([moved.get(i, (0.0, 0.0)) for i in range(3)]).T
    return _correction(link, "point", link.point, link.point + link.frame @ added, link.frame * u)


def turned_direction(link: Link, turned: Mapping[int, tuple[float, float]]) -> Correction:
    """A direction by small rotations and their uncertainties, as a file takes it: a unit vector."""
    omega, u_omega = np.array([turned.get(i, (0.0, 0.0)) for i in range(3)]).T
    d = link.direction
    found = d + np.cross(link.frame @ omega, d)
    u = np.cross(link.frame * u_omega, d, axis=0)
    return _correction(link, "direction", d, found / np.linalg.norm(found), u)


def _correction(link: Link, key: str, stated: Array, found: Array, u: Array) -> Correction:
    """A vector of a link as the file has it and as found; u (3, n) of n independent numbers."""
    size = np.linalg.norm(u, axis=1)
    return Correction(
        key=f"axis.{link.name}.{key}",
        stated=tuple(float(v) for v in stated),
        found=tuple(float(v) for v in found),
        u=tuple(float(v) if v > 0.0 else None for v in size),
    )
