"""What a design does not reach of its project, for the console and the page."""

from collections.abc import Sequence

from matstd.artefact.body import Standard
from matstd.artefact.price import Construction, Price
from matstd.cad_out.making import FIRST_MODE, Making
from matstd.report.numbers import euros, percent, plural
from matstd.report.task.calibration_words import modulus_words
from matstd.twin.units import UM

_NEAR = 0.95
"""Share of the allowed mass above which mass is named as the reason for fewer balls: one ball with
its post is about 2 % of a standard."""


_CONSTRUCTIONS = {
    Construction.BILLET: "all in one from a billet",
    Construction.PARTS: "plate, studs and a block for every face",
}

FILES = {Construction.BILLET: "standard.step", Construction.PARTS: "standard-parts.step"}
"""What a workshop makes each of them from."""


def making_lines(making: Making) -> list[str]:
    """Modulus, and a first mode below what is usual, named as a compromise."""
    lines = [
        f"Young's modulus: {modulus_words(making.material)}",
        *price_lines(making.prices, making.make),
    ]
    stiff = making.stiffness
    if stiff is None or stiff.first_mode >= FIRST_MODE:
        return lines
    words = (
        f"compromise: first mode {stiff.first_mode:.0f} Hz on rigid screws, below "
        f"{FIRST_MODE:.0f} Hz"
    )
    if stiff.at_balls:
        ball = min(stiff.at_balls, key=stiff.at_balls.__getitem__)
        words += f"; softest ball {ball}, {stiff.at_balls[ball] * UM:.1f} N/µm"
    return [
        *lines,
        f"{words}: let the table settle after a turn; a smaller blank.height_mm raises both, "
        "limits.first_mode_Hz refuses such a design",
    ]


def price_lines(prices: Sequence[Price], make: Construction) -> list[str]:
    """Price, hours and lead time of both constructions, and which of them to make."""
    if not prices:
        return ["price: not estimated, no rates are known of this material"]
    last = f"make {FILES[make]}, {_CONSTRUCTIONS[make]}"
    named = [f"{_CONSTRUCTIONS[one.construction]} {_price_words(one)}" for one in prices]
    best, worst = sorted((one.total for one in prices), key=lambda total: total.value)
    apart = worst.value - best.value
    cheaper = min(prices, key=lambda one: one.total.value).construction
    verdict = (
        f"{_CONSTRUCTIONS[cheaper]} is {percent(apart / worst.value)} cheaper"
        if apart > max(best.u, worst.u)
        else "they differ by less than the uncertainty of one"
    )
    return [f"price, estimated from assumed rates: {'; '.join(named)}; {verdict}: {last}"]


def _price_words(one: Price) -> str:
    return (
        f"{euros(one.total.value, one.total.u)}, {one.work.value:.0f} ± {one.work.u:.0f} h, "
        f"{one.stock:.0f} kg of stock, {one.weeks.value:.0f} ± {one.weeks.u:.0f} weeks"
    )


def fewer_lines(standard: Standard, balls: int, mass: float, limit: float) -> list[str]:
    """That a standard of a mass (kg) has fewer balls than its project asks for, and what binds."""
    count = sum(not ball.proves for ball in standard.spheres)
    if count >= balls:
        return []
    if mass > _NEAR * limit:
        why = f"more would exceed limits.max_mass_kg = {limit:g} ({mass:.1f} kg now)"
    else:
        why = (
            f"beside {plural(len(standard.proving), 'feature')} that prove and the screws no more "
            "keep the gaps for cutter and probe; a larger blank.base_mm or fewer standard.patches "
            "make room"
        )
    return [f"compromise: {count} balls of standard.balls = {balls}: {why}"]
