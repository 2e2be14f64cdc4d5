"""Price, hours, mass and lead time of a body, all in one from a billet or of plate and studs.

In one piece, posts and faces are milled out of a block as high as the standard; what is between
them becomes chips. Of parts, a ground plate carries turned studs with the balls, screwed to a
shoulder, and every face on a block of its own, screwed from below on three pads.

    roughing    hours = volume of chips * specific cutting force / power / share in cut
    finishing   hours = area / area a minute
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import reduce
from operator import add

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.price import rates
from matstd.artefact.price.rates import Estimate


@dataclass(frozen=True, slots=True)
class Stock:
    """A material as it is bought."""

    price: Estimate  # of a sawn block, per kg
    # specific cutting force in roughing, N/mm^2 (kc1 of tables for chips of 0.1 to 0.2 mm, new and
    # worn cutter)
    force: Estimate
    is_hardened: bool = False  # whether it is hardened after roughing


_between = Estimate.between

_STOCKS = {
    "x40cr14": Stock(_between(6.0, 14.0), _between(2000.0, 3000.0), is_hardened=True),
    "cast iron": Stock(_between(3.0, 7.0), _between(1000.0, 1600.0)),
    "aluminium": Stock(_between(7.0, 14.0), _between(600.0, 1000.0)),
    "invar": Stock(_between(40.0, 90.0), _between(2200.0, 3200.0)),
    "steel": Stock(_between(2.0, 6.0), _between(1800.0, 2600.0)),
}

_NOT_MILLED = ("alumina", "zirconia", "granite", "mineral casting")


def stock_of(material: str) -> Stock | None:
    """What is bought of a material by its name; None for one that no cutter mills, or unknown."""
    name = material.lower()
    if any(word in name for word in _NOT_MILLED):
        return None
    return next((stock for word, stock in _STOCKS.items() if word in name), None)


_ALLOWANCE = 5.0  # mm of stock on every side
_CM3_PER_MM3, _CM2_PER_MM2, _MINUTES = 1e-3, 1e-2, 60.0


class Construction(StrEnum):
    """How a body is made."""

    BILLET = "billet"
    PARTS = "parts"


@dataclass(frozen=True)
class Price:
    """Estimates of one construction."""

    construction: Construction
    stock: float  # mass of what is bought to be milled, kg
    hours: dict[str, Estimate]  # by kind of work, h
    bought: dict[str, Estimate]  # by what is bought or given out, EUR
    labour: Estimate  # all hours at their rates, EUR
    weeks: Estimate  # from order to certificate

    @property
    def total(self) -> Estimate:
        """Everything, EUR."""
        return _sum(self.bought.values()) + self.labour

    @property
    def work(self) -> Estimate:
        """All hours, h."""
        return _sum(self.hours.values())


_RATES = {
    "programming": rates.MILLING,
    "milling": rates.MILLING,
    "turning": rates.TURNING,
    "grinding": rates.GRINDING,
    "fitting": rates.BENCH,
    "calibration": rates.MEASURING,
}


def prices_of(standard: Standard) -> tuple[Price, ...]:
    """Both constructions, the billet first; none for a material that is not milled, or unknown."""
    stock = stock_of(standard.material.name)
    if stock is None:
        return ()
    return tuple(_price(standard, stock, one) for one in Construction)


def construction_to_make(prices: Iterable[Price], has_joints: bool) -> Construction:
    """Of parts, each of which can be made again, unless the billet is clearly cheaper.

    Args:
        prices: Of both constructions; none for a material without rates.
        has_joints: Whether the parts find room for their threads and screws.
    """
    total = {one.construction: one.total for one in prices}
    if not has_joints or not total:
        return Construction.BILLET
    billet, parts = total[Construction.BILLET], total[Construction.PARTS]
    dearer = parts.value - billet.value > max(parts.u, billet.u)
    return Construction.BILLET if dearer else Construction.PARTS


def _price(standard: Standard, stock: Stock, construction: Construction) -> Price:
    is_billet = construction is Construction.BILLET
    balls, faces = len(standard.spheres), standard.patches
    volume = _stock_volume(standard, construction)
    density = standard.material.density
    chips = volume - _milled(standard, construction)
    force = stock.force * (chips * _CM3_PER_MM3 / (_MINUTES * 1e3))  # kW min
    milling = (force.over(rates.POWER)).over(rates.IN_CUT) * (1.0 / _MINUTES)
    milling = milling + _finishing(standard, construction)
    # a billet is turned over once and roughed before it is hardened
    milling = milling + rates.SET_UP * (3.0 if is_billet else 4.0)
    milling = milling + (rates.SEAT * balls if is_billet else rates.TAPPED * balls)
    parts = 0 if is_billet else len(faces) + min(balls, 1)
    hours = {
        "programming": rates.PROGRAMMING + rates.PER_PART * parts,
        "milling": milling,
        "grinding": rates.GROUND,
        "fitting": rates.GLUEING * balls,
        "calibration": rates.MEASURED_SET_UP
        + rates.MEASURED_BALL * balls
        + rates.MEASURED_FACE * len(faces),
    }
    if not is_billet:
        hours["turning"] = rates.STUD * balls
        hours["fitting"] = hours["fitting"] + rates.JOINT * len(faces)
    mass = density * volume
    bought = {
        "stock": stock.price * mass,
        "balls": rates.BALL * balls,
        "screws": rates.SCREWS * (1.0 if is_billet else 2.0),
    }
    weeks = rates.MATERIAL_WEEKS + rates.CALIBRATION_WEEKS
    if stock.is_hardened:
        bought["hardening"] = rates.HARDENING + rates.PER_KG_HARDENED * (0.4 * mass)
        weeks = weeks + rates.HARDENING_WEEKS
    labour = _sum([_RATES[name].times(one) for name, one in hours.items()])
    return Price(
        construction=construction,
        stock=mass,
        hours=hours,
        bought=bought,
        labour=labour,
        weeks=weeks + _sum(hours.values()).over(rates.HOURS_A_WEEK),
    )


def _stock_volume(standard: Standard, construction: Construction) -> float:
    """Of blocks and bars that are bought, mm^3."""
    base, more = standard.base, 2.0 * _ALLOWANCE
    a, b = (2.0 * half + more for half in base.half_size)
    if construction is Construction.BILLET:
        return a * b * (_top(standard) + more)
    volume = a * b * (base.thickness + more)
    for patch in standard.patches:
        wide, long = (2.0 * half + more for half in patch.half_size)
        volume += wide * long * (_highest(patch) - base.thickness + more)
    for ball in standard.spheres:
        length = ball.centre[2] - ball.foot
        volume += np.pi * (ball.foot_radius + 1.0) ** 2 * (length + 30.0)
    return float(volume)


def _top(standard: Standard) -> float:
    """Height of what is milled in one piece: posts without their balls, faces."""
    tops = [float(ball.centre[2]) for ball in standard.spheres]
    return max([*tops, *map(_highest, standard.patches), standard.base.thickness])


def _highest(patch: FreeformPatch) -> float:
    return float(patch.point(patch.grid(2.0))[:, 2].max())


def _milled(standard: Standard, construction: Construction) -> float:
    """Volume that remains of the stock on the mill, mm^3; chips of the lathe are in its hours."""
    balls = sum(4.0 / 3.0 * np.pi * ball.radius**3 for ball in standard.spheres)
    volume = standard.volume(step=6.0) - float(balls)
    if construction is Construction.PARTS:
        for ball in standard.spheres:
            a, b, length = ball.foot_radius, ball.stem_radius, ball.centre[2] - ball.foot
            volume -= float(np.pi * length * (a * a + a * b + b * b) / 3.0)
            volume += float(np.pi * (a + 1.0) ** 2 * (length + 30.0))
    return volume


def _finishing(standard: Standard, construction: Construction) -> Estimate:
    """Hours of finishing faces, walls, posts and plate."""
    base = standard.base
    planes = 2.0 * 4.0 * base.half_size[0] * base.half_size[1]
    faces, walls = 0.0, 0.0
    for patch in standard.patches:
        a, b = patch.half_size
        faces += 4.0 * a * b * float(np.mean(1.0 / np.cos(patch.slope(patch.grid(4.0)))))
        walls += 4.0 * (a + b) * (_highest(patch) - base.thickness)
    if construction is Construction.BILLET:
        for ball in standard.spheres:
            around = np.pi * (ball.foot_radius + ball.stem_radius)
            walls += float(around * (ball.centre[2] - ball.foot - ball.radius))
    lots = ((faces, rates.FINISHING), (walls, rates.WALLS), (planes, rates.PLANES))
    minutes = _sum([Estimate(area * _CM2_PER_MM2).over(rate) for area, rate in lots])
    return minutes * (1.0 / _MINUTES)


def _sum(estimates: Iterable[Estimate]) -> Estimate:
    return reduce(add, estimates, Estimate(0.0))
